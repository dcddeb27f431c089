"""A quick closed loop of two seconds, and settings with some keys replaced."""

from functools import cache

from tsas_cli.stages.track import what_is_known
from tsas_cli.tracking.references import reference
from tsas_cli.tracking.settings import Settings
from tsas_cli.tracking.track import Plant, plan, run_loop

QUICK = {
    "reference": {"angular_frequency_rad_per_s": 3.0, "duration_s": 2.0, "mean_N": 44.0},
    "sensor": {"rate_Hz": 500.0},
    "loop": {"nodes": 8},
}


def settings_of(**tables):
    """Return the quick settings with keys of some tables replaced."""
    names = {*QUICK, *tables}
    return Settings.model_validate({n: QUICK.get(n, {}) | tables.get(n, {}) for n in names})


@cache
def loop_of(settings):
    """Return wanted force, path, what is known and the plant of settings."""
    known, plant = what_is_known(settings)
    wanted = reference("sine", settings.reference, settings.step_s)
    return wanted, plan(wanted, known, settings), known, plant


def run(controller="disturbance-observer", *, seed=1, rig=None, later=None, change_s=0.0, **tables):
    """Run the quick loop, on another rig than the controller knows where one is given."""
    settings = settings_of(**tables)
    wanted, path, known, plant = loop_of(settings)
    plant = Plant(rig or plant.rig, plant.actuator, later, change_s)
    return run_loop(wanted, path, known, plant, controller, settings, seed=seed)
