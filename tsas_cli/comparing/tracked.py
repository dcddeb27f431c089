"""Two folders of `tsas track` held against each other: what was asked for, and the scores."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tsas_cli.comparing.predictions import ratio_of
from tsas_cli.recordings.validation import parse
from tsas_cli.records.base import number_text
from tsas_cli.records.comparison import ComparedSide, ScorePair, Setting, TrackedComparison
from tsas_cli.records.result import Table
from tsas_cli.records.tracking import TrackedResult, TrackingFile
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import read_json, sha256_of
from tsas_cli.verifying.claims import change_notes

TRACKING_FILE = TrackingFile.FILE
SCORES = {  # those that are better the smaller they are, with their units
    "rmse_N": "N",
    "outside_percent": "%",
    "effort_rpm": "rpm",
    "chatter_rpm_per_s": "rpm/s",
}
ASKED = ("model", "plant", "drive", "dynamics", "gains", "reference", "settings", "seeds")
TASK = ("plant", "dynamics", "reference", "settings.reference")  # with others the task is another


@dataclass(frozen=True)
class Tracks:
    """Two folders of tracked runs: what is said of both, and the results that both have.

    `followed` holds those of A and of B for each controller and condition.
    """

    paths: dict[str, Path]
    record: TrackedComparison
    followed: list[tuple[TrackedResult, TrackedResult]]


def are_tracked(a: Path, b: Path) -> bool:
    """Say whether both are folders of `tsas track`; InputError: only one of them is."""
    there = [(path / TRACKING_FILE).is_file() for path in (a, b)]
    if any(there) and not all(there):
        raise InputError(
            "tracked runs can be compared with tracked runs only",
            where=b if there[0] else a,
            expected=f"a folder with {TRACKING_FILE}",
        )
    return all(there)


def compare_tracked(a: Path, b: Path) -> Tracks:
    """Hold two folders against each other, by controller and condition."""
    raw = [read_json(path / TRACKING_FILE) for path in (a, b)]
    one, other = (
        parse(TrackingFile, r, p / TRACKING_FILE) for r, p in zip(raw, (a, b), strict=True)
    )
    same = {n for n, what in one.conditions.items() if other.conditions.get(n) == what}
    first, second = (
        {(r.controller, r.condition): r for r in side.results} for side in (one, other)
    )
    both = [key for key in first if key in second and key[1] in same]
    paths, settings = {"A": a, "B": b}, _settings(*raw)
    followed = [(first[key], second[key]) for key in both]
    scores = [
        _score(*results, score, unit) for results in followed for score, unit in SCORES.items()
    ]
    alone = {
        name: [result.run for key, result in side.items() if key not in both]
        for name, side in (("A", first), ("B", second))
    }
    files = ({TRACKING_FILE: sha256_of(path / TRACKING_FILE)} for path in (a, b))
    of_a, of_b = (
        ComparedSide(path=path.as_posix(), kind="tracking", files=file)
        for path, file in zip((a, b), files, strict=True)
    )
    record = TrackedComparison(
        a=of_a,
        b=of_b,
        settings=settings,
        scores=scores,
        findings=tuple(_findings(scores)),
        notes=[*change_notes((a, b)), *_notes(settings, scores, alone)],
    )
    return Tracks(paths, record, followed)


def _settings(a: Mapping[str, Any], b: Mapping[str, Any]) -> list[Setting]:
    flat = [dict(_flat({name: side.get(name) for name in ASKED})) for side in (a, b)]
    names = dict.fromkeys([*flat[0], *flat[1]])
    found = (Setting(name=n, a=flat[0].get(n), b=flat[1].get(n)) for n in names)
    return [s for s in found if s.a != s.b]


def _flat(content: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in content.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{key}.")
        elif key != "folder":  # where a file was is no setting
            yield f"{prefix}{key}", value


def _score(a: TrackedResult, b: TrackedResult, score: str, unit: str) -> ScorePair:
    first, second = a.scores[score], b.scores[score]
    return ScorePair(
        controller=a.controller,
        condition=a.condition,
        score=score,
        unit=unit,
        a=first,
        b=second,
        ratio=ratio_of(second.mean, first.mean),
    )


def _findings(scores: list[ScorePair]) -> Iterator[str]:
    """Yield the RMSE of B over that of A by controller, in a sentence for each condition."""
    rmse = [one for one in scores if one.score == "rmse_N" and one.ratio is not None]
    for condition in dict.fromkeys(one.condition for one in rmse):
        of = (f"{one.controller} {one.ratio:.3g}" for one in rmse if one.condition == condition)
        yield f"RMSE of the force, {condition}, B over A: {', '.join(of)}."


def _notes(
    settings: list[Setting], scores: list[ScorePair], alone: dict[str, list[str]]
) -> Iterator[str]:
    """Yield what to keep in mind, what could not be matched, and what would give more."""
    if other := [s.name for s in settings if s.name.startswith(TASK)]:
        yield (
            f"The task is another one ({', '.join(other)}): the scores are not of the same "
            "plant and wanted force."
        )
    if not settings:
        yield "Both were asked for the same."
    for name, runs in alone.items():
        if runs:
            yield f"In {name} alone, by controller and condition: {', '.join(runs)}."
    if any(one.score == "rmse_N" and one.a.sd is None for one in scores):
        yield "With one seed of noise nothing says how far the scores scatter: take `--seeds 10`."


def tables(record: TrackedComparison) -> list[Table]:
    """Return what the stage prints."""
    asked = [(s.name, _shown(s.a), _shown(s.b)) for s in record.settings]
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
        for one in record.scores
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
