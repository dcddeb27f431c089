"""The diagnose stage: `diagnosis.json`, both models, and what each answers to the runs."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tsas_cli.diagnosis.diagnose import Cause, Diagnosis, Verdict, diagnose_runs
from tsas_cli.diagnosis.diagnosis_json import as_json
from tsas_cli.diagnosis.diagnosis_tables import tables
from tsas_cli.identification.comparison import compare
from tsas_cli.identification.model import Model, fitted_to, source_of, stated_model, write_model
from tsas_cli.identification.phases import segment, segments_as_json
from tsas_cli.identification.prepared import Prepared, prepare
from tsas_cli.recordings.columns import nominal_name
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.recording import Recording
from tsas_cli.recordings.writing import write_answer
from tsas_cli.records.diagnosis import EXTENDED_MODEL, NOMINAL_MODEL
from tsas_cli.records.result import Result, Table, notes
from tsas_cli.stages.given import Named, dataset_of, path_of
from tsas_cli.support import __version__
from tsas_cli.support.files import folder_if, write_json
from tsas_cli.support.steps import SILENT, Steps


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
        return tables(self.summary, self.titled("causes", EXTENDED_MODEL))

    def sentences(self) -> list[str]:
        """Return the verdict, what to measure next, and what the recordings do not say."""
        cannot_tell = notes(self.summary["cannot_tell"])
        return [self.reason, f"Next: {self.next_experiment}", *cannot_tell]


def diagnose(
    dataset: Dataset | Named,
    *,
    out: Named | None = None,
    model: Model | Named | None = None,
    runs: Iterable[str] | None = None,
    force: bool = False,
    step: Steps = SILENT,
) -> DiagnosisResult:
    """Show what the simulation gets wrong, name the cause, extend the model, measure the gain.

    Parameters
    ----------
    dataset
        A dataset, or its folder.
    out
        Where to write `diagnosis.json` and `model-extended.toml`; None writes nothing.
    model
        A model to begin with, or its file; the data sheet's without it.
    runs
        The ids of the runs that are taken; all without it.
    force
        Replace the folder if it is there.
    step
        Told of every hypothesis; how many lie ahead grows with what is found.

    Returns
    -------
    DiagnosisResult
        `.verdict`, `.reason`, `.causes` (effect, rivals, parameters with 95 % intervals, gain on
        held-out data [%]), `.model` (the extended one), `.next_experiment`; `.summary` is what
        `diagnosis.json` holds, with the errors before and after, in each channel's unit.

    Raises
    ------
    InputError
        A recording or the model is wrong, or `out` exists and `force` is not set.
    """
    data, known, path = dataset_of(dataset, runs), path_of(model), path_of(out)
    stated = stated_model(data.manifest, known)
    summary = data.header("diagnose", path) | {"model": source_of(known, path)}
    with folder_if(path, stage="diagnose", inputs=[data.folder, known], force=force) as folder:
        step.ahead(len(data.runs) + 1)
        prepared = []
        for recording in data:
            prepared.append(prepare(recording, data.manifest.session_start))
            step()
        result = diagnose_runs(data.manifest, stated, prepared, step)
        summary |= as_json(result, step)
        step()
        summary["segments"] = {run.run.id: segments_as_json(run, segment(run)) for run in prepared}
        if folder is not None:
            _write(folder, summary, result, prepared)
    return DiagnosisResult(summary, path, result)


def _write(folder: Path, summary: dict[str, Any], result: Diagnosis, runs: list[Prepared]) -> None:
    write_json(folder / "diagnosis.json", summary)
    for name, model in ((EXTENDED_MODEL, result.model), (NOMINAL_MODEL, result.nominal)):
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
