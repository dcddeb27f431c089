"""Initial values read off runs that the formulas of the static model describe exactly."""

import math
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from tests.physics.references import GROUP_A, through, wrap_of
from tsas_cli.identification.initial_values import initial_values_of
from tsas_cli.identification.phases import Segment
from tsas_cli.physics.closed_form.static import static_model

X = through(20.0, 0.0, 20.0)
F_IN, F_OUT, PHASE = static_model(X, GROUP_A)
A, BEND = wrap_of(GROUP_A), GROUP_A.total_bend_rad

# km without the elastic term (Eqs. 31, 32), and of the whole dead band (29).
KM = {
    "contraction": 1.579 * math.exp(A),
    "loosening": 1.579 * math.exp(-A),
    "dead_band_up": 175.10,
    "dead_band_down": 175.10,
}


def segments():
    names = {1: "contraction", -1: "loosening", 0: "dead_band_up"}
    edges = [0, *(np.flatnonzero(np.diff(PHASE)) + 1), PHASE.size]
    return [Segment(int(a), int(b), names[int(PHASE[a])]) for a, b in pairwise(edges)]


def read(channels, slopes=KM, load="spring"):
    values = {"f_in_N": F_IN, "f_out_N": F_OUT, "x_out_mm": (F_OUT - 25.0) / 1.579}
    measured = {name: values[name] for name in channels}
    run = SimpleNamespace(
        run=SimpleNamespace(load=load, preload_N=None),
        measured=measured,
        channel=measured.get,
        drive_column="x_in_mm",
        conditioned={"x_in_mm": SimpleNamespace(values=X)},
    )
    km = [SimpleNamespace(phase=name, value=value) for name, value in slopes.items()]
    return initial_values_of(run, segments(), km, GROUP_A)


def test_all_channels_tell_everything():
    found = read(["f_in_N", "f_out_N", "x_out_mm"])
    assert found == pytest.approx(
        {
            "friction_coefficient": 0.125,
            "tendon_stiffness_N": GROUP_A.tendon_stiffness_N,
            "load_stiffness_N_per_mm": 1.579,
            "preload_N": 25.0,
        },
        rel=1e-3,
    )


def test_the_tension_at_the_drive_alone_tells_it_by_its_slopes():
    found = read(["f_in_N"])
    assert found["friction_coefficient"] == pytest.approx(0.125, rel=1e-6)
    assert found["load_stiffness_N_per_mm"] == pytest.approx(1.579, rel=1e-6)
    assert found["tendon_stiffness_N"] == pytest.approx(GROUP_A.tendon_stiffness_N, rel=1e-3)
    assert found["preload_N"] == pytest.approx(25.0, rel=0.02)  # but for the elastic term


def test_dead_bands_count_as_their_mean_and_signs_do_not():
    found = read(["f_in_N"], KM | {"dead_band_up": -150.0, "dead_band_down": 200.2})
    assert found["tendon_stiffness_N"] == pytest.approx(GROUP_A.tendon_stiffness_N, rel=1e-3)


def test_what_the_channels_do_not_show_is_left_out():
    nothing = read(["f_out_N"], {})
    assert nothing == {}
    assert set(read(["f_in_N"], {"dead_band_up": 175.1})) == set()
    assert set(read(["f_in_N", "f_out_N"], {})) == {"friction_coefficient"}
    assert "load_stiffness_N_per_mm" not in read(["f_in_N"], KM, load="force")


def test_no_friction_starts_from_a_little():
    """A change of none would not show: the wrap angle times friction begins at 0.01."""
    found = read(["f_in_N"], dict.fromkeys(KM, 1.579))
    assert found["friction_coefficient"] == pytest.approx(0.01 / BEND)


def test_what_is_beyond_all_bounds_is_left_out():
    found = read(["f_in_N"], KM | {"dead_band_up": 1e9, "dead_band_down": 1e9})
    assert "tendon_stiffness_N" not in found
