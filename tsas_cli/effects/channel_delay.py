"""A channel is recorded later, or earlier, than x_in.

What one sees: the channel is wrong in proportion to how fast it changes: most where f_in is steep,
in dead bands and at their ends, with opposite sign on pull and release. Twice the speed gives
twice the error; at rest there is none.
Equation: a channel shows at time t its value of t − delay, on the clock of x_in; a delay of x_in
itself is the opposite of one in all other channels. Not in the paper.
Mistaken for: sensor_lag (indistinguishable in slow sines; it rounds corners too); backlash,
presliding (the same travel at every speed); viscous_friction (proportional to speed, and hardly
visible in dead bands); load_inertia (proportional to the acceleration of x_out).
Not validated: delays that change during a run.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter


class ChannelDelay(NamedTuple):
    """Delay of each channel after x_in [s]."""

    f_in_delay_s: float = 0.0
    f_out_delay_s: float = 0.0
    x_out_delay_s: float = 0.0


CHANNEL_DELAY = Effect(
    name="channel_delay",
    title="Delay of a channel",
    acts_on="sensor",
    closed_form=True,
    equation="channel(t) = signal(t − delay)",
    doc=__doc__,
    parameters=(
        Parameter("f_in_delay_s", "s", neutral=0.0, start=0.01, lower=-1.0, upper=1.0),
        Parameter("f_out_delay_s", "s", neutral=0.0, start=0.01, lower=-1.0, upper=1.0),
        Parameter("x_out_delay_s", "s", neutral=0.0, start=0.01, lower=-1.0, upper=1.0),
    ),
    experiment="The same stroke at two speeds: the delay of a channel doubles in mm of x_in and is "
    "the same in seconds.",
)
