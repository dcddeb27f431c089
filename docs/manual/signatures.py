"""How each effect is shown: its size, the motion that brings it out, the two loops to look at."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from tsas_cli.diagnosis.motions import Kind

Channel = Literal["time_s", "x_in_mm", "x_out_mm", "f_in_N", "f_out_N"]
Plane = tuple[Channel, Channel]  # what lies below, what stands up

F_IN_OVER_X_IN: Plane = ("x_in_mm", "f_in_N")
F_OUT_OVER_X_IN: Plane = ("x_in_mm", "f_out_N")
X_OUT_OVER_X_IN: Plane = ("x_in_mm", "x_out_mm")
F_IN_OVER_F_OUT: Plane = ("f_out_N", "f_in_N")
F_OUT_OVER_X_OUT: Plane = ("x_out_mm", "f_out_N")


@dataclass(frozen=True)
class Motion:
    """A motion of the drive, as in `tsas_cli.diagnosis.motions`."""

    kind: Kind = "sine"
    amplitude_mm: float = 10.0
    speed_mm_per_s: float = 10.0
    periods: int = 2


@dataclass(frozen=True)
class Variant:
    """One way in which an effect acts: its values, and the channel whose change is drawn."""

    values: Mapping[str, float]
    channel: Channel = "f_in_N"
    name: str = ""


@dataclass(frozen=True)
class Signature:
    """What is drawn of an effect, and the sentence that says where to look."""

    look: str
    variants: tuple[Variant, ...]
    motion: Motion = Motion()
    planes: tuple[Plane, Plane] = (F_IN_OVER_X_IN, F_IN_OVER_F_OUT)
    over: Channel = "x_in_mm"


def _one(channel: Channel = "f_in_N", **values: float) -> tuple[Variant, ...]:
    return (Variant(values, channel),)


PAPERS = Motion()  # x_in = 10 (1 − cos t) mm, two periods
STEADY = Motion(kind="ramps")  # at constant speed
LONG = Motion(periods=4)
NESTED = Motion(kind="nested", periods=1)

SIGNATURES: Mapping[str, Signature] = MappingProxyType(
    {
        "backlash": Signature(
            "A flat piece of the same width after every reversal, at low tension as at high: all "
            "channels stand still in it.",
            _one(play_mm=1.0),
            NESTED,
            (F_IN_OVER_X_IN, X_OUT_OVER_X_IN),
        ),
        "drive_friction": Signature(
            "The loop of f_in is wider by the same force everywhere: a constant on the pull, its "
            "negative on the release, a jump at the reversal.",
            _one(friction_N=4.0),
        ),
        "drive_damping": Signature(
            "The loop of f_in is wider where the drive is fast, in dead bands too, and fits at the "
            "reversals; f_out is unaffected.",
            _one(coefficient_N_s_per_mm=0.5),
            planes=(F_IN_OVER_X_IN, F_OUT_OVER_X_IN),
        ),
        "drive_inertia": Signature(
            "In fast sines f_in is too high at the near end of the stroke and too low at the far "
            "one, by the same force on pull and release; f_out is unaffected.",
            _one(mass_kg=10.0),
            Motion(speed_mm_per_s=60.0),
            (F_IN_OVER_X_IN, F_OUT_OVER_X_IN),
        ),
        "drive_ripple": Signature(
            "A wave with a fixed period in x_in, much higher where the tendon sticks.",
            _one(sine_mm=0.15, period_mm=1.0),
            Motion(amplitude_mm=3.0, speed_mm_per_s=3.0),
            (F_IN_OVER_X_IN, F_OUT_OVER_X_IN),
        ),
        "drive_compliance": Signature(
            "The corners lean: the dead band at high tension, where more force turns round, leans "
            "over more travel than the one at low tension.",
            _one(compliance_mm_per_N=0.03),
            planes=(F_IN_OVER_X_IN, X_OUT_OVER_X_IN),
        ),
        "proximal_spring": Signature(
            "The loop of f_in is sheared: what is added is one straight line over x_in, the same "
            "on pull and release. f_out knows nothing of it.",
            _one(stiffness_N_per_mm=1.0),
            planes=(F_IN_OVER_X_IN, F_OUT_OVER_X_IN),
        ),
        "free_tendon": Signature(
            "x_out lags by an amount that follows the tension. Tendon before the sheath leans the "
            "dead bands; tendon behind it hardly touches them.",
            (
                Variant({"proximal_length_mm": 2000.0}, "x_out_mm", "before the sheath"),
                Variant({"distal_length_mm": 2000.0}, "x_out_mm", "behind the sheath"),
            ),
            planes=(F_IN_OVER_X_IN, X_OUT_OVER_X_IN),
        ),
        "sheath_compression": Signature(
            "Wider and softer dead bands, and a curve that stays curved: slip has to run along "
            "the whole sheath.",
            _one(compliance_ratio=3.0),
            planes=(F_IN_OVER_X_IN, X_OUT_OVER_X_IN),
        ),
        "antagonist": Signature(
            "The torque of the drive has a wider loop over f_out, which ends in a kink where the "
            "second tendon goes slack; a load cell in the first tendon reads too much, until then.",
            (
                Variant({"preload_N": 30.0}, "f_in_N", "torque of the drive"),
                Variant({"preload_N": 30.0, "f_in_share": 0.0}, "f_in_N", "load cell"),
            ),
        ),
        "direction_dependent_friction": Signature(
            "In f_in over f_out both lines turn the same way about the origin: f_in too high on "
            "pull and release alike, in proportion to the tension.",
            _one(asymmetry=0.4),
        ),
        "stribeck_friction": Signature(
            "The loop is too wide near the reversals, where the drive is slow, and fits in the "
            "middle of the stroke.",
            _one(excess=0.5, velocity_mm_per_s=4.0),
        ),
        "viscous_friction": Signature(
            "The loop is too wide in the middle of the stroke, where the drive is fast, and fits "
            "at the reversals.",
            _one(coefficient_N_s_per_mm=0.5),
        ),
        "sheath_drag": Signature(
            "In f_in over f_out the line of the pull moves up and that of the release down, in "
            "parallel; after a reversal f_in takes a wider dead band to cross between them.",
            _one(force_N=4.0),
        ),
        "load_dependent_friction": Signature(
            "In f_in over f_out the lines of pull and release bend apart as the tension rises.",
            _one(exponent=0.5),
        ),
        "position_dependent_friction": Signature(
            "In f_in over f_out the lines of pull and release open along the stroke, the same in "
            "every stroke.",
            _one(slope_per_mm=0.02),
        ),
        "uneven_friction": Signature(
            "Dead bands have another shape, steeper at first where there is more friction at the "
            "drive; full slip fits.",
            _one(slope=-1.6),
            Motion(kind="nested", amplitude_mm=6.0, speed_mm_per_s=6.0, periods=1),
        ),
        "pulley_friction": Signature(
            "The loop of f_in is wider by a share of the tension. From a pulley at the drive f_in "
            "steps at once at a reversal; one at the load keeps f_out for longer.",
            (
                Variant({"drive_loss": 0.1}, "f_in_N", "at the drive"),
                Variant({"load_loss": 0.1}, "f_in_N", "at the load"),
            ),
        ),
        "presliding": Signature(
            "Rounded corners: f_in leaves a reversal with a finite slope, over the same travel at "
            "every tension where growth is 0. Short strokes become thin loops.",
            _one(length_mm=0.4),
            Motion(kind="nested", amplitude_mm=2.0, speed_mm_per_s=2.0, periods=1),
        ),
        "bend_drift": Signature(
            "Each loop of f_in over f_out is wider than the last: up on pulls and down on "
            "releases, in proportion to the tension.",
            _one(rate_rad_per_s=0.045),
            LONG,
            over="time_s",
        ),
        "friction_drift": Signature(
            "Each loop of f_in over f_out is wider than the last: up on pulls and down on "
            "releases, as with a bend that drifts.",
            _one(rate_per_s=0.015),
            LONG,
            over="time_s",
        ),
        "preload_loss": Signature(
            "All tensions sink as the run goes on, on pull and release alike; the line of f_out "
            "over x_out moves down in parallel.",
            _one("f_out_N", rate_N_per_s=0.3),
            LONG,
            (F_IN_OVER_X_IN, F_OUT_OVER_X_OUT),
            over="time_s",
        ),
        "load_spring_nonlinearity": Signature(
            "f_out over x_out is one curve, the same on pull and release.",
            (
                Variant({"quadratic_per_mm": 0.02}, "f_out_N", "quadratic"),
                Variant({"cubic_per_mm2": 0.001}, "f_out_N", "cubic"),
            ),
            planes=(F_IN_OVER_X_IN, F_OUT_OVER_X_OUT),
        ),
        "load_ripple": Signature(
            "A wave on f_out over x_out, the same on pull and release, with a fixed period in "
            "x_out; none in dead bands.",
            _one("f_out_N", sine_mm=1.0, period_mm=8.0),
            planes=(F_IN_OVER_X_IN, F_OUT_OVER_X_OUT),
        ),
        "load_friction": Signature(
            "Behind the sensor, f_out over x_out becomes a loop of constant height; before it, "
            "that stays a line and only f_in feels it, more on a pull than on a release.",
            (
                Variant({"after_sensor_N": 3.0}, "f_in_N", "behind the sensor"),
                Variant({"before_sensor_N": 2.0}, "f_in_N", "before the sensor"),
            ),
            planes=(F_IN_OVER_X_IN, F_OUT_OVER_X_OUT),
        ),
        "load_inertia": Signature(
            "f_out over x_out leaves the spring's line with the acceleration: above it at the "
            "bottom of the stroke, below it at the top, and peaks where the load sets off.",
            _one("f_out_N", mass_kg=10.0),
            Motion(speed_mm_per_s=60.0),
            (F_IN_OVER_X_IN, F_OUT_OVER_X_OUT),
        ),
        "load_damping": Signature(
            "f_out over x_out becomes a loop that is wide where the load is fast and closes at the "
            "reversals.",
            _one("f_out_N", coefficient_N_s_per_mm=0.3),
            planes=(F_IN_OVER_X_IN, F_OUT_OVER_X_OUT),
        ),
        "load_hysteresis": Signature(
            "f_out over x_out becomes a loop of constant height, whose flanks take a travel "
            "of the load.",
            _one("f_out_N", force_N=3.0, travel_mm=2.0),
            planes=(F_IN_OVER_X_IN, F_OUT_OVER_X_OUT),
        ),
        "load_relaxation": Signature(
            "f_out over x_out becomes a loop on a steeper line: in each stroke f_out runs ahead "
            "and then falls back towards the line of slow motion.",
            _one("f_out_N", share=0.3, time_s=0.5),
            planes=(F_IN_OVER_X_IN, F_OUT_OVER_X_OUT),
        ),
        "force_sensor_gain": Signature(
            "In f_in over f_out both lines are stretched sideways by one factor; f_in over x_in "
            "fits.",
            _one("f_out_N", f_out_gain=1.2),
            planes=(F_OUT_OVER_X_IN, F_IN_OVER_F_OUT),
        ),
        "force_sensor_offset": Signature(
            "One channel is moved as a whole: by the same amount at every tension, on pull and "
            "release.",
            (
                Variant({"f_in_offset_N": 6.0}, "f_in_N", "of f_in"),
                Variant({"f_out_offset_N": 4.0}, "f_out_N", "of f_out"),
            ),
        ),
        "force_sensor_drift": Signature(
            "One channel leaves the others as the run goes on, by the same amount on pull and "
            "release.",
            (
                Variant({"f_in_rate_N_per_s": 0.45}, "f_in_N", "of f_in"),
                Variant({"f_out_rate_N_per_s": 0.3}, "f_out_N", "of f_out"),
            ),
            LONG,
            over="time_s",
        ),
        "force_sensor_gain_drift": Signature(
            "One channel leaves the others as the run goes on, on pull and release alike and more "
            "where the tension is high.",
            (
                Variant({"f_in_rate_per_s": 0.01}, "f_in_N", "of f_in"),
                Variant({"f_out_rate_per_s": 0.01}, "f_out_N", "of f_out"),
            ),
            LONG,
            over="time_s",
        ),
        "force_sensor_curvature": Signature(
            "The residual of one channel is a parabola over its tension, the same on pull and "
            "release; the other channels fit.",
            (
                Variant({"f_in_per_N": 2e-3}, "f_in_N", "of f_in"),
                Variant({"f_out_per_N": 2e-3}, "f_out_N", "of f_out"),
            ),
            planes=(F_OUT_OVER_X_OUT, F_IN_OVER_F_OUT),
        ),
        "force_sensor_hysteresis": Signature(
            "One channel is too low while its force grows and too high while it falls, by a "
            "constant that it takes a span of force to reach: f_out over x_out becomes a loop.",
            (
                Variant({"f_in_share": 0.3, "span_N": 10.0}, "f_in_N", "of f_in"),
                Variant({"f_out_share": 0.2, "span_N": 10.0}, "f_out_N", "of f_out"),
            ),
            planes=(F_IN_OVER_X_IN, F_OUT_OVER_X_OUT),
        ),
        "force_sensor_tilt": Signature(
            "One channel is wrong by its tension times its position, on pull and release alike; "
            "the other channels fit.",
            (
                Variant({"f_in_per_mm": 0.01}, "f_in_N", "of f_in"),
                Variant({"f_out_per_mm": 0.01}, "f_out_N", "of f_out"),
            ),
            planes=(F_IN_OVER_X_IN, F_OUT_OVER_X_OUT),
        ),
        "force_crosstalk": Signature(
            "f_out moves in dead bands, where the load stands still; f_in is too high on pull and "
            "release alike, and fits in dead bands.",
            (
                Variant({"f_in_of_f_out": 0.2}, "f_in_N", "of f_out in f_in"),
                Variant({"f_out_of_f_in": 0.1}, "f_out_N", "of f_in in f_out"),
            ),
            planes=(F_OUT_OVER_X_OUT, F_IN_OVER_F_OUT),
        ),
        "position_sensor_gain": Signature(
            "x_out is wrong in proportion to its travel and f_out over x_out has a wrong slope; "
            "the tensions fit.",
            _one("x_out_mm", x_out_gain=1.2),
            planes=(X_OUT_OVER_X_IN, F_OUT_OVER_X_OUT),
        ),
        "position_sensor_ripple": Signature(
            "A wave on x_out alone with a fixed period in x_out, the same on pull and release; "
            "the tensions fit.",
            _one("x_out_mm", sine_mm=0.8, period_mm=6.0),
            planes=(X_OUT_OVER_X_IN, F_OUT_OVER_X_OUT),
        ),
        "channel_delay": Signature(
            "The channel is wrong where it changes fast, most of all in the dead bands, with "
            "opposite sign on pull and release.",
            (
                Variant({"f_in_delay_s": 0.15}, "f_in_N", "of f_in"),
                Variant({"f_out_delay_s": 0.15}, "f_out_N", "of f_out"),
            ),
            planes=(F_IN_OVER_X_IN, F_OUT_OVER_X_IN),
        ),
        "sensor_lag": Signature(
            "The channel is late as with a delay, and its corners are round: after a reversal it "
            "leaves the old line slowly.",
            (
                Variant({"f_in_lag_s": 0.15}, "f_in_N", "of f_in"),
                Variant({"f_out_lag_s": 0.15}, "f_out_N", "of f_out"),
            ),
            planes=(F_IN_OVER_X_IN, F_OUT_OVER_X_IN),
        ),
    }
)
