"""Two folders of `tsas track` held against each other: what was asked for, and the scores."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tsas_cli.recordings.manifest import parse
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
class ControllerPair:
    """One controller under one condition in both folders."""

    a: TrackedResult
    b: TrackedResult

    def ratio(self, score: str) -> float | None:
        """Return B over A of a score's mean."""
        first, second = self.a.scores[score].mean, self.b.scores[score].mean
        return second / first if first and second is not None else None


@dataclass(frozen=True)
class Tracks:
    """Two folders of tracked runs: what differs in the call, and the results that both have.

    `alone` holds, under A and B, the runs that the other one lacks.
    """

    paths: dict[str, Path]
    checksums: dict[str, str]
    settings: list[Setting]
    followed: list[ControllerPair]
    alone: dict[str, list[str]]

    @property
    def other_task(self) -> list[str]:
        """What differs of the task itself: the plant, or the wanted force."""
        return [s.name for s in self.settings if s.name.startswith(TASK)]


def are_tracked(a: Path, b: Path) -> bool:
    """Say whether both are folders of `tsas track`.

    InputError: only one of them is.
    """
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
    return Tracks(
        {"A": a, "B": b},
        {name: sha256_of(path / TRACKING_FILE) for name, path in (("A", a), ("B", b))},
        _settings(*raw),
        [ControllerPair(first[key], second[key]) for key in both],
        {
            name: [result.run for key, result in side.items() if key not in both]
            for name, side in (("A", first), ("B", second))
        },
    )


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
    return [*change_notes(it.paths.values()), *_notes(it)]


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
