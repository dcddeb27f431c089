"""Sizes from which on effects are seen, made up as several tests need them."""

from tests.physics.references import GROUP_A
from tsas_cli.diagnosis.amplitudes import Amplitude, Visibility
from tsas_cli.diagnosis.candidates import candidates
from tsas_cli.diagnosis.plan import Better
from tsas_cli.diagnosis.rig_file import Limits
from tsas_cli.effects import EFFECTS

OF = {e.name: e for e in EFFECTS}
CANDIDATES = candidates(Limits(amplitude_mm=10.0, speed_mm_per_s=24.0), GROUP_A)
PLAY, MASS, LENGTH = "backlash", "load_inertia", "free_tendon"


def cause(name):
    parameter = next(q for q in OF[name].parameters if not q.shape)
    return Amplitude(OF[name], parameter, {})


def seen(name, found, **told):
    return Visibility(cause(name), found, told)


def better(name, before, after):
    return Better(cause(name), before, after)
