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
