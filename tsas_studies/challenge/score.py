"""The score of one entry: figures beside targets, the classes by effect, and the confusions."""

from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from statistics import mean, median
from typing import Any, get_args

from tsas_cli.support import __version__
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import sha256_of
from tsas_studies.challenge.cases import Kind
from tsas_studies.challenge.conditions import CONDITIONS, kind_label
from tsas_studies.challenge.entry import Entry, read_entry
from tsas_studies.challenge.figures import RECOGNISED, ScoreRate, by_effect, figures, of_size, sizes
from tsas_studies.challenge.judge import NO_ANSWER, Judged, judge
from tsas_studies.challenge.sums import check_answers, check_recordings
from tsas_studies.challenge.truth import CATALOGUE, FILE, Truth, read_truth

CLASSES = ("exact", "rivals", "false", "none", NO_ANSWER)


def score_entries(sealed: Path, folders: Iterable[Path]) -> dict[str, Any]:
    """Return what `score.json` holds: the scores of several entries on one sealed set.

    InputError: the answers or a diagnosis are malformed, an entry is given twice, or the answers or
    recordings of a case are not those that were sealed.
    """
    answers = read_truth(sealed)
    check_answers(sealed)
    check_recordings(sealed, answers)
    sums = {name: case.sums for name, case in answers.cases.items()}
    entries: dict[str, Any] = {}
    for folder in folders:
        label = str(folder)
        if label in entries:
            raise InputError("the entry is given twice", where=folder)
        entries[label] = score(answers, read_entry(folder, answers.cases, sums))
    kinds = Counter(kind_label(case.kind, case.conditions) for case in answers.cases.values())
    order = (kind_label(kind, conditions) for conditions in CONDITIONS for kind in get_args(Kind))
    single = {e for case in answers.cases.values() if case.kind == "one" for e in case.effects}
    return {
        "format": 1,
        "stage": "challenge score",
        "version": __version__,
        "answers": {
            "sha256": sha256_of(sealed / FILE),
            "seed": answers.seed,
            "cases": {kind: count for kind in order if (count := kinds[kind])},
            "effects_not_in_the_set": [name for name in CATALOGUE if name not in single],
        },
        "entries": entries,
    }


def score(answers: Truth, entry: Entry) -> dict[str, Any]:
    """Return the score of one entry, as docs/challenge.md describes it."""
    judged = judge(answers, entry)
    cases = list(judged.values())
    said = entry.diagnoses.values()
    seconds = [diagnosis.seconds for diagnosis in said if diagnosis.seconds is not None]
    gains = [j.gain for j in cases if j.case.hidden and j.gain is not None]
    rivals = [count for j in cases for count in j.rivals]
    return {
        "figures": [_figure(figure) for figure in figures(cases)],
        "rivals_per_name": {"mean": mean(rivals) if rivals else None, "names": len(rivals)},
        "gain": {"median": median(gains) if gains else None, "cases": len(gains)},
        "seconds": {
            "median": median(seconds) if seconds else None,
            "max": max(seconds, default=None),
            "cases": len(seconds),
        },
        "effects": _effects(cases),
        "confusion": _confusion(cases),
        "no_answer": entry.no_answer,
        "cases": {
            name: {"outcome": j.outcome, "named_falsely": sorted(j.false_names)}
            for name, j in judged.items()
        },
    }


def _figure(figure: ScoreRate) -> dict[str, Any]:
    low, high = figure.rate.interval() or (None, None)
    worst = figure.worst and {
        "effect": figure.worst[0],
        "hits": figure.worst[1].hits,
        "cases": figure.worst[1].cases,
    }
    return {
        "name": figure.name,
        "title": figure.title,
        "hits": figure.rate.hits,
        "cases": figure.rate.cases,
        "share": figure.rate.share,
        "interval_low": low,
        "interval_high": high,
        "worst": worst,
        "target": figure.target and figure.target.text(),
        "met": figure.met,
    }


def _effects(cases: list[Judged]) -> list[dict[str, Any]]:
    clean = [j for j in cases if j.case.conditions == "clean"]
    return [
        {"effect": effect, "size": size, "cases": len(group)}
        | {name: sum(j.outcome == name for j in group) for name in CLASSES}
        for size in sizes(clean)
        for effect, group in by_effect(of_size(clean, size)).items()
    ]


def _confusion(cases: list[Judged]) -> list[dict[str, Any]]:
    """Return what was said where it is not the truth, the most frequent first."""
    wrong = [j for j in cases if j.outcome not in RECOGNISED and _truth(j) != _said(j)]
    found = Counter((_truth(j), _said(j)) for j in wrong)
    return [
        {"hidden": truth, "said": said, "cases": count}
        for (truth, said), count in found.most_common()
    ]


def _truth(judged: Judged) -> str:
    if judged.case.unknown is not None:
        return f"{judged.case.unknown} (not in the catalogue)"
    return " + ".join(sorted(judged.case.effects)) or "nothing"


def _said(judged: Judged) -> str:
    if judged.diagnosis is None:
        return NO_ANSWER
    silent = "unexplained" if judged.diagnosis.warns else "nothing"
    return " + ".join(sorted(judged.diagnosis.effects)) or silent
