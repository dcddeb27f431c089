"""What a comparison comes to, in plain sentences."""

from collections.abc import Iterator

from tsas_cli.comparing.compare import Comparison
from tsas_cli.comparing.sides import FALSE_CLAIMS, rounded
from tsas_cli.identification.prepared import CHANNELS
from tsas_cli.records.base import span_text
from tsas_cli.records.comparison import ParameterPair
from tsas_cli.records.diagnosis import INCOMPLETE
from tsas_cli.support.wording import count_of
from tsas_cli.verifying.claims import change_notes

SHOWN = 4  # names that are listed
ALIKE = 0.01  # relative difference of two RMSE that makes none of them better


def findings(it: Comparison) -> list[str]:
    """Return what differs: values, causes, errors; the most important first."""
    every = [*_held_out(it), *_values(it), *_effects(it)]
    for channel in CHANNELS:
        ratios = [r.ratio for r in it.errors if r.channel == channel and r.ratio is not None]
        if ratios:
            span, runs = span_text(ratios), count_of(len(ratios), "run")
            every.append(f"In {channel} the RMSE of B is {span} times that of A ({runs}).")
    return every


def notes(it: Comparison) -> list[str]:
    """Return what to keep in mind, what could not be matched, and what would give more."""
    changed = change_notes(side.path for side in it.sides.values())
    return [*changed, *_recordings(it), *_doubts(it), *_unmatched(it), *_more(it)]


def _values(it: Comparison) -> Iterator[str]:
    common = [p for p in it.pairs if p.difference]
    if not common:
        return
    for pair in it.differing:
        yield _differs(pair)
    if it.tested and not it.differing:
        yield (
            "No value differs by more than its uncertainty: every 95 % interval of a difference "
            f"holds 0 ({len(it.tested)} of them)."
        )
    if len(it.tested) > 1 and it.differing:
        chance = FALSE_CLAIMS * len(it.tested)
        yield (
            f"{len(it.differing)} of {len(it.tested)} intervals exclude 0; {chance:.2g} would by "
            "chance if nothing differed."
        )


def _differs(pair: ParameterPair) -> str:
    a, b, d = pair.a, pair.b, pair.difference
    if not (a and b and d) or d.value is None or d.low is None or d.high is None:
        return ""
    unit = "" if pair.unit == "1" else f" {pair.unit}"
    of = "" if pair.run == "all" else f" of run {pair.run}"
    more, ends = ("larger", (d.low, d.high)) if d.value > 0 else ("smaller", (-d.high, -d.low))
    value, low, high = rounded(abs(d.value), *ends)
    return (
        f"{pair.name}{of} is {more} in B, by {value} [{low}, {high}]{unit} "
        f"({a.value:.4g} in A, {b.value:.4g} in B): more than both uncertainties."
    )


def _effects(it: Comparison) -> Iterator[str]:
    if it.a.model is None or it.b.model is None:
        return
    a, b = it.a.effects, it.b.effects
    for name, own, other in (("A", a, b), ("B", b, a)):
        alone = [effect for effect in own if effect not in other]
        if alone:
            yield f"{name} alone holds {', '.join(alone)}."
    for name, side in it.sides.items():
        found = side.diagnosis
        if found and (found.verdict == "undecided" or found.verdict in INCOMPLETE):
            yield f"The verdict of diagnosis {name} is {found.verdict}: {found.reason}"


def _held_out(it: Comparison) -> Iterator[str]:
    """Yield which model is better in each channel on runs that neither was fitted to."""
    rows = [
        r for r in it.errors if r.ratio is not None and (r.fitted_a, r.fitted_b) == (False,) * 2
    ]
    said = []
    for channel in CHANNELS:
        ratios = [r.ratio for r in rows if r.channel == channel and r.ratio is not None]
        if not ratios:
            continue
        low, high = min(ratios), max(ratios)
        better = (
            "B is better"
            if high < 1.0 - ALIKE
            else "A is better"
            if low > 1.0 + ALIKE
            else "they are alike"
            if low >= 1.0 - ALIKE and high <= 1.0 + ALIKE
            else "neither is better in all"
        )
        said.append(f"in {channel} {better} (RMSE of B {span_text(ratios)} times that of A)")
    if said:
        runs = count_of(len({r.run_b for r in rows}), "held-out run")
        yield f"On {runs}, which neither was fitted to: {'; '.join(said)}."


def _recordings(it: Comparison) -> Iterator[str]:
    if it.a.model is None or it.b.model is None:
        return
    if it.overlap == "none":
        yield (
            "A and B were fitted to different recordings, so that their errors are taken to be "
            "independent. What both models lack alike is in neither interval."
        )
    elif it.overlap == "unknown":
        quiet = [name for name, side in it.sides.items() if side.recordings is None]
        yield (
            f"{' and '.join(quiet)} does not say which recordings it was fitted to, so that no "
            "difference has an interval."
            if len(quiet) == 1
            else "Neither says which recordings it was fitted to, so that no difference has an "
            "interval."
        )
    else:
        how = "the same" if it.overlap == "all" else "in part the same"
        yield (
            f"A and B were fitted to {how} recordings: their errors are not independent, and no "
            "difference has an interval."
            + (" What differs comes from the models, not from the rig." * (it.overlap == "all"))
        )
    if set(it.a.effects) != set(it.b.effects):
        yield (
            "The models hold different effects: a value that both have means in each what its "
            "effects leave to it."
        )


def _doubts(it: Comparison) -> Iterator[str]:
    for name, side in it.sides.items():
        if side.not_converged:
            yield (
                f"The fit of {name} did not converge ({side.not_converged.rstrip('.')}): its "
                "values are not to be relied on."
            )
    if it.errors and it.a.dynamics != it.b.dynamics:
        yield f"The errors are of two laws of motion: A {it.a.dynamics}, B {it.b.dynamics}."
    bound = [p.name for p in it.pairs if p.difference and p.difference.why_none == "at its bound"]
    if bound:
        yield f"At a bound, so that no difference is claimed: {_some(bound)}."
    shared = [r for r in it.errors if r.ratio is not None]
    if shared and all(r.fitted_a is not False or r.fitted_b is not False for r in shared):
        yield (
            "No run is known to be held out from both fits, so that this does not show which model "
            "predicts better: `--on` a dataset of other runs does, and `tsas predict`."
        )
    if any({r.fitted_a, r.fitted_b} == {True, False} for r in it.errors if r.ratio is not None):
        yield (
            "Some recordings were seen by one fit and not by the other, which favours the one that "
            "has seen them."
        )


def _unmatched(it: Comparison) -> Iterator[str]:
    names: dict[str, list[str]] = {"A": [], "B": []}
    for both in it.recordings:
        run_a, run_b = both.ids
        if run_b is None:
            names["A"].append(run_a or "")
        elif run_a is None:
            names["B"].append(run_b)
    alone = [f"{_some(runs)} of {name}" for name, runs in names.items() if runs]
    if alone:
        yield f"Not in both, by the checksum of the recording: {'; '.join(alone)}."
    if same := [run for run in names["A"] if run in names["B"]]:
        yield f"The same name does not make the same recording: {_some(same)}."


def _more(it: Comparison) -> Iterator[str]:
    if it.on is None:
        for name, side in it.sides.items():
            if side.kind != "model" and side.dataset is None:
                yield f"There are no errors of {name}: {side.gone}."
    if it.a.model is None or it.b.model is None:
        yield "A simulation does not hold its model: compare the model files for their values."
    elif not it.shared:
        yield (
            "With `--on DATASET` both models are simulated on the same recordings, which gives "
            "errors for each run and shows where they are."
        )


def _some(names: list[str]) -> str:
    rest = len(names) - SHOWN
    shown = ", ".join(names[:SHOWN])
    return f"{shown} and {rest} more" if rest > 0 else shown
