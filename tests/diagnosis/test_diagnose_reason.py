"""The sentence that gives the reason of a verdict."""

from types import SimpleNamespace

import pytest

from tsas_cli.diagnosis import diagnose as d
from tsas_cli.diagnosis.diagnose import Diagnosis, FoundCause
from tsas_cli.diagnosis.remainder import Remainder
from tsas_cli.effects import EFFECTS
from tsas_cli.identification.model import Model

TITLE = {e.name: e.title.lower() for e in EFFECTS}
PLAY, MASS = "backlash", "load_inertia"


def cause(effect, rivals=(), gain=50.0):
    return FoundCause(effect, rivals, (), gain, (gain - 1.0, gain + 1.0))


def left_of(mean_square, *signals):
    return Remainder(mean_square, {}, signals)


def diagnosis(verdict, *causes, mean_square=1.0, share=0.0, signals=()):
    left = left_of(mean_square, *signals)
    return Diagnosis(verdict, "", Model(()), Model(()), causes, {}, left, share)


@pytest.mark.parametrize(
    ("found", "unexplained"),
    [
        (Diagnosis("undecided", "", Model(()), Model(())), False),
        (diagnosis("unexplained"), True),
        (diagnosis("sufficient", mean_square=9.0, share=1.0), False),
        (diagnosis("named", cause(PLAY), mean_square=4.1), True),
        (diagnosis("named", cause(PLAY), mean_square=2.0, share=0.03), True),
        (diagnosis("named", cause(PLAY), mean_square=2.0, share=0.01), False),
    ],
)
def test_what_is_unexplained(found, unexplained):
    assert found.unexplained == unexplained


def reason(found, start=16.0):
    return d._reason(found, left_of(start), found.remainder)


def test_a_model_that_lacks_nothing_is_at_the_noise_floor():
    said = "The nominal model is at the noise level: these runs show no missing effect."
    assert reason(diagnosis("sufficient", signals=("time_s",))) == said


def test_what_no_effect_explains_is_said_with_what_it_depends_on():
    found = diagnosis("unexplained", mean_square=16.0, signals=("time_s", "x_in_mm"))
    assert reason(found) == (
        "The residual RMS is 4.0 × the noise level, and no catalogued effect explains it. "
        "It depends on the time in the run, the displacement of the drive."
    )
    assert reason(diagnosis("unexplained", mean_square=16.0)).endswith("effect explains it.")


def test_causes_are_named_with_what_they_take_away():
    """From a mean square of 16 to one of 1.44: from 4 times the noise to 1.2 times."""
    said = reason(diagnosis("named", cause(PLAY), cause(MASS), mean_square=1.44))
    assert said == (
        f"The nominal model lacks: {TITLE[PLAY]} and {TITLE[MASS]}. "
        "With it the residual RMS falls from 4.0 to 1.2 × the noise level."
    )


def test_rivals_are_told_once_each_in_order():
    found = diagnosis("ambiguous", cause(PLAY, (MASS, "free_tendon")), cause("presliding", (MASS,)))
    told = ", ".join(sorted((TITLE[MASS], TITLE["free_tendon"])))
    assert reason(found).endswith(f" Indistinguishable from it in these recordings: {told}.")


def test_a_rest_is_said_by_how_much_of_it_there_is():
    most = diagnosis("unexplained", cause(PLAY), mean_square=9.0, share=0.6, signals=("time_s",))
    assert reason(most).endswith(
        " No catalogued effect explains most of the remaining residual. It depends on the time in "
        "the run."
    )
    some = diagnosis("named", cause(PLAY), mean_square=2.0, share=0.1, signals=("time_s",))
    assert reason(some).endswith(
        " No catalogued effect explains the remaining residual. It depends on the time in the run."
    )


def test_why_nothing_can_be_diagnosed():
    good = SimpleNamespace(converged=True, message="")
    bad = SimpleNamespace(converged=False, message="steps")

    def reason(runs, fitted):
        problem = SimpleNamespace(runs=runs)
        return d._not_possible(SimpleNamespace(problem=problem, fitted=fitted))

    assert reason([1], good) is None
    assert reason([], good).startswith("no run lasts")
    assert reason([1], None).startswith("no parameter")
    assert reason([1], bad).endswith("did not converge (steps).")


def found(rivals=(), unexplained=False):
    return SimpleNamespace(causes=[SimpleNamespace(rivals=rivals)], unexplained=unexplained)
