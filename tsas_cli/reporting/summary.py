"""The page's first paragraph: the recordings, what the checks say, and what to keep in mind."""

from collections.abc import Iterator

from tsas_cli.records.base import OfDataset
from tsas_cli.records.calibration import CalibrationFile
from tsas_cli.records.check import CheckFile
from tsas_cli.records.diagnosis import DiagnosisFile
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.support.wording import count_of
from tsas_cli.verifying.changed import change_notes


def sentences(inputs: Inputs) -> Iterator[str]:
    """Yield the sentences of the summary; without a dataset, of what was changed alone."""
    places = [*inputs.folders.values(), *(folder for _, folder in inputs.more_simulations)]
    yield from change_notes(places)
    if inputs.dataset is None:
        return
    manifest = inputs.dataset.manifest
    many = count_of(len(manifest.run), "recording")
    yield f"{manifest.name} holds {many}, {manifest.kind}."
    yield _findings(inputs.check)
    of_data = [stage for stage in inputs.stages.values() if isinstance(stage, OfDataset)]
    yield from dict.fromkeys(sentence for stage in of_data for sentence in stage.accepted())
    calibration = inputs.get(CalibrationFile)
    if calibration and calibration.cannot_tell and inputs.get(DiagnosisFile) is None:
        notes = calibration.cannot_tell
        yield f"Keep in mind: {notes[0]}"
        if notes[1:]:
            yield f"{count_of(len(notes) - 1, 'more note')} on the estimates: see Parameters."


def _findings(check: CheckFile) -> str:
    counts = {
        severity: sum(f.severity == severity for f in check.findings)
        for severity in ("error", "warning", "note")
    }
    said = [count_of(n, name) for name, n in counts.items() if n]
    return f"The checks report {', '.join(said)}." if said else "The checks found nothing."
