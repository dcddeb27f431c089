"""What to measure next, by what a diagnosis found."""

from types import SimpleNamespace

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


def test_rivals_ask_for_the_run_that_tells_them_apart(monkeypatch):
    asked = []

    def propose(bench, trial, effects, step):
        asked.append((bench, trial, list(effects)))
        return "Record more."

    monkeypatch.setattr(n, "propose", propose)
    unsure = [cause(PLAY), cause(MASS, ("presliding",)), cause("free_tendon", (PLAY,))]
    fields = vars(diagnosis("ambiguous", *unsure))
    search = SimpleNamespace(bench="bench")
    found = Diagnosis(**fields | {"judged": search, "final": "final"})
    assert n.next_experiment(found) == f"Record more. {EXPERIMENT[MASS]}"
    assert asked == [("bench", "final", [MASS, "presliding"])]
    # Where the fit is not there, what gains most is looked at again.
    assert n.next_experiment(Diagnosis(**fields | {"judged": search})) == EXPERIMENT[PLAY]
    assert n.next_experiment(Diagnosis(**fields | {"final": "final"})) == EXPERIMENT[PLAY]
