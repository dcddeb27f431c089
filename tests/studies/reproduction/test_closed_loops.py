"""The paper's closed loops: Table 5, and the argument for stability."""

import numpy as np
import pytest

from tsas_cli.controllers.sliding_mode import Phi
from tsas_cli.paper import yang2025
from tsas_studies.reproduction.closed_loops import followed, settings_for
from tsas_studies.reproduction.lyapunov import ROUNDING, ideal_value, true_phi, value
from tsas_studies.reproduction.table_5 import _rmse, table_5

PAPER = yang2025()


def one_row(paper, start):
    return _rmse(paper, "pid", "undisturbed")


def of_the_table(paper, start):
    return next(r for r in table_5(paper).rows if r.what.startswith(start))


@pytest.mark.parametrize("row", [one_row, pytest.param(of_the_table, marks=pytest.mark.large)])
def test_a_wrong_number_in_table_5_turns_the_verdict(row):
    said = row(PAPER, "RMSE of PID, undisturbed")
    assert (said.verdict, said.paper) == ("agrees", 1.4654)
    assert said.ours == pytest.approx(0.867, rel=0.01)
    wrong = PAPER.with_value("tracking.undisturbed.rmse_pid", 0.4)
    assert row(wrong, "RMSE of PID, undisturbed").verdict == "differs"


def test_the_two_readings_differ_by_a_thousand_in_ks_alone():
    per_mm, per_m = (settings_for(r).controllers for r in ("per mm", "per m"))
    for name in ("sliding_mode", "adaptive_sliding_mode"):
        one, other = per_mm.sliding_modes()[name], per_m.sliding_modes()[name]
        assert one.ks == pytest.approx(1000.0 * other.ks)
        assert one.model_copy(update={"ks": other.ks}) == other
    assert per_mm.sliding_mode.ks == pytest.approx(PAPER.value("controllers.sliding_mode.ks"))
    assert per_mm.pid == per_m.pid


def test_a_controller_without_ks_is_followed_once_for_both_readings():
    assert followed("pid", "undisturbed", "per mm") is followed("pid", "undisturbed", "per m")


def test_without_its_term_of_speed_the_sliding_mode_fares_worse_with_the_spring():
    plain, without = (
        [
            followed("sliding-mode", condition, "per m", phi2=phi2).mean("rmse_N")
            for condition in ("undisturbed", "disturbed")
        ]
        for phi2 in (None, 0.0)
    )
    assert plain[1] < plain[0]
    assert without[1] > 2.0 * without[0]


def test_the_true_parameters_are_those_of_the_drive_with_its_reaction():
    phi1, phi2, phi3 = true_phi()
    pull = 1.579 * np.exp(0.125 * np.pi)
    assert phi1 == pytest.approx(1.43e-4, rel=5e-3)
    assert phi2 == pytest.approx(42.2847 * (52.0 + pull) / 52.0, rel=1e-5)
    assert phi3 == pytest.approx(5.7e-3, rel=5e-3)


def test_a_value_counts_each_estimate_by_its_own_rate():
    estimates = np.array([[1.0], [2.0], [3.0]])
    found = value(np.array([2.0]), estimates, Phi(0.5, 0.5, 0.5), Phi(0.1, 0.2, 0.4))
    expected = 0.5 * 0.5 * 4.0 + 0.25 / 0.2 + 2.25 / 0.4 + 6.25 / 0.8
    assert found == pytest.approx([expected])


def test_the_ideal_loop_loses_v_and_with_an_adaptation_turned_round_gains_it():
    falls = ideal_value()
    assert np.max(np.diff(falls)) < ROUNDING * (falls[0] - falls[-1])
    grows = ideal_value(sign=-1.0)[1000:]  # once s has come near the surface
    assert grows[-1] - grows[0] > 0.5
