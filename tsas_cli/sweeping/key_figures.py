"""The key figures of a stage's result, for a table over many tasks."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import asdict
from typing import Any, cast

import numpy as np

from tsas_cli.identification.estimate import Estimate
from tsas_cli.recordings.recording import Recording
from tsas_cli.records.calibration import CalibrationFile, ChannelError
from tsas_cli.records.diagnosis import DiagnosisFile
from tsas_cli.records.result import Result
from tsas_cli.records.simulation import SimulatedChannel, SimulationFile
from tsas_cli.records.tracking import TrackingFile
from tsas_cli.sweeping.outcome import Row

FITTING = ("calibrate", "diagnose")
OF_RUNS = ("f_in_N", "f_out_N", "x_out_mm")


def figures(stage: str, result: Result) -> Row:
    """Return the key figures of a stage's result by name, with the unit in the name."""
    return _OF[stage](result)


def estimates(stage: str, result: Any) -> list[Row]:
    """Return every estimate of a stage, with interval, unit and bound flag."""
    return [asdict(e) for e in result.model.estimates] if stage in FITTING else []


def _of_check(result: Any) -> Row:
    severities = [str(finding.severity) for finding in result.findings]
    return {
        "errors": severities.count("error"),
        "warnings": severities.count("warning"),
        "notes": severities.count("note"),
        "codes": ", ".join(sorted({finding.code for finding in result.findings})),
    }


def _of_calibrate(result: Any) -> Row:
    record: CalibrationFile = result.record
    return {
        "converged": record.fit.converged,
        **_fitted(result.model.estimates),
        **_pooled(record.channels.values()),
    }


def _of_simulate(result: Any) -> Row:
    runs = cast("SimulationFile", result.record).runs.values()
    return {
        **_pooled(run.channels for run in runs),
        **dict(_reach(result.runs.values())),
        "unconverged_samples": sum(run.unconverged_samples for run in runs),
    }


def _of_diagnose(result: Any) -> Row:
    record: DiagnosisFile = result.record
    found: Row = {
        "verdict": record.verdict,
        "causes": ", ".join(cause.effect for cause in record.named),
        "rivals": ", ".join(sorted({rival for cause in record.named for rival in cause.rivals})),
    }
    for cause in record.named:
        name = f"gain_percent_{cause.effect}"
        low, high = cause.gain_interval_percent or (None, None)
        found |= {name: cause.gain_percent, f"{name}_low": low, f"{name}_high": high}
    for channel, error in record.channels.items():
        found[f"rmse_before_{channel}"] = error.rmse_before
        found[f"rmse_after_{channel}"] = error.rmse_after
    return found | _fitted(result.model.estimates)


def _of_track(result: Any) -> Row:
    rows, found = cast("TrackingFile", result.record).results, Row()
    for row in rows:
        prefix = "" if len(rows) == 1 else f"{row.run}."
        for score, spread in row.scores:
            found[f"{prefix}{score}"] = spread.mean
            if spread.sd is not None:
                found[f"{prefix}{score}_sd"] = spread.sd
        found[f"{prefix}unsettled_steps"] = row.unsettled_steps
    return found


_OF: dict[str, Callable[[Any], Row]] = {
    "check": _of_check,
    "calibrate": _of_calibrate,
    "simulate": _of_simulate,
    "diagnose": _of_diagnose,
    "track": _of_track,
}


def _fitted(found: Iterable[Estimate]) -> Row:
    """Return the estimates of common parameters; those of single runs have their own table."""
    figures: Row = {}
    for e in found:
        if e.origin == "fitted" and e.run is None:
            name = f"fitted_{e.name}"
            figures |= {name: e.value, f"{name}_low": e.interval_low}
            figures |= {f"{name}_high": e.interval_high, f"{name}_at_bound": e.at_bound}
    return figures


def _pooled(runs: Iterable[Mapping[str, SimulatedChannel | ChannelError]]) -> Row:
    """Return the RMS of each channel's residual over all runs, with equal weights."""
    squares: dict[str, list[float]] = {}
    for channels in runs:
        for name, channel in channels.items():
            if channel.rmse is not None:
                squares.setdefault(f"rmse_{name}", []).append(channel.rmse**2)
    return {name: math.sqrt(sum(each) / len(each)) for name, each in squares.items()}


def _reach(runs: Iterable[Recording]) -> Iterator[tuple[str, float]]:
    """Yield the lowest and the highest value of each simulated channel over all runs."""
    ends: dict[str, list[float]] = {}
    for run in runs:
        for name in OF_RUNS:
            values = run.get(name)
            if values is not None and np.isfinite(values).any():
                ends.setdefault(name, []).extend((np.nanmin(values), np.nanmax(values)))
    for name, both in ends.items():
        yield f"lowest_{name}", float(min(both))
        yield f"highest_{name}", float(max(both))
