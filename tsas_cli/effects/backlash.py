"""After every reversal the drive rotates a little before the tendon follows.

What one sees: after a reversal of x_in, f_in, f_out and x_out are all constant over the same travel
of x_in, whatever the tension and the speed; only then does the usual dead band begin. f_in over
x_in has a flat piece of this width at every corner.
Equation: the play operator: the tendon's end p is constant until x_in has crossed the play. The
usual description of play in gears; not in the paper.
Mistaken for: drive_compliance, free_tendon (they soften the dead band, the more the larger the
change of tension, without a flat piece); presliding (f_in rises from the first micrometre);
channel_delay (the flat piece grows with speed).
Not validated: gears whose flanks the tendon's tension keeps in contact; their play does not open at
a reversal, but only where the torque changes its sign.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel


class Backlash(NamedTuple):
    """Travel of the drive between its two flanks [mm]."""

    play_mm: float = 0.0


@kernel
def follow_play(position: float, drive: float, play: float) -> float:
    """Return the position of the tendon's end [mm], from its last one and that of the drive."""
    return min(max(position, drive - 0.5 * play), drive + 0.5 * play)


BACKLASH = Effect(
    name="backlash",
    title="Backlash of the drive",
    acts_on="drive",
    closed_form=True,
    equation="p = min(max(p, x_in − play/2), x_in + play/2)",
    doc=__doc__,
    parameters=(
        Parameter(
            "play_mm", "mm", neutral=0.0, start=0.1, lower=0.0, upper=20.0, starts=(0.01, 0.1)
        ),
    ),
    experiment="Slow nested strokes at two preloads: the travel over which f_in is constant after "
    "a reversal is the same at both.",
)
