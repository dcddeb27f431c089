"""Fig. 7: what the project's own fit gives on recordings of a rig that is known."""

import math
from functools import cache

import pytest

from tsas_cli.paper import yang2025
from tsas_studies.reproduction.fig_7 import fig_7
from tsas_studies.reproduction.recording import Noise, fitted_stiffness

PAPER = yang2025()


@cache
def group():
    return fig_7(PAPER)


@cache
def fitted(**noise):
    return fitted_stiffness(PAPER, Noise(**noise), seeds=2)


def rows(kind):
    return [row for row in group().rows if row.what.endswith(kind)]


def test_full_slip_has_the_slopes_of_the_elastic_theory():
    assert fitted()["contraction"].mean == pytest.approx(2.287, rel=5e-4)
    assert fitted()["loosening"].mean == pytest.approx(1.050, rel=5e-4)
    assert set(fitted()) == {"contraction", "loosening", "dead_band_up", "dead_band_down"}


def test_dead_bands_are_fitted_between_their_tangents_and_unlike_the_measurement():
    assert 146.9 < fitted()["dead_band_up"].mean < 175.1
    assert 133.3 < fitted()["dead_band_down"].mean < 175.1


def test_another_seed_gives_another_recording():
    loud = fitted(tension_N=1.0)
    assert loud["contraction"].spread > fitted()["contraction"].spread > 0.0


def test_only_contraction_is_as_measured():
    against_theory, against_fit = rows("against theory"), rows("against the same fit on the model")
    assert [row.verdict for row in against_theory] == ["agrees", *["differs"] * 3]
    assert [row.verdict for row in against_fit] == ["agrees", *["differs"] * 3]
    assert [row.paper for row in against_fit] == [2.35, 0.96, 101.96, 220.63]


def test_the_causes_have_numbers():
    _, loosening, up, down = rows("against the same fit on the model")
    a = 0.5 * math.log(2.35 / 0.96)  # both slopes by Eqs. (31) and (32)
    friction = float(loosening.because.split("μ = ")[1].split()[0])
    assert friction == pytest.approx(a / math.pi, rel=0.02)
    assert "104.5" in up.because
    assert "first 43 %" in down.because


def test_a_measurement_that_fits_agrees():
    paper = PAPER.with_value("stiffness.measured.km_f_b", 165.0)
    found = {row.what: row.verdict for row in fig_7(paper).rows}
    assert found["km measured, f-b (dead band up), against the same fit on the model"] == "agrees"


def test_the_figures_hold_the_bands():
    up, down = group().figures
    assert up.lines[0].y[-1] > up.lines[0].y[0]
    assert down.lines[0].y[-1] < down.lines[0].y[0]
    labels = [line.label for line in up.lines]
    assert "measured, 102 N/mm" in labels
