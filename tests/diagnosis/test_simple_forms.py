"""A fitted curve is said to have a simple form where it has one, with its error."""

import numpy as np

from tsas_cli.diagnosis.simple_forms import exponential, power, straight_line

TRAVEL = np.concatenate(([0.0], np.geomspace(1e-3, 4.0, 200)))
SPEEDS = np.array([1.0, 5.0, 25.0])


def test_a_line_is_said_with_its_largest_error_over_the_span():
    bent = np.array([0.0, 1.0, 2.2, 3.0, 4.0])  # the line through all lies 0.16 below the middle
    assert straight_line(bent) == ", in a straight line to within 4 % of that"
    assert straight_line(np.array([0.0, 2.0, 3.0, 2.0, 0.0])) == ""


def test_a_constant_has_no_further_form():
    assert straight_line(np.full(5, 3.0)) == ""
    assert exponential(TRAVEL, np.full(TRAVEL.size, 3.0)) == ""


def test_an_exponential_approach_is_said_with_its_travel_whether_it_rises_or_decays():
    rises = 2.0 * (1.0 - np.exp(-TRAVEL / 0.25))
    assert exponential(TRAVEL, rises) == ", as 1 − exp(−travel/0.25 mm)"
    assert exponential(TRAVEL, 0.3 - 0.1 * rises).startswith(", as 1 − exp(−travel/0.25 mm)")


def test_what_yields_at_once_is_no_exponential():
    """A straight rise to the end of the first tenth: the exponential differs by 0.2 of it."""
    assert exponential(TRAVEL, np.minimum(TRAVEL / 0.4, 1.0)) == ""


def test_a_power_of_the_speed_is_said_with_its_exponent():
    assert power(SPEEDS, SPEEDS**-0.2) == ", as |v|^-0.2"
    assert power(SPEEDS, np.array([1.0, 1.5, 1.0])) == ""
    assert power(SPEEDS, np.array([1.0, 0.5, 0.0])) == ""
