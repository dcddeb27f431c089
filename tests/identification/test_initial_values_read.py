"""Initial values, formula by formula, on a few numbers."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from tests.physics.references import GROUP_A
from tsas_cli.identification import base_fit as s
from tsas_cli.identification.phases import Segment
from tsas_cli.identification.prepared import Prepared

UP, DOWN = Segment(0, 3, "contraction"), Segment(3, 6, "loosening")


class FewFields(SimpleNamespace):
    has_force = Prepared.has_force


def run_of(x_in=None, *, load="spring", preload_N=None, drive="x_in_mm", x_out=None, **measured):
    values = {name: np.asarray(v, dtype=float) for name, v in measured.items()}
    driven = {} if x_in is None else {"x_in_mm": np.asarray(x_in, dtype=float)}
    driven |= {} if x_out is None else {"x_out_mm": np.asarray(x_out, dtype=float)}
    driven |= {drive: values.pop(drive)} if drive in values else {}
    return FewFields(
        run=SimpleNamespace(load=load, preload_N=preload_N),
        measured=values,
        channel=lambda name: values.get(name, driven.get(name)),
        drive_column=drive,
        conditioned={name: SimpleNamespace(values=v) for name, v in driven.items()},
    )


def test_friction_is_half_the_logarithm_of_the_ratios_quotient():
    """Ratios of 4 and 1/2, each of them the median: of the ratios known."""
    f_in = [40.0, np.nan, 40.0, 5.0, 5.0, 700.0]
    run = run_of(f_in_N=f_in, f_out_N=np.full(6, 10.0))
    assert s._wrap(run, [UP, DOWN], {}) == pytest.approx(0.5 * math.log(8.0))
    one_way = {"contraction": 9.0, "loosening": 1.0}
    assert s._wrap(run, [UP], one_way) == pytest.approx(math.log(3.0))  # √9
    assert s._wrap(run, [DOWN], {}) is None
    assert s._wrap(run, [UP], {"contraction": 9.0}) is None
    slack = run_of(f_in_N=f_in, f_out_N=[0.0, 0.0, -1.0, 10.0, 10.0, 10.0])
    with np.errstate(all="raise"):
        assert s._wrap(slack, [UP, DOWN], {}) is None
    alone = run_of(f_in_N=f_in)
    assert s._wrap(alone, [UP, DOWN], one_way) == pytest.approx(math.log(3.0))


def test_the_friction_of_a_force_that_drives_is_that_of_its_common_ratios():
    """It has no phases: ratios of 4 and 1/2, but for four samples of a hundred."""
    f_in = np.repeat([4.0, 0.5, 1e3, 1e-3], [48, 48, 2, 2])
    run = run_of(f_in_N=f_in, f_out_N=np.ones(100), drive="f_in_N")
    nothing = [Segment(0, 100, "unknown")]
    assert s._wrap(run, nothing, {}) == pytest.approx(0.5 * math.log(8.0))
    driven = run_of(np.arange(100.0), f_in_N=f_in, f_out_N=np.ones(100))
    assert s._wrap(driven, nothing, {}) is None


def test_a_bend_of_nothing_is_a_thousandth():
    run = run_of(f_in_N=np.full(6, 10.0), load="force")
    km = [SimpleNamespace(phase=p, value=v) for p, v in (("contraction", 4.0), ("loosening", 1.0))]
    straight = s.initial_values_of(run, [], km, GROUP_A._replace(total_bend_rad=0.0))
    assert straight == {}  # 693: more than is plausible
    bent = s.initial_values_of(run, [], km, GROUP_A._replace(total_bend_rad=2.0))
    assert bent == pytest.approx({"friction_coefficient": 0.5 * math.log(2.0)})


def test_the_tendon_s_stiffness_is_that_of_the_dead_band():
    """Eq. (29): EA = km L tanh(a/2)/a with a = ln 2."""
    km = {"contraction": 4.0, "loosening": 1.0, "dead_band_up": 150.0, "dead_band_down": -170.0}
    slopes = [SimpleNamespace(phase=p, value=v) for p, v in km.items()]
    a = math.log(2.0)
    exact = 160.0 * GROUP_A.sheath_length_mm * (1.0 / 3.0) / a  # tanh(ln √2) = 1/3
    run = run_of(load="force", f_in_N=np.full(6, 10.0))
    found = s.initial_values_of(run, [], slopes, GROUP_A)
    assert found["tendon_stiffness_N"] == pytest.approx(exact)


X_OUT = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])


@pytest.mark.parametrize(
    ("x_out", "f_out", "found"),
    [
        (X_OUT, 7.0 + 2.0 * X_OUT, (2.0, 7.0)),
        (X_OUT, 7.0 - 2.0 * X_OUT, (-2.0, 7.0)),
        (0.1 * X_OUT, 7.0 + 0.2 * X_OUT, (2.0, 7.0)),
        (X_OUT, np.where(abs(X_OUT - 3.5) < 1.0, np.nan, 7.0 + 2.0 * X_OUT), (2.0, 7.0)),
        (X_OUT, np.where(X_OUT < 5.0, np.nan, 7.0 + 2.0 * X_OUT), None),  # two samples
        (np.full(6, 3.0), X_OUT, None),
    ],
)
def test_the_load_spring_is_the_line_of_f_out_over_x_out(x_out, f_out, found):
    run = run_of(f_out_N=f_out, x_out_mm=x_out, drive="f_in_N")
    names = ("load_stiffness_N_per_mm", "preload_N")
    expected = {} if found is None else dict(zip(names, found, strict=True))
    assert s._spring(run, [], {}) == pytest.approx(expected)


AFAR = [41.0, 40.0, 42.0]


@pytest.mark.parametrize(
    ("run", "found"),
    [
        (run_of(AFAR, x_out=[7.0, 8.0, 9.0]), {"x_in_zero_mm": 40.0, "x_out_zero_mm": 8.0}),
        (run_of(AFAR), {"x_in_zero_mm": 40.0}),
        (run_of(AFAR, x_out=[7.0, np.nan, 9.0]), {"x_in_zero_mm": 40.0}),
        (run_of(AFAR, f_in_N=[1.0, 2.0, 3.0]), {}),  # a force without phases
        (run_of(x_out=AFAR), {}),
        (run_of(f_in_N=AFAR, x_in_mm=AFAR, drive="f_in_N"), {}),  # one that drives is one too
    ],
)
def test_zeros_are_where_the_drive_lets_go_furthest_if_no_force_is_known(run, found):
    assert s._spring(run, [], {}) == found


def test_without_a_force_or_a_displacement_at_the_load_those_at_the_drive_take_their_place():
    x, force = np.array([0.0, 1.0, 2.0]), np.array([4.0, 6.0, 8.0])
    expected = pytest.approx({"load_stiffness_N_per_mm": 2.0, "preload_N": 4.0})
    assert s._spring(run_of(x, f_out_N=force), [], {}) == expected
    assert s._spring(run_of(x_out=x, f_in_N=force, drive="f_in_N"), [], {}) == expected
    assert s._spring(run_of(x, f_out_N=-force), [], {}) == {}  # falls


KM = {"contraction": 4.0, "loosening": 1.0}
X_IN = [0.0, 1.0, 2.0, 2.0, 1.0, 0.0]


def test_the_load_spring_by_the_slopes_and_the_preload_by_the_lines():
    """Both are geometric means: of the slopes, and of the tensions of both lines at zero."""
    f_in = [18.0, 22.0, np.nan, 4.0, 3.0, 2.0]  # 18 + 4 x and 2 + x
    found = s._spring(run_of(X_IN, f_in_N=f_in), [UP, DOWN], KM)
    assert found == pytest.approx({"load_stiffness_N_per_mm": 2.0, "preload_N": 6.0})
    for phase in KM:
        assert s._spring(run_of(X_IN, f_in_N=f_in), [UP, DOWN], {phase: 4.0}) == {}


@pytest.mark.parametrize("at_zero", [-2.0, 0.0])
def test_a_line_that_is_slack_at_zero_gives_the_zero_of_x_in(at_zero):
    """From lines of 18 + 4 x and −2 + x to a stated 20 N: at 0.5 mm and 22 mm; or to the mean."""
    f_in = [18.0, 22.0, 26.0, at_zero + 2.0, at_zero + 1.0, at_zero]
    stated = run_of(X_IN, f_in_N=f_in, preload_N=20.0)
    found = s._spring(stated, [UP, DOWN], KM)
    zero = 0.5 * (0.5 + 20.0 - at_zero)
    assert found == pytest.approx({"load_stiffness_N_per_mm": 2.0, "x_in_zero_mm": zero})
    mean = float(np.mean(f_in))
    zero = 0.5 * ((mean - 18.0) / 4.0 + (mean - at_zero) / 1.0)
    unknown = s._spring(run_of(X_IN, f_in_N=f_in), [UP, DOWN], KM)
    assert unknown == pytest.approx(
        {"load_stiffness_N_per_mm": 2.0, "x_in_zero_mm": zero, "preload_N": mean}
    )


def far(x_in, f_out, *, first=1.5, slope=2.0, intercept=10.0, **stated):
    return s._far_zeros(run_of(x_in, **stated), np.asarray(f_out), first, slope, intercept)


def test_zeros_that_are_near_stay_at_nothing():
    """A travel of 2 mm: up to one as far off, without slack in the run, a fit finds them."""
    travel = np.array([0.0, 1.0, 2.0])
    f_out = 10.0 + 2.0 * travel
    for first in (0.0, 1.9, -1.9):
        assert far(first + travel, f_out) == {}
    for first in (2.1, -2.1):
        assert far(first + travel, f_out) == pytest.approx({"x_in_zero_mm": first})
        assert far(first + travel, f_out, drive="f_in_N") == {}
    assert far(travel - 1.5, f_out - 8.0, intercept=2.0) == pytest.approx({"x_in_zero_mm": -1.5})


def test_a_zero_of_x_in_is_the_median_of_what_the_samples_show():
    f_out = np.array([10.0, 12.0, np.nan, 16.0])
    found = far([40.0, 41.0, 42.0, 46.0], f_out)  # 40, 40 and 43
    assert found == pytest.approx({"x_in_zero_mm": 40.0})


@pytest.mark.parametrize(("stated", "preload"), [(14.0, 14.0), (None, 50.0)])
@pytest.mark.parametrize("intercept", [-10.0, 0.0, 40.0])
def test_an_x_out_that_begins_strokes_away_is_counted_from_the_preload(stated, preload, intercept):
    """f_out = intercept + 2 x_out: stated, or what the run begins with."""
    first = 0.5 * (50.0 - intercept)
    found = far(
        [0.0, 1.0, 2.0], np.full(3, preload), first=first, intercept=intercept, preload_N=stated
    )
    zero = 0.5 * (preload - intercept)
    assert found == pytest.approx({"x_out_zero_mm": zero, "preload_N": preload})
    near = far([0.0, 1.0, 2.0], [50.0, 54.0, 65.0], first=7.4, intercept=50.0, preload_N=14.0)
    assert near == {}


RIG = GROUP_A._replace(sheath_length_mm=1000.0, tendon_stiffness_N=500.0, preload_N=3.0)


def between(x_in, x_out, **told):
    return s._zero_between(run_of(x_in, x_out=x_out, load="displacement", **told), RIG)


def test_a_tendon_between_two_drives_is_slack_below_its_stretch():
    """3 N stretch it by 6 mm: where the ends come closer than that, the zero is off."""
    f_in = [4.0, 5.0, np.nan]
    assert between([-5.0, 0.0, 0.0], [1.0, 0.0, 0.0], f_in_N=f_in) == {}  # just so
    found = between([-20.0, -17.0, 0.0], [1.0, 2.0, 0.0], f_in_N=f_in)
    # −21 less (4 − 3)·2, −19 less (5 − 3)·2; nothing is known of the third
    assert found == pytest.approx({"x_in_zero_mm": -23.0})
    assert between([-20.0, 0.0], [1.0, 0.0], f_out_N=[4.0, 4.0])["x_in_zero_mm"] < 0.0
    assert between([-20.0, 0.0], [1.0, 0.0]) == {}
    assert between([-20.0, 0.0], [1.0, 0.0], f_in_N=[4.0, 4.0], drive="f_in_N") == {}
    both = between([-20.0, -20.0], [1.0, 1.0], f_in_N=[4.0, 4.0], f_out_N=[9.0, 9.0])
    assert both == pytest.approx({"x_in_zero_mm": -23.0})


def test_a_slope_of_nothing_tells_nothing():
    run = run_of(load="force", f_in_N=np.full(6, 10.0))
    for contraction, friction in ((0.0, None), (-1.0, math.log(2.0) / GROUP_A.total_bend_rad)):
        told = (("contraction", contraction), ("loosening", 0.25))
        km = [SimpleNamespace(phase=p, value=v) for p, v in told]
        found = s.initial_values_of(run, [], km, GROUP_A).get("friction_coefficient")
        assert found == pytest.approx(friction)  # of the wrong sign: its size counts
