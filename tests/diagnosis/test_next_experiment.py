"""What to measure next, by what a diagnosis found."""

from tsas_cli.diagnosis import next_experiment as n
from tsas_cli.diagnosis.diagnose import Diagnosis
from tsas_cli.diagnosis.proof import FoundCause
from tsas_cli.diagnosis.remainder import Remainder
from tsas_cli.effects import EFFECTS
from tsas_cli.identification.model import Model

PLAY, MASS = "backlash", "load_inertia"


def cause(effect, rivals=(), gain=50.0):
    return FoundCause(effect, rivals, (), gain, (gain - 1.0, gain + 1.0))


def diagnosis(verdict, *causes):
    return Diagnosis(verdict, "", Model(()), Model(()), causes, {}, Remainder(1.0, {}, ()))


EXPERIMENT = {e.name: e.experiment for e in EFFECTS}


def test_the_next_experiment_follows_from_the_verdict():
    undecided = Diagnosis("undecided", "", Model(()), Model(()))
    assert n.next_experiment(undecided).startswith("Record longer runs, at least three")
    told = diagnosis("named", cause(PLAY, gain=20.0), cause(MASS, gain=30.0))
    assert n.next_experiment(told) == EXPERIMENT[MASS]  # what gains most
    assert n.next_experiment(diagnosis("unexplained")).startswith("Repeat one run")
    assert n.next_experiment(diagnosis("sufficient")).startswith("No effect is missing")
