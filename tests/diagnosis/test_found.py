"""What a diagnosis writes of its search, on trials that are made up."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.diagnosis import found as f
from tsas_cli.diagnosis.channel_errors import HeldOutErrors
from tsas_cli.diagnosis.diagnose import Diagnosis
from tsas_cli.diagnosis.evidence import Reduction
from tsas_cli.diagnosis.held_out import folds_of
from tsas_cli.diagnosis.proof import FoundCause
from tsas_cli.diagnosis.remainder import Remainder, SlowPart
from tsas_cli.effects import BACKLASH
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit import Solution, Unknown
from tsas_cli.identification.model import Model

PARTS = {"a": 0.75, "b": 0.36, "ab": 0.84, "ac": 0.19, "bc": 0.5, "abc": 0.9}


def names(text):
    return frozenset(text)


class MadeUp:
    bench = SimpleNamespace(on_mesh=lambda found: "c" in found)

    def __init__(self, *sets):
        self.trials = dict.fromkeys(sets)

    def trial(self, found):
        solution = SimpleNamespace(converged=True)
        return SimpleNamespace(mean_square=1.5, solution=solution, values=lambda: {"p": 2.0})

    def gain(self, found):
        return Reduction(PARTS["".join(sorted(found))], 4.0)


def rows(named, *sets):
    search = MadeUp(*sets)
    causes = [SimpleNamespace(effect=name, gain_percent=48.2) for name in named]
    found = f.candidates_of(SimpleNamespace(search=search, causes=causes))
    return [("".join(row.effects), round(row.gain_percent, 9)) for row in found]


def test_single_effects_and_what_stands_in_place_of_the_named_ones():
    """The root falls by 1 − √(1 − part); the best is first, each on the mesh that it needs."""
    sets = [(names(s), "c" in s) for s in ("b", "a", "ab", "ac", "abc")]
    assert rows("ab", *sets) == [("ab", 60.0), ("a", 50.0), ("b", 20.0), ("ac", 10.0)]
    assert rows("", *sets) == [("a", 50.0), ("b", 20.0)]
    assert rows("a", (names("a"), True), (names(""), False)) == []
    # What is named alone is worth what a new fit says, 48.2 %.
    assert rows("a", (names("a"), False), (names("b"), False)) == [("a", 48.2), ("b", 20.0)]


def test_a_candidate_says_how_it_was_fitted():
    (row,) = f.candidates_of(SimpleNamespace(search=MadeUp((names("a"), False)), causes=[]))
    assert row.convincing
    assert (row.test_statistic, row.mean_square, row.converged) == (4.0, 1.5, True)
    assert row.parameters == {"p": 2.0}
    assert f.candidates_of(SimpleNamespace(search=None, causes=[])) == []


def test_how_was_held_out_is_said():
    """Of three runs, of two, and of three of which one alone determines a parameter."""
    one, one_alone = np.ones((36, 1)), np.eye(2)[np.arange(36) // 24]
    for runs, columns, how, start in (
        (3, one, "runs", "each of 3 runs is predicted by a fit to the others; 9 blocks"),
        (2, one[:24], "stretches", "with 2 runs, stretches are predicted"),
        (3, one_alone, "stretches", "the parameters of a run are not determined"),
    ):
        folds = folds_of([np.arange(12) // 4] * runs)
        count = columns.shape[1]
        unknowns = [Unknown(f"{k}", None, 0.0, -9.0, 9.0, 1e3) for k in range(count)]
        solution = Solution(
            np.zeros(count), np.zeros(count, bool), np.zeros(len(columns)), columns, True, "", 1
        )
        judged = SimpleNamespace(folds=folds, bench=SimpleNamespace(rigs=range(runs)))
        final = SimpleNamespace(unknowns=unknowns, solution=solution)
        found = f.evidence_of(SimpleNamespace(judged=judged, final=final))
        assert (found.held_out, found.runs) == (how, runs)
        assert found.sentence.startswith(start)


def test_a_cosine_is_never_more_than_one():
    """Rounding makes some singular values of orthonormal bases larger than that."""
    rng = np.random.default_rng(1)
    bases = [np.linalg.qr(rng.standard_normal((30, 4)))[0] for _ in range(60)]
    assert max(np.linalg.svd(b.T @ b, compute_uv=False).max() for b in bases) > 1.0
    similarity = np.array(f._similarity([*bases, np.zeros((30, 0))]))
    assert similarity.max() == 1.0
    np.testing.assert_allclose(np.diag(similarity)[:-1], 1.0)
    assert not similarity[-1].any()
    assert not similarity[:, -1].any()
    apart = np.linalg.svd(bases[0].T @ bases[1], compute_uv=False).max()
    assert similarity[0, 1] == pytest.approx(apart)


def test_an_effect_without_a_free_parameter_is_like_none():
    """Runs years apart leave a drift without one: it was an error of a maximum of nothing."""
    one = SimpleNamespace(effect=SimpleNamespace(name="a"), signatures=np.ones((5, 1)))
    none = SimpleNamespace(effect=SimpleNamespace(name="b"), signatures=np.ones((5, 0)))
    found = f.signatures_of(SimpleNamespace(screened=[one, none]))
    assert found.visible == (pytest.approx(5.0**0.5), 0.0)
    np.testing.assert_allclose(found.similarity, [[1.0, 0.0], [0.0, 0.0]])


def test_signatures_are_told_in_the_order_of_names():
    """How visible: the length of what all amplitudes do together."""

    def seen(name, signatures):
        return SimpleNamespace(effect=SimpleNamespace(name=name), signatures=np.array(signatures))

    two = [seen("b", [[3.0, 0.0], [0.0, 4.0], [0.0, 0.0]]), seen("a", [[1.0], [0.0], [1.0]])]
    found = f.signatures_of(SimpleNamespace(screened=two))
    assert found.effects == ("a", "b")
    assert found.visible == pytest.approx([np.sqrt(2.0), 5.0])
    half = np.sqrt(0.5)
    np.testing.assert_allclose(found.similarity, [[1.0, half], [half, 1.0]])


def test_a_cause_has_its_title_and_values():
    parameter = Estimate("backlash.play_mm", 0.2, "mm", "fitted", None, 0.1, 0.05, 0.35, True)
    cause = FoundCause("backlash", ("load_friction",), (parameter,), 40.0, (30.0, 50.0))
    found = f.cause_of(cause)
    assert (found.effect, found.title, found.rivals) == (
        "backlash",
        BACKLASH.title,
        ("load_friction",),
    )
    assert found.parameters["play_mm"].content() == {
        "value": 0.2,
        "stderr": 0.1,
        "unit": "mm",
        "at_bound": True,
        "interval_low": 0.05,
        "interval_high": 0.35,
    }
    assert (found.gain_percent, found.gain_interval_percent) == (40.0, (30.0, 50.0))


def test_without_a_search_nothing_is_said_of_one():
    found = Diagnosis("undecided", "why", Model(()), Model(()))
    assert f.candidates_of(found) == []
    assert f.signatures_of(None).effects == ()
    assert f.evidence_of(found).sentence == ""
    assert f.residual_maps_of(found).after == {}
    assert f.remainder_of(found).content() == {
        "unexplained": False,
        "depends_on": [],
        "share_percent": None,
        "mean_square": None,
        "slow_noise": {},
    }


def judged_with(noise):
    run = SimpleNamespace(
        samples={"f_in_N": np.arange(9)},
        run=SimpleNamespace(noise={"f_in_N": noise}),
    )
    by_driven_ends = [{"f_in_N": np.zeros(run.samples["f_in_N"].size)}]
    return SimpleNamespace(bench=SimpleNamespace(closed=[run], by_driven_ends=by_driven_ends))


def test_errors_and_what_is_left_have_units_and_percent():
    left = Remainder(1.5, {}, ("time_s",), slow={"f_in_N": SlowPart(1.2, 0.8)})
    whole = Diagnosis(
        "sufficient",
        "why",
        Model(()),
        Model(()),
        channels={"f_in_N": HeldOutErrors(4.0, math.nan, 1.0, 2.0)},
        remainder=left,
        share_left=0.25,
        judged=judged_with(0.5),
    )
    assert f.held_out_of(whole)["f_in_N"].content() == {
        "unit": "N",
        "rmse_before": 4.0,
        "rmse_after": None,
        "noise_floor": 1.0,
        "attainable": 2.0,
    }
    said = f.remainder_of(whole)
    assert (said.share_percent, said.mean_square, said.depends_on) == (25.0, 1.5, ("time_s",))
    assert said.slow_noise["f_in_N"].text("f_in_N") == (
        "f_in_N has slow noise of 0.6 N, correlated over 0.8 s, which follows no recorded signal."
    )


def test_errors_of_a_model_that_lacks_something_are_no_slow_noise():
    left = Remainder(9.0, {"f_in_N": 3.0}, (), slow={"f_in_N": SlowPart(1.2, 0.8)})
    wrong = Diagnosis(
        "unexplained", "", Model(()), Model(()), remainder=left, judged=judged_with(1)
    )
    assert f.remainder_of(wrong).slow_noise == {}


@pytest.mark.parametrize(("moved", "said"), [(0.05, 1), (0.11, 0), (None, 0)])
def test_a_cause_that_a_law_moves_out_of_its_interval_is_said(moved, said):
    play = Estimate("backlash.play_mm", 0.1, "mm", "fitted", None, 0.01, 0.08, 0.12)
    cause = FoundCause("backlash", (), (play,), 40.0, (30.0, 50.0))
    model = Model(() if moved is None else (Estimate(play.name, moved, "mm", "fitted"),))
    result = Diagnosis("partly", "", model, model, (cause,), law=SimpleNamespace())
    sentences = list(f.beside_a_law(result))
    assert len(sentences) == said
    assert all("is 0.05 in model-extended.toml, and 0.1 [0.08, 0.12]" in s for s in sentences)
    assert list(f.beside_a_law(Diagnosis("named", "", model, model, (cause,)))) == []
