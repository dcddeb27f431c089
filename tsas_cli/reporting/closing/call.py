"""The call of `tsas close-loop` that has written a file."""

from collections.abc import Iterator

from tsas_cli.records.closing import HIDDEN, ClosingFile

SETTINGS = "settings.toml"


def options(closing: ClosingFile) -> Iterator[str]:
    """Yield the options; settings that are not the defaults as if they stood in `SETTINGS`."""
    names = [case.case for case in closing.cases]
    if HIDDEN not in names:
        yield from ("--cases", ",".join(names))
    else:
        hidden = (change for case in closing.cases for change in case.hidden.items())
        for name, value in hidden:
            yield from ("--hide", f"{name}={value!r}")
    if own_settings(closing):
        yield from ("--settings", SETTINGS)
    first, last = closing.seeds
    yield from ("--seeds", str(last - first + 1), "--seed", str(first))


def own_settings(closing: ClosingFile) -> bool:
    """Return whether the settings are others than the defaults."""
    from tsas_cli.tracking.settings import Settings

    return closing.settings.content() != Settings().model_dump(mode="json", by_alias=True)
