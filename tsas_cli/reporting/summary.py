"""The page's first paragraph: what it is about and what came out, in plain words."""

from collections.abc import Iterator

from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.recordings.manifest import Manifest
from tsas_cli.records.calibration import CalibrationFile
from tsas_cli.records.check import CheckFile
from tsas_cli.records.closing import ClosingFile
from tsas_cli.records.simulation import SimulationFile
from tsas_cli.records.tracking import TrackingFile
from tsas_cli.reporting.channels import in_words
from tsas_cli.reporting.closing import cases, errors
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import ranged
from tsas_cli.reporting.tracking.scores import best_and_worst
from tsas_cli.support.wording import count_of


def sentences(inputs: Inputs) -> Iterator[str]:
    """Yield the sentences of the summary."""
    if closing := inputs.get(ClosingFile):
        yield cases.summary(closing)
        yield from errors.most_and_least(closing)
    if inputs.dataset is not None:
        yield from _of_dataset(inputs, inputs.dataset.manifest)


def _of_dataset(inputs: Inputs, manifest: Manifest) -> Iterator[str]:
    many = count_of(len(manifest.run), "recording")
    yield f"{manifest.name} holds {many}, {manifest.kind}."
    if tracking := inputs.get(TrackingFile):
        yield from best_and_worst(tracking)
    yield _findings(inputs.check)
    simulation = inputs.get(SimulationFile)
    if simulation and (distances := _distances(simulation)):
        yield (
            f"The RMSE between simulation and measurement is {', '.join(distances)}; "
            "1 is as near as noise allows."
        )
    if calibration := inputs.get(CalibrationFile):
        yield from _open_questions(calibration.cannot_tell)


def _open_questions(sentences: tuple[str, ...]) -> Iterator[str]:
    if sentences:
        yield f"Keep in mind: {sentences[0]}"
    if len(sentences) > 1:
        yield f"The other {len(sentences) - 1} of these sentences stand under Parameters."


def _findings(check: CheckFile) -> str:
    counts = {
        severity: sum(f.severity == severity for f in check.findings)
        for severity in ("error", "warning", "note")
    }
    said = [f"{n} {name}{'s' if n > 1 else ''}" for name, n in counts.items() if n]
    return f"The checks report {', '.join(said)}." if said else "The checks found nothing."


def _distances(simulation: SimulationFile) -> list[str]:
    """Return, for each channel, the range over the runs of RMSE against noise."""
    said = []
    for name in BY_NAME:
        found = [run.channels[name] for run in simulation.runs.values() if name in run.channels]
        ratios = [c.rmse / c.noise for c in found if c.rmse is not None and c.noise]
        if ratios:
            said.append(f"{ranged(ratios)} times the noise in {in_words(name)}")
    return said
