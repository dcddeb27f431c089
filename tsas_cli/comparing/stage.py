"""What `tsas compare` writes and prints: `compare.json`, and the tables."""

from typing import Any

from pydantic import TypeAdapter

from tsas_cli.comparing.compare import Comparison
from tsas_cli.comparing.sentences import findings, notes
from tsas_cli.comparing.sides import Side
from tsas_cli.comparing.values import Pair, shared_name
from tsas_cli.identification.estimate import Estimate
from tsas_cli.records.diagnosis import Maps
from tsas_cli.records.result import Table
from tsas_cli.support import __version__

FILE = "compare.json"

MAPS = TypeAdapter(dict[str, Maps])


def as_json(it: Comparison) -> dict[str, Any]:
    """Return the content of `compare.json`."""
    return {
        "format": 1,
        "stage": "compare",
        "version": __version__,
        "a": _side(it.a),
        "b": _side(it.b),
        "on": None
        if it.on is None
        else {"name": it.on.manifest.name, "hashes": it.on.hashes()}
        | ({} if it.on.chosen is None else {"chosen": [run.id for run in it.on.runs]}),
        "own_values_fitted": it.own_fitted,
        "same_recordings": it.overlap,
        "parameters": [_pair(pair) for pair in it.pairs],
        "effects": effects(it),
        "errors": [{**vars(row), "ratio": row.ratio} for row in it.errors],
        "held_out": held_out(it),
        "residual_map": MAPS.dump_python(it.maps, mode="json", by_alias=True),
        "findings": findings(it),
        "notes": notes(it),
    }


def _side(side: Side) -> dict[str, Any]:
    return {
        "path": side.path.as_posix(),
        "kind": side.kind,
        "files": side.files,
        "dataset": None
        if side.source is None
        else {"name": side.source.name, "recordings": side.recordings},
        "dynamics": side.dynamics,
        "verdict": side.verdict or None,
        "reason": side.reason or None,
    }


def _pair(pair: Pair) -> dict[str, Any]:
    d = pair.difference
    return {
        "name": pair.name,
        "unit": pair.unit,
        "a": None if pair.a is None else pair.a.as_json(),
        "b": None if pair.b is None else pair.b.as_json(),
        "difference": None
        if d is None
        else {
            "value": d.value,
            "interval_low": d.low,
            "interval_high": d.high,
            "excludes_zero": d.excludes_zero,
            "why_no_interval": d.why_none or None,
        },
    }


def effects(it: Comparison) -> list[dict[str, str]]:
    """Return each effect that a side holds, or takes for a rival, and what it is to both."""
    order = dict.fromkeys(
        effect
        for side in (it.a, it.b)
        for effect in (*side.effects, *(rival for named in side.named for rival in named.rivals))
    )
    return [{"effect": e, "a": _place(it.a, e), "b": _place(it.b, e)} for e in order]


def _place(side: Side, effect: str) -> str:
    if any(named.effect == effect for named in side.named):
        return "named"
    if effect in side.effects:
        return "in the model"
    rivals = [named.effect for named in side.named if effect in named.rivals]
    return f"rival of {', '.join(rivals)}" if rivals else ""


def held_out(it: Comparison) -> list[dict[str, Any]]:
    """Return the errors of two diagnoses on held-out data, by channel; none of anything else."""
    both = [name for name in it.a.held_out if name in it.b.held_out]
    return [
        {
            "channel": name,
            "unit": it.a.held_out[name].unit,
            "rmse_a": it.a.held_out[name].rmse_after,
            "rmse_b": it.b.held_out[name].rmse_after,
            "noise_a": it.a.held_out[name].noise_floor,
            "noise_b": it.b.held_out[name].noise_floor,
        }
        for name in both
    ]


def tables(it: Comparison) -> list[Table]:
    """Return what the stage prints."""
    every: list[Table] = [
        ("sides", ("", "kind", "path", "recordings", "verdict"), _sides(it)),
        (
            "parameters",
            ("name", "run", "A [95 %]", "B [95 %]", "B − A [95 %]", "differs", "unit"),
            [_row(pair) for pair in it.pairs],
        ),
        ("effects", ("effect", "A", "B"), [tuple(row.values()) for row in effects(it)]),
        (
            "errors",
            ("run", "channel", "RMSE A", "RMSE B", "B / A", "noise", "unit", "fitted to it"),
            _errors(it),
        ),
        (
            "error on held-out data",
            ("channel", "unit", "RMSE A", "RMSE B", "noise A", "noise B"),
            [tuple(map(_cell, row.values())) for row in held_out(it)],
        ),
    ]
    return [table for table in every if table[2]]


def _cell(value: str | float | None) -> str:
    return value if isinstance(value, str) else _number(value)


def _sides(it: Comparison) -> list[tuple[str, ...]]:
    return [
        (name, side.kind, str(side.path), recordings_of(side), side.verdict)
        for name, side in it.sides.items()
    ]


def recordings_of(side: Side) -> str:
    """Return how many recordings of which dataset a side has read."""
    if side.source is None or side.recordings is None:
        return "not told"
    return f"{len(side.recordings)} of {side.source.name}"


def _row(pair: Pair) -> tuple[str, ...]:
    d = pair.difference
    return (
        pair.name,
        pair.run,
        _text(pair.a),
        _text(pair.b),
        "" if d is None else d.text(),
        differs(pair),
        pair.unit,
    )


def differs(pair: Pair) -> str:
    """Say whether two values differ by more than their uncertainty; nothing where it is open."""
    claim = None if pair.difference is None else pair.difference.excludes_zero
    return "" if claim is None else "yes" if claim else "no"


def _text(estimate: Estimate | None) -> str:
    return "" if estimate is None else estimate.text()


def _errors(it: Comparison) -> list[tuple[str, ...]]:
    return [
        (
            shared_name(row.run_a, row.run_b),
            row.channel,
            _number(row.rmse_a),
            _number(row.rmse_b),
            _number(row.ratio),
            "" if row.noise is None else f"{row.noise:.2g}",
            row.unit,
            fitted_to(row.fitted_a, row.fitted_b),
        )
        for row in it.errors
    ]


def fitted_to(a: bool | None, b: bool | None) -> str:
    """Say which side's fit has seen a recording."""
    return ", ".join(name for name, seen in (("A", a), ("B", b)) if seen)


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.4g}"
