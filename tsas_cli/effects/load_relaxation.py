"""The load spring relaxes: it is stiffer in fast motion than in slow, and creeps back at rest.

What one sees: after a stroke, while the drive rests, f_out falls towards the line of slow motion,
and f_in with it; after a release both rise. In motion f_out over x_out is a loop that is widest
where the stroke takes about the relaxation time, and closes in much slower and much faster motion.
Equation: the standard linear solid (Zener): beside the spring of Yang 2025, Eq. (9), a spring of
share·kL in series with a damper; its stretch w follows dw/dt = v_out − w/time. kL is the stiffness
of slow motion. Silicone, rubber bands, soft tissue. The paper's load has none.
Mistaken for: load_damping (its loop grows with the speed without limit); load_hysteresis,
load_friction (the same loop at any speed); preload_loss (never comes back); creep of the tendon,
where f_out over x_out stays on its line.
Not validated: materials with more than one time constant; a slack tendon, in which the spring is
taken to be relaxed; the state before a run, which is taken to be relaxed.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter, shape
from tsas_cli.numerics.compiled import kernel


class LoadRelaxation(NamedTuple):
    """Stiffness that relaxes over that of the load spring [1], and its time constant [s]."""

    share: float = 0.0
    time_s: float = 1.0


@kernel
def relaxing_force(stretch: float, stiffness: float, share: float) -> float:
    """Return the force [N] of the relaxing spring at a stretch [mm], by the load's stiffness."""
    return share * stiffness * stretch


LOAD_RELAXATION = Effect(
    name="load_relaxation",
    title="Relaxation of the load",
    acts_on="load",
    closed_form=False,
    equation="f_out = spring force + share·kL·w,  dw/dt = v_out − w/time",
    doc=__doc__,
    parameters=(
        Parameter("share", "1", neutral=0.0, start=0.1, lower=0.0, upper=10.0),
        shape("time_s", "s", 1.0, lower=0.001, upper=1000.0, starts=(0.1, 1.0, 10.0)),
    ),
    experiment="Pull the load by a step and hold it there: f_out falls exponentially by the share "
    "of the step.",
)
