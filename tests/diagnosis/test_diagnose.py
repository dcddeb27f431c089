"""Verdict, reason and estimates of a diagnosis."""

from types import SimpleNamespace

import numpy as np
import pytest

from tests.identification.recorded import manifest, prepared
from tsas_cli.diagnosis import diagnose as d
from tsas_cli.diagnosis.diagnose import verdict_of
from tsas_cli.diagnosis.nominal import nominal_fit, stiffer_than_stated
from tsas_cli.diagnosis.remainder import Remainder, share_left
from tsas_cli.identification.model import data_sheet
from tsas_studies.challenge.rig.tendon import Rig as VirtualRig


def test_a_tendon_stays_near_its_data_sheet_where_the_length_is_known():
    """Between 0.85 of it and 1/0.85 of it; without the length the data show their ratio alone."""
    for length in (VirtualRig().sheath_length_mm, None):
        run = prepared(VirtualRig(), sheath_length_mm=length)
        sheet = manifest(run)
        problem = nominal_fit(sheet, data_sheet(sheet), [run])
        (tendon,) = (u for u in problem.unknowns if u.name == "tendon_stiffness_N")
        bounds = np.exp([tendon.lower, tendon.upper])
        if length is None:
            assert bounds == pytest.approx((10.0, 1e8))
        else:
            stiffness = VirtualRig().axial_stiffness
            assert bounds == pytest.approx((0.85 * stiffness, stiffness / 0.85), rel=1e-3)


@pytest.mark.parametrize(("at_bound", "mean_square"), [(True, 0.9), (True, 1.04), (False, 9.0)])
def test_a_tendon_at_the_noise_or_within_its_bounds_is_not_called_stiffer(at_bound, mean_square):
    """Nothing is fitted again then: there are no runs to fit."""
    sheet = manifest(prepared(VirtualRig()))
    tendon = SimpleNamespace(name="tendon_stiffness_N", value=1e9, at_bound=at_bound)
    base = SimpleNamespace(model=SimpleNamespace(estimates=[tendon]))
    nominal = SimpleNamespace(mean_square=mean_square)
    assert stiffer_than_stated(sheet, data_sheet(sheet), base, nominal) is None


def stated(*parts):
    return [Remainder(mean_square, {}, (), reducible) for mean_square, reducible in parts]


@pytest.mark.parametrize(
    ("start", "after", "left"),
    [
        ((9.0, 4.0), (2.0, 1.0), 1.0 / 8.0),  # of 9 − 1 there is left 1
        ((9.0, 4.0), (2.0, 0.0), 0.0),  # slow noise of the same size is no cause's
        ((1.0, 0.0), (1.0, 0.0), 0.0),
        ((2.0, 1.0), (3.0, 2.0), 1.0),
    ],
)
def test_the_share_left_is_of_what_could_be_explained(start, after, left):
    assert share_left(*stated(start, after)) == pytest.approx(left)


def test_why_nothing_can_be_diagnosed():
    good = SimpleNamespace(converged=True, message="")
    bad = SimpleNamespace(converged=False, message="steps")

    def reason(runs, fitted):
        problem = SimpleNamespace(runs=runs)
        return d._not_possible(SimpleNamespace(problem=problem, fitted=fitted))

    assert reason([1], good) is None
    assert reason([], good).startswith("No run lasts")
    assert reason([1], None).startswith("No parameter")
    assert reason([1], bad).endswith("did not converge (steps).")


@pytest.mark.parametrize(
    ("rivals", "stand_ins", "complete", "verdict"),
    [
        ([], [], True, "sufficient"),
        ([], [], False, "unexplained"),
        ([], ["backlash"], True, "stand_in"),
        ([], ["backlash"], False, "stand_in"),
        ([()], [], True, "named"),
        ([()], [], False, "partly"),
        ([()], ["backlash"], True, "partly"),
        ([(), ("play",)], [], True, "ambiguous"),
        ([("play",)], [], False, "partly"),
    ],
)
def test_the_verdict(rivals, stand_ins, complete, verdict):
    assert verdict_of(rivals, stand_ins, complete=complete) == verdict
