"""What the figures of the summary are held against."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Target:
    """A share has to be between `low` and `high`; `each_effect` holds it for every effect alone."""

    low: float = 0.0
    high: float = 1.0
    each_effect: bool = False

    def text(self) -> str:
        """Return it in words."""
        low, high = f"{100 * self.low:g}", f"{100 * self.high:g}"
        if self.low == 0.0:
            bounds = f"≤ {high} %"
        elif self.high == 1.0:
            bounds = f"≥ {low} %" if self.low < 1.0 else "100 %"
        else:
            bounds = f"{low}–{high} %"
        return f"{bounds} for each effect" if self.each_effect else bounds


SIZES = (1.0, 0.4)  # the sizes of single effects that have a target
TARGETS = {
    "answered": Target(low=1.0),
    "one_exact": Target(low=0.97),
    "size_1_exact": Target(low=0.95, each_effect=True),
    "size_1_false": Target(high=0.02, each_effect=True),
    "size_0.4_exact": Target(low=0.85, each_effect=True),
    "pair_both": Target(low=0.93),
    "triple_all": Target(low=0.85),
    "nothing_named": Target(high=0.01),
    "nothing_unexplained": Target(high=0.05),
    "slow_nothing_named": Target(high=0.01),
    "slow_nothing_unexplained": Target(high=0.05),
    "beyond_wrong": Target(high=0.05),
    "beyond_unwarned": Target(high=0.01),
    "beyond_recognised": Target(low=0.95),
    "beyond_gain": Target(low=0.8),
    "beyond_place": Target(low=0.8),
    "fault_wrong": Target(high=0.05),
    "fault_unwarned": Target(high=0.02),
    "recording_right": Target(low=0.85),
    "recording_wrong": Target(high=0.03),
    "sound_accused": Target(high=0.01),
    "right_refused": Target(high=0.05),
    "coverage": Target(low=0.92, high=0.98),
    "realistic_one_exact": Target(low=0.9),
    "realistic_beyond_wrong": Target(high=0.05),
    "realistic_beyond_unwarned": Target(high=0.01),
    "realistic_beyond_recognised": Target(low=0.95),
    "realistic_right_refused": Target(high=0.05),
    "realistic_coverage": Target(low=0.88),
}
