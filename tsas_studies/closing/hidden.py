"""What is hidden in a plant, to see whether diagnosis makes tracking better."""

from dataclasses import dataclass


@dataclass(frozen=True)
class HiddenCase:
    """A hidden difference of the plant: its name for the table, and the quantities it changes.

    The drive's case changes none: its plant is as ever, and what is known of it is less.
    """

    name: str
    title: str
    hidden: dict[str, float]


CASES = (
    HiddenCase(
        "free_tendon",
        "tendon outside the sheath",
        {"free_tendon.proximal_length_mm": 150.0, "free_tendon.distal_length_mm": 60.0},
    ),
    HiddenCase("friction_drift", "wear during the run", {"friction_drift.rate_per_s": 0.01}),
    HiddenCase("load_friction", "a guide that rubs", {"load_friction.after_sensor_N": 1.0}),
    HiddenCase("backlash", "backlash", {"backlash.play_mm": 0.15}),
    HiddenCase("bend", "a bend that changed after calibration", {"total_bend_rad": 4.0}),
    HiddenCase("drive", "a gear that winds up", {}),
)
