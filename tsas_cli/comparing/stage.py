"""What `tsas compare` writes and prints: `compare.json`, and the tables."""

from tsas_cli.comparing.compare import Comparison
from tsas_cli.comparing.sentences import findings, notes
from tsas_cli.comparing.sides import Side, rounded
from tsas_cli.records.base import number_text
from tsas_cli.records.comparison import (
    ComparedOn,
    EffectPlaces,
    HeldOutPair,
    ModelComparison,
    ModelSide,
    ParameterPair,
    RecordingsRead,
    ValueDifference,
    shared_name,
)
from tsas_cli.records.result import Table


def record_of(it: Comparison) -> ModelComparison:
    """Return what `compare.json` says."""
    on = None
    if (data := it.on) is not None:
        chosen = None if data.chosen is None else [run.id for run in data.runs]
        on = ComparedOn(name=data.manifest.name, hashes=data.hashes(), chosen=chosen)
    return ModelComparison(
        a=_side(it.a),
        b=_side(it.b),
        on=on,
        same_recordings=it.overlap,
        parameters=it.pairs,
        effects=effects(it),
        errors=it.errors,
        held_out=held_out(it),
        residual_map=it.maps,
        findings=findings(it),
        notes=notes(it),
    )


def _side(side: Side) -> ModelSide:
    source, read, found = side.source, side.recordings, side.diagnosis
    return ModelSide(
        path=side.path.as_posix(),
        kind=side.kind,
        files=side.files,
        dataset=source and RecordingsRead(name=source.name, recordings=read),
        dynamics=side.dynamics,
        verdict=found and found.verdict,
        reason=(found and found.reason) or None,
    )


def effects(it: Comparison) -> list[EffectPlaces]:
    """Return each effect that a side holds, or takes for a rival, and what it is to both."""
    order = dict.fromkeys(
        effect
        for side in (it.a, it.b)
        for effect in (*side.effects, *(rival for named in side.named for rival in named.rivals))
    )
    return [EffectPlaces(effect=e, a=_place(it.a, e), b=_place(it.b, e)) for e in order]


def _place(side: Side, effect: str) -> str:
    if any(named.effect == effect for named in side.named):
        return "named"
    if effect in side.effects:
        return "in the model"
    rivals = [named.effect for named in side.named if effect in named.rivals]
    return f"rival of {', '.join(rivals)}" if rivals else ""


def held_out(it: Comparison) -> list[HeldOutPair]:
    """Return the errors of two diagnoses on held-out data, by channel; none of anything else."""
    if it.a.diagnosis is None or it.b.diagnosis is None:
        return []
    others = it.b.diagnosis.channels
    return [
        HeldOutPair(
            channel=name,
            unit=a.unit,
            rmse_a=a.rmse_after,
            rmse_b=b.rmse_after,
            noise_a=a.noise_floor,
            noise_b=b.noise_floor,
        )
        for name, a in it.a.diagnosis.channels.items()
        if (b := others.get(name)) is not None
    ]


def tables(record: ModelComparison) -> list[Table]:
    """Return what the stage prints."""
    sides = []
    for name, side in (("A", record.a), ("B", record.b)):
        of = side.dataset
        known = f"{len(of.recordings)} of {of.name}" if of and of.recordings is not None else ""
        sides.append((name, side.kind, side.path, known or "unknown", side.verdict or ""))
    every: list[Table] = [
        ("sides", ("", "kind", "path", "recordings", "verdict"), sides),
        (
            "parameters",
            ("name", "run", "A [95 %]", "B [95 %]", "B − A [95 %]", "differs", "unit"),
            [_row(pair) for pair in record.parameters],
        ),
        ("effects", ("effect", "A", "B"), [(row.effect, row.a, row.b) for row in record.effects]),
        (
            "errors",
            ("run", "channel", "RMSE A", "RMSE B", "B / A", "noise", "unit", "fitted to it"),
            _errors(record),
        ),
        (
            "error on held-out data",
            ("channel", "unit", "RMSE A", "RMSE B", "noise A", "noise B"),
            [
                (pair.channel, pair.unit, *(number_text(value, ".4g") for value in values))
                for pair in record.held_out
                for values in [(pair.rmse_a, pair.rmse_b, pair.noise_a, pair.noise_b)]
            ],
        ),
    ]
    return [table for table in every if table[2]]


def _row(pair: ParameterPair) -> tuple[str, ...]:
    d = pair.difference
    return (
        pair.name,
        pair.run,
        "" if pair.a is None else pair.a.text(),
        "" if pair.b is None else pair.b.text(),
        "" if d is None else _difference(d),
        differs(pair),
        pair.unit,
    )


def _difference(d: ValueDifference) -> str:
    if d.value is None or d.low is None or d.high is None:
        return number_text(d.value, ".4g")
    value, low, high = rounded(d.value, d.low, d.high)
    return f"{value} [{low}, {high}]"


def differs(pair: ParameterPair) -> str:
    """Say whether two values differ by more than their uncertainty; nothing where it is open."""
    claim = None if pair.difference is None else pair.difference.excludes_zero
    return "" if claim is None else "yes" if claim else "no"


def _errors(record: ModelComparison) -> list[tuple[str, ...]]:
    return [
        (
            shared_name(row.run_a, row.run_b),
            row.channel,
            number_text(row.rmse_a, ".4g"),
            number_text(row.rmse_b, ".4g"),
            number_text(row.ratio, ".4g"),
            number_text(row.noise, ".2g"),
            row.unit,
            ", ".join(name for name, seen in (("A", row.fitted_a), ("B", row.fitted_b)) if seen),
        )
        for row in record.errors
    ]
