import warnings

import numpy as np
import pytest

from tests.recordings.guess.rig_files import run
from tsas_cli.recordings.guess.looks import correlation, increases, is_even, leads, sign_of
from tsas_cli.recordings.guess.words import kind_of, unit_behind, words_of

# Nearer to the drive first.
PAIRS = [("f_in_N", "x_in_mm"), ("f_in_N", "f_out_N"), ("x_in_mm", "x_out_mm")]


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("late_s", [-0.05, 0.0, 0.05])
@pytest.mark.parametrize("scale", [1.0, -25.4])
def test_friction_says_which_is_nearer_to_the_drive_and_a_delay_does_not(pair, late_s, scale):
    columns = run()
    near, far = (columns[name] for name in pair)
    near = scale * np.interp(columns["time_s"] - late_s, columns["time_s"], near)
    assert leads(near, far) == 1
    assert leads(far, near) == -1


@pytest.mark.parametrize("late", [1, 5, 20])
def test_a_delay_alone_tells_nothing(late):
    t = np.arange(4000) / 200
    x = 10.0 - 10.0 * np.cos(t)
    noise = np.random.default_rng(1).normal(0.0, 0.002, (2, t.size))
    assert leads(x + noise[0], np.roll(x, late) + noise[1]) == 0


def test_a_play_tells_the_order_of_strokes_at_even_speed_only_where_it_is_wide():
    t = np.arange(4000) / 200
    x = np.abs((t % 8.0) - 4.0)
    for width, order in [(0.6, 1), (0.02, 0)]:
        y = [0.0]
        for value in x:
            y.append(min(max(y[-1], value - width), value))
        assert leads(x, np.array(y[1:])) == order


def test_what_does_not_go_together_or_does_not_turn_tells_nothing():
    columns = run()
    assert leads(columns["x_in_mm"], columns["time_s"]) == 0
    assert leads(columns["x_in_mm"][:300], columns["f_in_N"][:300]) == 0
    jumping = np.repeat([0.0, 9.0, 0.0, 9.0, 0.0], 40)  # no sample is between its ends
    with warnings.catch_warnings(action="error"):
        assert leads(jumping, jumping) == 0
    assert correlation(columns["x_in_mm"], np.ones_like(columns["x_in_mm"])) == 0.0
    assert correlation(columns["x_in_mm"], np.full_like(columns["x_in_mm"], np.nan)) == 0.0
    with warnings.catch_warnings(action="error"):  # squares that vanish
        assert abs(correlation(columns["x_in_mm"], columns["x_in_mm"] * 5e-324)) <= 1.0


def test_clocks_and_signs():
    t = np.arange(50) / 10
    assert increases(t)
    assert not increases(np.append(t, t[-1]))
    assert not increases(np.array([0.0, np.nan, 1.0]))
    assert is_even(np.delete(t, 20))
    assert not is_even(t**2)
    assert [sign_of(v) for v in (t + 1, -t - 1, t - 2)] == [1, -1, 0]


@pytest.mark.parametrize(
    ("name", "quantity", "end", "is_reference"),
    [
        ("Fin", "force", "in", False),
        ("T_out", "force", "out", False),
        ("t", "time", None, False),
        ("xOut", "displacement", "out", False),
        ("LoadCellDistal", "force", "out", False),
        ("Load cell 2", "force", None, False),
        ("Eingangskraft", "force", "in", False),
        ("Déplacement sortie", "displacement", "out", False),
        ("输入力", "force", "in", False),
        ("Back-end CUI Encoder", "displacement", "in", False),
        ("End effector position", "displacement", "out", False),
        ("Motor speed", "speed", "motor", False),
        ("Motor current", "other", "motor", False),
        ("Force setpoint", "force", None, True),
        ("f_out_ref", "force", "out", True),
        ("Extension", "displacement", None, False),  # no tension
        ("Distance", None, None, False),  # not distal
        ("Force in and out", "force", None, False),
        ("Tip orientation y", "angle", "out", False),
        ("A", None, None, False),
    ],
)
def test_words_state_quantity_end_and_reference(name, quantity, end, is_reference):
    words = words_of(name)
    assert (words.quantity, words.end, words.is_reference) == (quantity, end, is_reference)


@pytest.mark.parametrize(
    ("name", "stem", "unit"),
    [
        ("time_ms", "time", "ms"),
        ("Force N", "Force", "N"),
        ("x_in_mm", "x_in", "mm"),
        ("time_s", "time", "s"),
        # A slave and no second, an end and no inch; and no unit of a force.
        *((name, name, "") for name in ("F_s", "x_in", "x_m", "force_mm", "A")),
    ],
)
def test_a_unit_behind_a_name_has_to_fit_it(name, stem, unit):
    assert unit_behind(name) == (stem, unit)


def test_what_a_unit_is_of():
    known = {"ms": "time", "in": "displacement", "kgf": "force", "Grad": "angle", "N-m": "torque"}
    known |= {"U/min": "speed", "°C": "temperature", "counts": "label", "mm/s": "other"}
    assert {unit: kind_of(unit) for unit in known} == known
    assert kind_of("raw") is None
