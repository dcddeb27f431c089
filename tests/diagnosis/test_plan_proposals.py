"""What a plan concludes from sizes that are made up, and how it says so."""

import math
from types import SimpleNamespace

import pytest

from tests.counted import Counted
from tests.diagnosis.sizes import CANDIDATES, LENGTH, MASS, PLAY, cause, seen
from tsas_cli.diagnosis import plan as p
from tsas_cli.diagnosis.plan import propose
from tsas_cli.effects import EFFECTS


@pytest.mark.parametrize("blocks", [1, 6])
def test_fewer_blocks_than_seven_are_too_few(blocks):
    """√7 is more than the 2.6 that are asked for, √6 is not."""
    (said,) = p._few(blocks)
    assert said == (
        f"These runs have {blocks} independent stretches; a diagnosis needs at least 7."
    )
    assert p._few(7) == []


def test_the_score_is_the_mean_logarithm_by_which_sizes_fall():
    before = [seen(PLAY, 0.4), seen(MASS, 0.1), seen(LENGTH, 3.0)]
    after = [seen(PLAY, 0.1), seen(MASS, 0.125), seen(LENGTH, 2.0)]
    found = p._proposal(CANDIDATES[0], before, after)
    assert found.score == pytest.approx((math.log(4.0) + math.log(0.8) + math.log(1.5)) / 3.0)
    assert [(b.cause.effect.name, b.before, b.after) for b in found.better] == [
        (PLAY, 0.4, 0.1),
        (LENGTH, 3.0, 2.0),
    ]


def test_what_was_hidden_is_said_with_the_size_of_the_first_table():
    """Hidden at eleven times the size found, it counts as never named, but is named from there."""
    before, after = [seen(PLAY, 0.1, presliding=1.1)], [seen(PLAY, 0.1)]
    (found,) = p._proposal(CANDIDATES[0], before, after).better
    assert (found.before, found.after) == (1.1, 0.1)


def test_what_falls_by_less_than_a_fifth_is_not_worth_saying():
    found = p._proposal(CANDIDATES[0], [seen(PLAY, 1.2)], [seen(PLAY, 1.01)])
    assert found.better == ()
    assert found.score == pytest.approx(math.log(1.2 / 1.01))
    assert p._proposal(CANDIDATES[0], [seen(PLAY, 1.2)], [seen(PLAY, 0.99)]).better


def test_what_was_not_seen_counts_from_the_largest_size_on():
    largest = cause(PLAY).largest
    before, after = [seen(PLAY, math.inf)], [seen(PLAY, largest / 5.0)]
    assert p._proposal(CANDIDATES[0], before, after).score == pytest.approx(math.log(5.0))
    assert p._proposal(CANDIDATES[0], after, before).score == pytest.approx(-math.log(5.0))
    assert p._proposal(CANDIDATES[0], before, before).score == 0.0
    with pytest.raises(ValueError, match="zip"):
        p._proposal(CANDIDATES[0], before, [*after, *after])


def test_pairs_hide_in_each_other_both_ways():
    sizes = [
        seen(LENGTH, 1.0, drive_compliance=11.0, backlash=11.0),
        seen("drive_compliance", 1.0, free_tendon=math.inf),
        seen(PLAY, 1.0, free_tendon=9.0, load_inertia=math.inf),
    ]
    assert p._groups(sizes) == (("drive_compliance", "free_tendon"),)


class Further:
    """Runs that might be added, with what each lets see; None: without any."""

    left_out = ("run b is short.",)

    def __init__(self, sizes, blocks=20):
        self.sizes, self.blocks = sizes, blocks
        self.added = {k: CANDIDATES[k] for k in sizes if k is not None}
        self.asked = []

    def part(self, k=None):
        def seen(effects, rivals):
            self.asked.append((k, [e.name for e in effects], [e.name for e in rivals]))
            return self.sizes[k]

        return SimpleNamespace(seen=seen, blocks=self.blocks)


SIZES = {
    None: [seen(PLAY, 1.0)],
    1: [seen(PLAY, 0.5)],
    2: [seen(PLAY, 1.0)],  # does not help
    4: [seen(PLAY, 0.1)],
    5: [seen(PLAY, 0.4)],
    6: [seen(PLAY, 0.3)],
}


def test_three_runs_are_proposed_the_best_first():
    steps, runs = Counted(), Further(SIZES, blocks=3)
    steps.ahead(1)
    found = p._plan(runs, steps)
    assert [x.candidate for x in found.proposals] == [CANDIDATES[k] for k in (4, 6, 5)]
    assert found.seen == tuple(SIZES[None])
    assert found.cannot_tell[0] == "run b is short."
    assert "3 independent stretches" in found.cannot_tell[1]
    assert steps.total == steps.done == 2 + 5
    everything = [e.name for e in EFFECTS]
    assert runs.asked[0] == (None, everything, everything)
    assert runs.asked[1] == (1, [PLAY], everything)  # only what was looked at before


def proposed(monkeypatch, runs, *effects, values=None):
    asked = SimpleNamespace()

    def beside_recorded(bench, free):
        asked.free = free
        return runs

    monkeypatch.setattr(p, "joined_to_recorded", beside_recorded)
    trial = SimpleNamespace(values=lambda: values or {})
    asked.steps = Counted()
    return propose(None, trial, effects, asked.steps), asked


def test_the_run_that_distinguishes_best_is_proposed(monkeypatch):
    hidden = [
        seen(PLAY, 0.1, load_inertia=0.2),
        seen(MASS, 0.5, backlash=0.5),
    ]
    less = [seen(PLAY, 0.7), seen(MASS, 0.7)]
    runs = Further({None: [seen(PLAY, 1.0), seen(MASS, 1.0)], 1: less, 3: hidden, 5: less})
    values = {f"{PLAY}.play_mm": 0.1, "presliding.length_mm": 0.2}
    said, asked = proposed(monkeypatch, runs, PLAY, MASS, values=values)
    assert said is CANDIDATES[3]
    assert asked.free == {"presliding.length_mm": 0.2}
    assert asked.steps.total == asked.steps.done == 4
    assert runs.asked == [(k, [PLAY, MASS], [PLAY, MASS]) for k in (None, 1, 3, 5)]


def test_a_run_that_distinguishes_some_alone_is_none(monkeypatch):
    alike = [seen(MASS, 0.1, free_tendon=2.0), seen(LENGTH, 0.1, load_inertia=2.0)]
    apart = [seen(MASS, 0.1), seen(LENGTH, 0.1)]
    sizes = {None: [seen(PLAY, 1.0), *alike], 3: [seen(PLAY, 0.1), *alike]}
    assert proposed(monkeypatch, Further(sizes), PLAY, MASS, LENGTH)[0] is None
    sizes[4] = [seen(PLAY, 0.7), *apart]
    assert proposed(monkeypatch, Further(sizes), PLAY, MASS, LENGTH)[0] is CANDIDATES[4]


@pytest.mark.parametrize("after", [1.0, 0.9])
def test_a_run_that_helps_by_a_tenth_is_none(monkeypatch, after):
    runs = Further({None: [seen(PLAY, 1.0)], 3: [seen(PLAY, after)]})
    assert proposed(monkeypatch, runs, PLAY, MASS)[0] is None
