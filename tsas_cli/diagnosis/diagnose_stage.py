"""The diagnose stage: `diagnosis.json`, both models, and what each answers to the runs."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from tsas_cli import __version__
from tsas_cli.diagnosis.diagnose import Cause, Diagnosis, Verdict, diagnose
from tsas_cli.diagnosis.diagnosis_json import as_json
from tsas_cli.diagnosis.diagnosis_tables import tables
from tsas_cli.files import folder_if, write_json
from tsas_cli.identification.comparison import compare
from tsas_cli.identification.model import Model, fitted_to, source_of, stated_model, write_model
from tsas_cli.identification.phases import segment, segments_as_json
from tsas_cli.identification.prepared import Prepared, prepare
from tsas_cli.recordings.columns import nominal_name
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.quality.copies.counted import counted_once
from tsas_cli.recordings.recording import Recording
from tsas_cli.recordings.writing import write_answer
from tsas_cli.result import Result, Table, notes
from tsas_cli.steps import SILENT, Steps

EXTENDED, NOMINAL = "model-extended.toml", "model-nominal.toml"


@dataclass(frozen=True, repr=False, eq=False)
class DiagnosisResult(Result):
    """A verdict on what the nominal model lacks, and the extended model.

    Parameters
    ----------
    diagnosis
        The verdict and all that it rests on: causes, errors, what is left, every hypothesis.
    """

    diagnosis: Diagnosis

    @property
    def verdict(self) -> Verdict:
        """`named`, `ambiguous`, `sufficient`, `unexplained` or `undecided`."""
        return self.diagnosis.verdict

    @property
    def reason(self) -> str:
        """The verdict in one plain sentence."""
        return self.diagnosis.reason

    @property
    def causes(self) -> tuple[Cause, ...]:
        """What is named, with rivals, parameters and the gain on held-out data [%]."""
        return self.diagnosis.causes

    @property
    def model(self) -> Model:
        """The extended model; where nothing is named the nominal one, fitted again."""
        return self.diagnosis.model

    @property
    def next_experiment(self) -> str:
        """What to measure next."""
        return str(self.summary["next_experiment"])

    def tables(self) -> list[Table]:
        """Return what is named, the errors before and after, and the ranking."""
        return tables(self.summary, self.titled("causes", EXTENDED))

    def sentences(self) -> list[str]:
        """Return the verdict, what to measure next, and what the recordings do not say."""
        cannot_tell = notes(self.summary["cannot_tell"])
        return [self.reason, f"Next: {self.next_experiment}", *cannot_tell]


def diagnose_dataset(
    dataset: Dataset,
    model: Model | Path | None,
    out: Path | None,
    *,
    force: bool = False,
    step: Steps = SILENT,
) -> DiagnosisResult:
    """Diagnose, and write what was found, both models and their answers into a new folder if any.

    The model, or else the data sheet, is where the refit of the nominal parameters begins.

    Raises
    ------
    InputError
        A recording or the model is wrong, or `out` exists and `force` is not set.
    """
    stated = stated_model(dataset.manifest, model)
    with folder_if(out, force=force) as folder:
        counted = counted_once(dataset)
        summary = counted.dataset.header("diagnose", out) | {"model": source_of(model, out)}
        step.ahead(len(counted.dataset.runs) + 1)
        runs = []
        for recording in counted.dataset:
            copied = counted.copied_of(recording.run.id)
            runs.append(prepare(recording, dataset.manifest.session_start, copied))
            step()
        result = diagnose(dataset.manifest, stated, runs, step)
        result = replace(result, cannot_tell=(*counted.notes, *result.cannot_tell))
        summary |= as_json(result, step)
        step()
        summary["segments"] = {run.run.id: segments_as_json(run, segment(run)) for run in runs}
        if folder is not None:
            _write(folder, summary, result, runs)
    return DiagnosisResult(summary, out, result)


def _write(folder: Path, summary: dict[str, Any], result: Diagnosis, runs: list[Prepared]) -> None:
    write_json(folder / "diagnosis.json", summary)
    for name, model in ((EXTENDED, result.model), (NOMINAL, result.nominal)):
        write_model(folder / name, model, version=__version__, dataset=fitted_to(summary))
    (folder / "runs").mkdir()
    for run in runs:
        write_answer(folder / "runs", _answer(run, result.model, result.nominal))


def _answer(run: Prepared, extended: Model, nominal: Model) -> Recording:
    """Return time, the conditioned or simulated x_in, and what each model answers to it."""
    after, before = compare(run, extended), compare(run, nominal)
    columns = {"time_s": run.time_s, "x_in_mm": after.response.x_in_mm, **after.channels}
    columns |= {nominal_name(name): values for name, values in before.channels.items()}
    return Recording(run.run, columns)
