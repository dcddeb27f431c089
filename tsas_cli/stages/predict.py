"""Predict recordings that no fit has seen: measured beside simulated, model by model."""

from collections.abc import Iterable
from dataclasses import dataclass

from tsas_cli.comparing import predict as predicting
from tsas_cli.comparing.predict import Predicted, read_models
from tsas_cli.identification.model import Model
from tsas_cli.recordings.columns import name_by
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.recording import Recording
from tsas_cli.recordings.writing import write_runs
from tsas_cli.records.prediction import PredictionFile
from tsas_cli.records.result import Result, Table, notes
from tsas_cli.stages.given import Named, dataset_of, file_of, path_of, several_of
from tsas_cli.support.files import folder_if
from tsas_cli.support.steps import NO_PROGRESS, Steps


@dataclass(frozen=True, repr=False, eq=False)
class PredictResult(Result):
    """How well models predict recordings, and whether these lie in what they were fitted to."""

    record: PredictionFile  # what `predict.json` holds
    predicted: Predicted  # the models by letter, and what each predicts of each run

    def tables(self) -> list[Table]:
        """Return the models, their errors, and which runs lie outside their ranges."""
        return predicting.tables(self.record, self.titled("predictions"))

    def sentences(self) -> list[str]:
        """Return which model predicts best, and what limits that."""
        return [*self.record.findings, *notes(self.record.notes)]


def predict(
    models: Model | Named | Iterable[Model | Named],
    dataset: Dataset | Named,
    *,
    out: Named | None = None,
    runs: Iterable[str] | None = None,
    fit_own: bool = True,
    force: bool = False,
    step: Steps = NO_PROGRESS,
) -> PredictResult:
    """Predict recordings with models that were fitted to others, and say whether that carries over.

    Parameters
    ----------
    models
        A model, its file, or a folder that `tsas calibrate` or `diagnose` wrote; or several.
    dataset
        The recordings to predict, or their folder.
    out
        Where to write `predict.json` and `runs/ID.parquet`; None writes nothing.
    runs
        The ids of the runs that are taken; all without it.
    fit_own
        Fit each run's own preload and zeros to it first, which no other recording tells.
    force
        Replace the folder if it is there.
    step
        Called once for each run and model.

    Returns
    -------
    PredictResult
        `.summary["channels"]` holds, by run, channel and model, the RMSE in the channel's unit, its
        share of the measured span [%], the normalised residual and the channel's repeatability;
        `.summary["ranges"]` which runs leave the range that a model was fitted to, and by what.

    Raises
    ------
    InputError
        A model or a recording cannot be read, or `out` exists and `force` is not set.
    """
    given = [each if isinstance(each, Model) else file_of(each) for each in several_of(models)]
    sides = read_models(given)
    data, path = dataset_of(dataset, runs), path_of(out)
    with folder_if(path, stage="predict", inputs=[data.folder, *given], force=force) as folder:
        step.ahead(len(sides) * len(data.runs))
        it = predicting.predict(sides, data, fit_own=fit_own, step=step)
        record = PredictionFile(
            **data.header(path),
            models=predicting.models_of(it, path),
            own_values_fitted=bool(fit_own),
            channels=it.channels,
            ranges=it.ranges,
            findings=tuple(predicting.findings(it)),
            notes=tuple(predicting.notes(it)),
        )
        if folder is not None:
            record.write(folder)
            write_runs(folder / "runs", _series(it))
    return PredictResult(record.content(), path, record, it)


def _series(it: Predicted) -> dict[str, Recording]:
    """Return each run's time, x_in as conditioned, and what each model predicts of it."""
    out: dict[str, Recording] = {}
    for model, runs in it.runs.items():
        for one in runs:
            run = one.run
            known = out.setdefault(run.run.id, Recording(run.run, {"time_s": run.time_s}))
            columns = dict(known.columns)
            if "x_in_mm" in run.conditioned:
                columns["x_in_mm"] = run.conditioned["x_in_mm"].values
            columns |= {name_by(name, model): v for name, v in one.simulated.items()}
            out[run.run.id] = Recording(run.run, columns)
    return out
