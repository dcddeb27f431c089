"""How long the closed loop takes: 30 s at 1 kHz with 50 nodes, and the path that it follows."""

from collections.abc import Iterator
from functools import partial

from benchmarks.row import Row
from benchmarks.timing import times
from tsas_cli.controllers import CONTROLLERS
from tsas_cli.tracking.recorded import stated_rig
from tsas_cli.tracking.references import reference
from tsas_cli.tracking.settings import ReferenceSettings, Settings
from tsas_cli.tracking.track import Known, Plant, plan, run_loop

DURATION_S = 30.0
REPEATS = 5


def measure() -> Iterator[Row]:
    """Time the paper's rig with its sine, once compiled."""
    settings = Settings(reference=ReferenceSettings(duration_s=DURATION_S))
    rig = stated_rig(settings)
    known, plant = Known(rig, settings.drive.kinematic()), Plant(rig, settings.drive.actuator())
    wanted = reference("sine", settings.reference, settings.step_s)
    path = plan(wanted, known, settings)
    took = times(lambda: plan(wanted, known, settings), REPEATS)
    yield Row.timed("inverse model, 30 s at 1 kHz", took, "s")
    for name in CONTROLLERS:
        followed = partial(run_loop, wanted, path, known, plant, name, settings, seed=1)
        took = times(followed, REPEATS)
        yield Row.timed(f"closed loop with {name}, 30 s", took, "s", at_most=1.0)
