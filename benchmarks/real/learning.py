"""One split: models fitted to the recordings to learn from, and their errors on the others."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.signal import butter, sosfiltfilt

import tsas_cli as tsas
from benchmarks.real.ridge import ridge_errors
from benchmarks.real.splits import HERE, Split
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.support.arrays import Floats

MAPS = HERE.parents[1] / "datasets" / "maps"
AFTER_S = 2.0  # of a run: its first moments depend on what went before it
ROWS = ("f_in_N", "x_out_mm")  # what is predicted


@dataclass(frozen=True)
class Learned:
    """What a diagnosis says, and by channel the RMSE of each run, by what predicts it."""

    verdict: str
    reason: str
    errors: dict[str, dict[str, list[float | None]]]


def learn(split: Split, data: Path, out: Path) -> Learned:
    """Run the stages on the clones in `data`; what they write goes below `out`.

    InputError: a file cannot be read, or the checks find an error in it.
    """
    learned = _ingested(split, split.learned, data, out / "learned")
    if split.said.get("drive"):
        drive = tsas.identify_harmonic_drive(learned, out=out / "drive", force=True).diagnosis
        x_in = drive.channels["x_in_mm"]
        rows = {"x_in_mm": {"nominal": [x_in.rmse_before], "extended": [x_in.rmse_after]}}
        return Learned(drive.verdict, drive.reason, rows)
    predicted = _ingested(split, split.predicted, data, out / "predicted")
    accepted = split.said.get("despite", ())
    tsas.calibrate(learned, out=out / "calibrate", despite=accepted, force=True)
    found = tsas.diagnose(learned, out=out / "diagnose", despite=accepted, force=True)
    tsas.report([out / "learned", out / "diagnose"], out=out / "report.html", force=True)
    # What gains and is not proven predicts all the same, where no law describes more.
    extended = out / "diagnose" / "model-stand-in.toml"
    if not extended.exists():
        extended = extended.with_name("model-extended.toml")
    it = tsas.predict([out / "calibrate", extended], predicted, out=out / "predict", force=True)
    columns = [[run.columns for run in dataset] for dataset in (learned, predicted)]
    first, last = split.said.get("within_s", (AFTER_S, np.inf))
    counted = [(run["time_s"] >= first) & (run["time_s"] <= last) for run in columns[1]]
    errors: dict[str, dict[str, list[float | None]]] = {}
    for name in (channel for channel in ROWS if channel in columns[0][0]):
        by = {
            model: [one.errors[name] for one in runs]
            for model, runs in zip(("nominal", "extended"), it.predicted.runs.values(), strict=True)
        }
        by["ridge"] = ridge_errors(*columns, name, AFTER_S)
        errors[name] = {
            model: [_rms(e[rows], split) for e, rows in zip(of, counted, strict=True)]
            for model, of in by.items()
        }
        repeats = {row.run: row.repeatability for row in it.record.channels if row.channel == name}
        errors[name]["repeatability"] = list(repeats.values())
    return Learned(found.verdict, found.reason, errors)


def _ingested(split: Split, names: tuple[str, ...], data: Path, out: Path) -> Dataset:
    mapped = MAPS / split.said["map"]
    return tsas.ingest([data / n for n in names], map=mapped, out=out, force=True).dataset


def _rms(errors: Floats, split: Split) -> float:
    """Return the RMS of errors at 1 kHz, below the frequency at which the split says so."""
    known = errors[np.isfinite(errors)]
    if "below_Hz" in split.said:
        known = sosfiltfilt(butter(4, split.said["below_Hz"], fs=1e3, output="sos"), known)
    return float(np.sqrt(np.mean(known**2)))
