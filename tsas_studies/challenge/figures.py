"""The rates of the summary.

Shares of what should have been found are over all cases: a missing answer has not found it. Shares
of what should not have been said are over the cases with an answer.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

from tsas_studies.challenge.conditions import CONDITIONS
from tsas_studies.challenge.judge import NO_ANSWER, Judged
from tsas_studies.challenge.rates import Rate, rate
from tsas_studies.challenge.targets import SIZES, TARGETS, Target
from tsas_studies.challenge.truth import OUTSIDE

RECOGNISED = ("recognised", "right kind")
LARGE_GAIN = 0.8  # share of what is attainable on held-out data


@dataclass(frozen=True)
class ScoreRate:
    """One rate; `worst` is the effect farthest from the target, where it holds for each one."""

    name: str
    title: str
    rate: Rate
    worst: tuple[str, Rate] | None = None

    @property
    def target(self) -> Target | None:
        """What the rate is held against."""
        return TARGETS.get(self.name)

    @property
    def met(self) -> bool | None:
        """Whether the target is met; None without a target or a case."""
        share = (self.worst[1] if self.worst else self.rate).share
        if self.target is None or share is None:
            return None
        return self.target.low <= share <= self.target.high


def figures(judged: Sequence[Judged]) -> list[ScoreRate]:
    """Return every rate of the summary, in the order in which it is printed."""
    clean, slow, realistic = (
        [j for j in judged if j.case.conditions == conditions] for conditions in CONDITIONS
    )
    return [
        ScoreRate("answered", "answered", rate(j.outcome != NO_ANSWER for j in judged)),
        *_of_singles(clean),
        *(figure for size in sizes(clean) for figure in _of_one(clean, size)),
        *_of_several(clean),
        *_of_nothing(clean),
        *(_under("slow", f) for f in _of_nothing(slow)),
        *_beyond(clean),
        *_wrong("fault", "small fault of a sensor", _of(clean, "fault")),
        *_of_recording(judged),
        *_of_names(clean),
        *(
            _under("realistic", f)
            for part in (_of_singles, _of_several, _of_nothing, _beyond, _of_names)
            for f in part(realistic)
        ),
    ]


def _under(conditions: str, figure: ScoreRate) -> ScoreRate:
    name, title = f"{conditions}_{figure.name}", f"{conditions}, {figure.title}"
    return replace(figure, name=name, title=title)


def _of(judged: Iterable[Judged], *kinds: str) -> list[Judged]:
    return [j for j in judged if j.case.kind in kinds]


def _of_singles(judged: Iterable[Judged]) -> list[ScoreRate]:
    return [ScoreRate("one_exact", "one effect: named exactly", _exact(_of(judged, "one")))]


def _of_several(judged: Iterable[Judged]) -> list[ScoreRate]:
    pairs, triples = _of(judged, "pair"), _of(judged, "triple")
    return [
        ScoreRate("pair_both", "two effects: both named", _share(pairs, "both")),
        ScoreRate("pair_one", "two effects: one of them named", _share(pairs, "one")),
        ScoreRate("pair_false", "two effects: another one named", _false(pairs)),
        ScoreRate("triple_all", "three effects: all named, or as rivals", _share(triples, "all")),
        ScoreRate("triple_false", "three effects: another one named", _false(triples)),
    ]


def _of_nothing(judged: Iterable[Judged]) -> list[ScoreRate]:
    nothing = _of(judged, "nothing")
    return [
        ScoreRate("nothing_named", "nothing hidden: something named", _false(nothing)),
        ScoreRate("nothing_unexplained", "nothing hidden: called unexplained", _warned(nothing)),
    ]


def _beyond(judged: Iterable[Judged]) -> list[ScoreRate]:
    """Return the rates of what is near to the catalogue or not in it."""
    beyond = _of(judged, *OUTSIDE)
    return [
        *_wrong("beyond", "not in the catalogue", beyond),
        ScoreRate(
            "beyond_recognised",
            "not in the catalogue: said so, or right in kind",
            _share(beyond, *RECOGNISED),
        ),
        ScoreRate(
            "beyond_gain",
            f"not in the catalogue: {100 * LARGE_GAIN:g} % of the attainable reduction",
            rate(j.gain >= LARGE_GAIN for j in beyond if j.gain is not None),
        ),
        ScoreRate(
            "beyond_place",
            "not in the catalogue: described, at the right place",
            rate(j.right_place for j in beyond if j.right_place is not None),
        ),
        *(
            ScoreRate(
                f"{kind}_recognised", f"  of these {kind}", _share(_of(beyond, kind), *RECOGNISED)
            )
            for kind in OUTSIDE
        ),
    ]


def _wrong(name: str, title: str, cases: Sequence[Judged]) -> list[ScoreRate]:
    """Return how often something wrong is named, and how often without a warning."""
    said = f"{title}: something wrong named"
    alone = (j.outcome == "false" for j in _answered(cases))
    return [
        ScoreRate(f"{name}_wrong", said, _false(cases)),
        ScoreRate(f"{name}_unwarned", f"{said}, no warning", rate(alone)),
    ]


def _of_recording(judged: Iterable[Judged]) -> list[ScoreRate]:
    """Return the rates of faults of recording, and of sound recordings of any conditions."""
    listed = list(judged)
    faults, sound = _of(listed, "recording"), _of(listed, "nothing")
    at = sorted({j.case.size for j in faults if j.case.size is not None})
    return [
        ScoreRate("recording_right", "fault of recording: said", _share(faults, "right")),
        *(
            ScoreRate(
                f"recording_{size:g}_right",
                f"  at {size:g} times the noise",
                _share((j for j in faults if j.case.size == size), "right"),
            )
            for size in at
        ),
        ScoreRate("recording_wrong", "fault of recording: a mechanism named", _false(faults)),
        ScoreRate("sound_accused", "nothing hidden: a fault of recording said", _accused(sound)),
        ScoreRate(
            "one_accused",
            "one effect: a fault of recording said",
            _accused(_of(listed, "one")),
        ),
    ]


def _of_names(judged: Iterable[Judged]) -> list[ScoreRate]:
    listed = list(judged)
    covered = [inside for j in listed for inside in j.covered]
    stated = [inside for inside in covered if inside is not None]
    return [
        ScoreRate(
            "right_refused",
            "one effect: its name refused or with a warning",
            rate(j.refused for j in listed if j.right_name),
        ),
        ScoreRate("coverage", "95 % intervals that hold the true parameter", rate(stated)),
        ScoreRate(
            "without_interval",
            "parameters without an interval",
            rate(inside is None for inside in covered),
        ),
    ]


def sizes(judged: Iterable[Judged]) -> list[float]:
    """Return the sizes of single effects, the largest first; those with a target are there."""
    found = {j.case.size for j in judged if j.case.kind == "one" and j.case.size is not None}
    return sorted(found | set(SIZES), reverse=True)


def of_size(judged: Iterable[Judged], size: float) -> list[Judged]:
    """Return the cases of a single effect at one size."""
    return [j for j in judged if j.case.kind == "one" and j.case.size == size]


def by_effect(judged: Iterable[Judged]) -> dict[str, list[Judged]]:
    """Return the cases of single effects by the name of the effect."""
    groups: dict[str, list[Judged]] = {}
    for one in judged:
        groups.setdefault(one.case.hidden[0].effect, []).append(one)
    return groups


def _of_one(judged: Iterable[Judged], size: float) -> list[ScoreRate]:
    cases, name, title = of_size(judged, size), f"size_{size:g}", f"size {size:g}"
    exact_alone = (j.outcome == "exact" and not any(j.rivals) for j in cases)
    return [
        _for_each(f"{name}_exact", f"{title}: named exactly", cases, _exact),
        ScoreRate(
            f"{name}_alone", f"{title}: named exactly, no rival beside it", rate(exact_alone)
        ),
        ScoreRate(f"{name}_rivals", f"{title}: within the rivals", _share(cases, "rivals")),
        _for_each(f"{name}_false", f"{title}: named falsely", cases, _false),
    ]


def _for_each(
    name: str, title: str, cases: Sequence[Judged], measure: Callable[[Sequence[Judged]], Rate]
) -> ScoreRate:
    target = TARGETS.get(name)
    rates = {effect: measure(group) for effect, group in by_effect(cases).items()}
    shares = {effect: r.share for effect, r in rates.items() if r.share is not None}
    if target is None or not shares:
        return ScoreRate(name, title, measure(cases))
    pick = min if target.low > 0.0 else max
    worst = pick(shares, key=shares.__getitem__)
    return ScoreRate(name, title, measure(cases), (worst, rates[worst]))


def _exact(cases: Sequence[Judged]) -> Rate:
    return _share(cases, "exact")


def _share(cases: Iterable[Judged], *outcomes: str) -> Rate:
    return rate(j.outcome in outcomes for j in cases)


def _warned(cases: Iterable[Judged]) -> Rate:
    return rate(j.diagnosis.warns for j in cases if j.diagnosis is not None)


def _accused(cases: Iterable[Judged]) -> Rate:
    return rate(bool(j.diagnosis.faults) for j in cases if j.diagnosis is not None)


def _false(cases: Iterable[Judged]) -> Rate:
    return rate(bool(j.false_names) for j in _answered(cases))


def _answered(cases: Iterable[Judged]) -> list[Judged]:
    return [j for j in cases if j.diagnosis is not None]
