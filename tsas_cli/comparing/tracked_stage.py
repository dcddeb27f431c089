"""What `tsas compare` writes and prints of two folders of tracked runs."""

from collections.abc import Iterator

from tsas_cli.comparing.tracked import SCORES, TRACKING_FILE, Tracks
from tsas_cli.records.base import number_text
from tsas_cli.records.comparison import ComparedSide, ScorePair, TrackedComparison
from tsas_cli.records.result import Table


def record_of(it: Tracks) -> TrackedComparison:
    """Return what `compare.json` says."""
    a, b = (
        ComparedSide(
            path=path.as_posix(), kind="tracking", files={TRACKING_FILE: it.checksums[name]}
        )
        for name, path in it.paths.items()
    )
    return TrackedComparison(
        a=a, b=b, settings=it.settings, scores=_scores(it), findings=findings(it), notes=notes(it)
    )


def _scores(it: Tracks) -> list[ScorePair]:
    return [
        ScorePair(
            controller=both.a.controller,
            condition=both.a.condition,
            score=score,
            unit=unit,
            a=both.a.scores[score],
            b=both.b.scores[score],
            ratio=both.ratio(score),
        )
        for both in it.followed
        for score, unit in SCORES.items()
    ]


def findings(it: Tracks) -> list[str]:
    """Return the RMSE of B over that of A by controller, in a sentence for each condition."""
    out = []
    for condition in dict.fromkeys(both.a.condition for both in it.followed):
        ratios = {
            both.a.controller: ratio
            for both in it.followed
            if both.a.condition == condition and (ratio := both.ratio("rmse_N")) is not None
        }
        said = ", ".join(f"{name} {ratio:.3g}" for name, ratio in ratios.items())
        if said:
            out.append(f"RMSE of the force, {condition}, B over A: {said}.")
    return out


def notes(it: Tracks) -> list[str]:
    """Return what to keep in mind, what could not be matched, and what would give more."""
    return list(_notes(it))


def _notes(it: Tracks) -> Iterator[str]:
    if it.other_task:
        yield (
            f"The task is another one ({', '.join(it.other_task)}): the scores are not of the same "
            "plant and wanted force."
        )
    if not it.settings:
        yield "Both were asked for the same."
    for name, runs in it.alone.items():
        if runs:
            yield f"In {name} alone, by controller and condition: {', '.join(runs)}."
    spreads = [both.a.scores["rmse_N"].sd for both in it.followed]
    if any(sd is None for sd in spreads):
        yield "With one seed of noise nothing says how far the scores scatter: take `--seeds 10`."


def tables(it: Tracks) -> list[Table]:
    """Return what the stage prints."""
    asked = [(s.name, _shown(s.a), _shown(s.b)) for s in it.settings]
    scores = [
        (
            one.controller,
            one.condition,
            one.score,
            one.a.text(),
            one.b.text(),
            number_text(one.ratio),
            one.unit,
        )
        for one in _scores(it)
    ]
    every: list[Table] = [
        ("what differs in the call", ("setting", "A", "B"), asked),
        ("scores", ("controller", "condition", "score", "A", "B", "B / A", "unit"), scores),
    ]
    return [table for table in every if table[2]]


def _shown(value: object) -> str:
    """Return a setting as text, a checksum in short."""
    text = "" if value is None else str(value)
    return f"{text[:12]}…" if len(text) == 64 else text
