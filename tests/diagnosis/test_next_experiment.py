"""What to measure next, by what a diagnosis found."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from tests.diagnosis.sizes import CANDIDATES
from tsas_cli.diagnosis import next_experiment as n
from tsas_cli.diagnosis.diagnose import Diagnosis
from tsas_cli.diagnosis.proof import FoundCause
from tsas_cli.diagnosis.remainder import Remainder
from tsas_cli.effects import EFFECTS
from tsas_cli.identification.model import Model

PLAY, MASS = "backlash", "load_inertia"


def cause(effect, rivals=(), gain=50.0):
    return FoundCause(effect, rivals, (), gain, (gain - 1.0, gain + 1.0))


def diagnosis(verdict, *causes, depends_on=(), **more):
    left = Remainder(1.0, {}, depends_on)
    return Diagnosis(verdict, "", Model(()), Model(()), causes, remainder=left, **more)


EXPERIMENT = {e.name: e.experiment for e in EFFECTS}


def test_the_next_experiment_follows_from_the_verdict():
    undecided = Diagnosis("undecided", "", Model(()), Model(()))
    assert n.next_experiment(undecided).startswith("Record longer runs, at least three")
    stuck = replace(undecided, converged=False)
    assert n.next_experiment(stuck).startswith("Check units, signs and which end is which")
    told = diagnosis("named", cause(PLAY, gain=20.0), cause(MASS, gain=30.0))
    assert n.next_experiment(told) == EXPERIMENT[MASS]  # what gains most
    assert n.next_experiment(diagnosis("unexplained")) == n.REPEAT
    assert n.next_experiment(diagnosis("sufficient")).startswith("No effect is missing")


@pytest.mark.parametrize("verdict", ["partly", "unexplained"])
def test_what_is_left_asks_for_the_run_that_shows_the_signal_it_depends_on(verdict):
    causes = [cause(MASS)] if verdict == "partly" else []
    left = diagnosis(verdict, *causes, depends_on=("time_s", "speed_mm_per_s", "x_in_mm"))
    assert n.next_experiment(left).startswith("Repeat one run at half the speed")
    assert n.next_experiment(diagnosis(verdict, *causes, depends_on=("time_s",))) == n.REPEAT


@pytest.mark.parametrize(("preload_N", "first"), [(25.0, "at another preload"), (None, "at half")])
def test_another_preload_is_asked_for_where_there_is_one(preload_N, first):
    run = SimpleNamespace(run=SimpleNamespace(run=SimpleNamespace(preload_N=preload_N)))
    judged = SimpleNamespace(bench=SimpleNamespace(closed=(run,)))
    left = diagnosis("unexplained", depends_on=("f_in_N", "speed_mm_per_s"), judged=judged)
    assert n.next_experiment(left).startswith(f"Repeat one run {first}")


@pytest.mark.parametrize("run", [None, CANDIDATES[1]])
def test_rivals_are_named_with_the_experiment_that_distinguishes_them(monkeypatch, run):
    asked = []
    monkeypatch.setattr(n, "propose", lambda bench, final, among, step: asked.append(among) or run)
    judged = SimpleNamespace(bench=SimpleNamespace(channels=("f_in_N", "x_out_mm")))
    rivals = cause(PLAY, ("presliding", "drive_friction"))
    result = diagnosis("ambiguous", cause(MASS), rivals, judged=judged, final=object())
    said = n.next_experiment(result)
    assert asked == [[PLAY, "presliding", "drive_friction"]]
    start = (
        "To distinguish backlash of the drive from elastic travel before sliding or friction at "
        "the drive: "
    )
    assert said.startswith(start)
    rest = EXPERIMENT[PLAY] if run is None else f"Record {run.sentence}."
    assert said.removeprefix(start)[1:] == rest[1:]
    assert said[len(start)].islower()


def test_where_one_channel_alone_is_compared_the_others_are_asked_for():
    run = SimpleNamespace(measured={"f_in_N": None}, conditioned={"x_in_mm": None})
    bench = SimpleNamespace(channels=("f_in_N",), closed=(SimpleNamespace(run=run),))
    rivals = cause("position_dependent_friction", ("load_dependent_friction",))
    judged = SimpleNamespace(bench=bench)
    said = n.next_experiment(diagnosis("ambiguous", rivals, judged=judged, final=object()))
    assert said.endswith(": record the same motion with f_out_N and x_out_mm too.")
