"""The call of `tsas track` that has written a file."""

from collections.abc import Iterator

from tsas_cli.records.tracking import TrackingFile


def options(tracking: TrackingFile) -> Iterator[str]:
    """Yield the options, files by their names."""
    changes = [change for changes in tracking.conditions.values() for change in changes]
    if tracking.model.sha256 is not None:
        yield from ("--model", tracking.model.file)
    if tracking.plant.sha256 is not None and tracking.plant != tracking.model:
        yield from ("--plant", tracking.plant.file)
    if tracking.drive.sha256 is not None:
        yield from ("--drive", tracking.drive.file)
    if tracking.dynamics != "slip":
        yield from ("--dynamics", tracking.dynamics)
    if len(tracking.conditions) > 1:
        yield "--compare"  # which takes all controllers
    else:
        names = dict.fromkeys(result.controller for result in tracking.results)
        yield from ("--controller", ",".join(names))
    for change in changes:
        late = f"@{change.from_s!r}" if change.from_s > 0.0 else ""
        yield from ("--disturb", f"{change.quantity}={change.value!r}{late}")
    yield from ("--reference", tracking.reference.shape or tracking.reference.file)
    if tracking.gains == "as printed":
        yield "--as-printed"
    if tracking.settings.file is not None and tracking.settings.sha256 is not None:
        yield from ("--settings", tracking.settings.file)
    first, last = tracking.seeds
    yield from ("--seeds", str(last - first + 1), "--seed", str(first))


def files_read(tracking: TrackingFile) -> dict[str, str]:
    """Return the checksums of models and reference by file, of those that were given."""
    named = (tracking.model, tracking.plant, tracking.drive, tracking.reference)
    return {one.file: one.sha256 for one in named if one.sha256 is not None}
