import pytest

from tsas_cli.recordings.guess.words import kind_of, unit_behind, words_of


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


@pytest.mark.parametrize(
    ("unit", "kind"),
    [
        ("ms", "time"),
        ("in", "displacement"),
        ("kgf", "force"),
        ("Grad", "angle"),
        ("N-m", "torque"),
        ("U/min", "speed"),
        ("°C", "temperature"),
        ("counts", "label"),
        ("mm/s", "other"),
        ("raw", None),
    ],
)
def test_what_a_unit_is_of(unit, kind):
    assert kind_of(unit) == kind
