"""The key figures of a stage's result, for a table over many tasks."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from tsas_cli.identification.estimate import Estimate
from tsas_cli.recordings.recording import Recording
from tsas_cli.records.result import Result

Figures = dict[str, Any]
FITTING = ("calibrate", "diagnose")
OF_RUNS = ("f_in_N", "f_out_N", "x_out_mm")


def figures(stage: str, result: Result) -> Figures:
    """Return the key figures of a stage's result by name, with the unit in the name."""
    return _OF[stage](result)


def estimates(stage: str, result: Any) -> list[dict[str, Any]]:
    """Return every estimate of a stage, with interval, unit and bound flag."""
    return [e.as_json() for e in result.model.estimates] if stage in FITTING else []


def _of_check(result: Any) -> Figures:
    severities = [str(finding.severity) for finding in result.findings]
    return {
        "errors": severities.count("error"),
        "warnings": severities.count("warning"),
        "notes": severities.count("note"),
        "codes": ", ".join(sorted({finding.code for finding in result.findings})),
    }


def _of_calibrate(result: Any) -> Figures:
    summary = result.summary
    return {
        "converged": summary["fit"]["converged"],
        **_fitted(result.model.estimates),
        **_pooled(summary["channels"]),
    }


def _of_simulate(result: Any) -> Figures:
    runs = result.summary["runs"]
    unconverged = sum(run["unconverged_samples"] or 0 for run in runs.values())
    return {
        **_pooled({name: run["channels"] for name, run in runs.items()}),
        **dict(_reach(result.runs.values())),
        "unconverged_samples": unconverged,
    }


def _of_diagnose(result: Any) -> Figures:
    summary = result.summary
    rivals = {rival for cause in summary["named"] for rival in cause["rivals"]}
    found: Figures = {
        "verdict": summary["verdict"],
        "causes": ", ".join(cause["effect"] for cause in summary["named"]),
        "rivals": ", ".join(sorted(rivals)),
    }
    for cause in summary["named"]:
        name = f"gain_percent_{cause['effect']}"
        low, high = cause["gain_interval_percent"] or (None, None)
        found |= {name: cause["gain_percent"], f"{name}_low": low, f"{name}_high": high}
    for channel, error in summary["channels"].items():
        for key in ("before", "after"):
            found[f"rmse_{key}_{channel}"] = error[f"rmse_{key}"]
    return found | _fitted(result.model.estimates)


def _of_track(result: Any) -> Figures:
    rows, found = result.summary["results"], Figures()
    for row in rows:
        prefix = "" if len(rows) == 1 else f"{row['run']}."
        for score, spread in row["scores"].items():
            found[f"{prefix}{score}"] = spread["mean"]
            if spread["sd"] is not None:
                found[f"{prefix}{score}_sd"] = spread["sd"]
        found[f"{prefix}unsettled_steps"] = row["unsettled_steps"]
    return found


_OF: dict[str, Callable[[Any], Figures]] = {
    "check": _of_check,
    "calibrate": _of_calibrate,
    "simulate": _of_simulate,
    "diagnose": _of_diagnose,
    "track": _of_track,
}


def _fitted(found: Iterable[Estimate]) -> Figures:
    """Return the estimates of common parameters; those of single runs have their own table."""
    figures: Figures = {}
    for e in found:
        if e.origin == "fitted" and e.run is None:
            name = f"fitted_{e.name}"
            figures |= {name: e.value, f"{name}_low": e.interval_low}
            figures |= {f"{name}_high": e.interval_high, f"{name}_at_bound": e.at_bound}
    return figures


def _pooled(runs: Mapping[str, Mapping[str, Any]]) -> Figures:
    """Return the RMS of each channel's residual over all runs, with equal weights."""
    squares: dict[str, list[float]] = {}
    for channels in runs.values():
        for name, channel in channels.items():
            if channel["rmse"] is not None:
                squares.setdefault(f"rmse_{name}", []).append(channel["rmse"] ** 2)
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
