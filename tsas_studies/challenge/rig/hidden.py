"""From a hidden cause's name and parameters to the options of the rig and its sensors."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any, TypeVar

from tsas_studies.challenge.rig.near import NEAR
from tsas_studies.challenge.rig.sensors import Sensors
from tsas_studies.challenge.rig.tendon import Rig
from tsas_studies.challenge.rig.unknowns import UNKNOWNS, Place, places

Parameters = Mapping[str, Any]
Record = TypeVar("Record", Rig, Sensors)

HARMONIC = ("second_sine", "second_cosine")
RIPPLE = {f"{name}_mm": f"ripple_{name}_mm" for name in ("sine", "cosine", "period")}
RIPPLE |= {name: f"ripple_{name}" for name in HARMONIC}
WAVE = {"sine_mm": "wave", "cosine_mm": "wave_cosine", "period_mm": "wave_period"}
WAVE |= {name: f"wave_{name}" for name in HARMONIC}

# Every effect of the catalogue, with its parameters' names and units there. A place that begins
# with a channel is an option of that sensor, any other one of the rig.
CATALOGUE: Mapping[str, Mapping[str, Place]] = {
    "backlash": places("drive_end", "play_mm"),
    "drive_friction": places("drive_end", "friction_N"),
    "drive_ripple": places("drive_end", **RIPPLE),
    "drive_compliance": places("drive_end", "compliance_mm_per_N"),
    "proximal_spring": places("drive_end", stiffness_N_per_mm="spring_N_per_mm"),
    "free_tendon": {
        "proximal_length_mm": ("proximal_length_mm",),
        "distal_length_mm": ("distal_length_mm",),
    },
    "sheath_compression": {"compliance_ratio": ("sheath_compliance_ratio",)},
    "antagonist": places("antagonist", "preload_N", "friction_ratio", "f_in_share"),
    "direction_dependent_friction": places("friction", "asymmetry"),
    "stribeck_friction": places(
        "friction",
        excess="stribeck_excess",
        velocity_mm_per_s="stribeck_velocity_mm_per_s",
        exponent="stribeck_power",
        lag_s="stribeck_memory_s",
    ),
    "viscous_friction": places("friction", coefficient_N_s_per_mm="viscous_N_s_per_mm"),
    "sheath_drag": places("friction", force_N="drag_N"),
    "load_dependent_friction": places("friction", exponent="load_exponent"),
    "presliding": places("friction", length_mm="presliding_mm", growth="presliding_growth"),
    "bend_drift": places(
        "friction", rate_rad_per_s="bend_rate_rad_per_s", settling_per_s="bend_settling_per_s"
    ),
    "friction_drift": places("friction", "rate_per_s", "settling_per_s", "session_rate_per_s"),
    "preload_loss": places(
        "load_end", rate_N_per_s="anchor_rate_N_per_s", settling_per_s="anchor_settling_per_s"
    ),
    "load_spring_nonlinearity": places("load_end", "quadratic_per_mm", "cubic_per_mm2"),
    "load_friction": places(
        "load_end", after_sensor_N="friction_after_N", before_sensor_N="friction_before_N"
    ),
    "load_inertia": places("load_end", "mass_kg"),
    "force_sensor_gain": places("f_out_N", f_out_gain="gain"),
    "force_sensor_offset": {
        "f_in_offset_N": ("f_in_N", "offset"),
        "f_out_offset_N": ("f_out_N", "offset"),
    },
    "force_sensor_drift": {
        "f_in_rate_N_per_s": ("f_in_N", "rate_per_s"),
        "f_out_rate_N_per_s": ("f_out_N", "rate_per_s"),
        "settling_per_s": ("forces", "settling_per_s"),
        "f_in_session_rate_N_per_s": ("f_in_N", "session_rate_per_s"),
        "f_out_session_rate_N_per_s": ("f_out_N", "session_rate_per_s"),
    },
    "position_sensor_gain": places("x_out_mm", x_out_gain="gain"),
    "channel_delay": {
        "f_in_delay_s": ("f_in_N", "delay_s"),
        "f_out_delay_s": ("f_out_N", "delay_s"),
        "x_out_delay_s": ("x_out_mm", "delay_s"),
    },
    "position_dependent_friction": places("friction", "slope_per_mm"),
    "uneven_friction": places("friction", slope="slope_along"),
    "pulley_friction": {
        "drive_loss": ("drive_end", "pulley_share"),
        "load_loss": ("load_pulley_loss",),
    },
    "load_damping": places("restraint", coefficient_N_s_per_mm="damping_N_s_per_mm"),
    "load_hysteresis": places("restraint", force_N="hysteresis_N", travel_mm="hysteresis_mm"),
    "load_relaxation": places("restraint", share="relaxing_share", time_s="relaxing_s"),
    "load_ripple": places("restraint", **RIPPLE),
    "drive_inertia": places("drive_end", "mass_kg"),
    "drive_damping": places("drive_end", coefficient_N_s_per_mm="damping_N_s_per_mm"),
    "force_sensor_gain_drift": {
        "f_in_rate_per_s": ("f_in_N", "gain_rate_per_s"),
        "f_out_rate_per_s": ("f_out_N", "gain_rate_per_s"),
    },
    "force_sensor_curvature": {
        "f_in_per_N": ("f_in_N", "curvature"),
        "f_out_per_N": ("f_out_N", "curvature"),
    },
    "force_sensor_hysteresis": {
        "f_in_share": ("f_in_transducer", "hysteresis_share"),
        "f_out_share": ("f_out_transducer", "hysteresis_share"),
        "span_N": ("transducers", "hysteresis_span"),
    },
    "force_sensor_tilt": {
        "f_in_per_mm": ("f_in_tilt_per_mm",),
        "f_out_per_mm": ("f_out_tilt_per_mm",),
    },
    "force_crosstalk": {
        "f_in_of_f_out": ("f_in_of_f_out",),
        "f_out_of_f_in": ("f_out_of_f_in",),
    },
    "position_sensor_ripple": places("x_out_mm", **WAVE),
    "sensor_lag": {
        "f_in_lag_s": ("f_in_transducer", "lag_s"),
        "f_out_lag_s": ("f_out_transducer", "lag_s"),
        "x_out_lag_s": ("x_out_transducer", "lag_s"),
    },
}
SEVERAL = {
    "forces": ("f_in_N", "f_out_N"),
    "transducers": ("f_in_transducer", "f_out_transducer"),
}


def hide(name: str, parameters: Parameters, rig: Rig, sensors: Sensors) -> tuple[Rig, Sensors]:
    """Return the rig and its sensors with one cause hidden in them.

    The cause is an effect of the catalogue, or one of `NEAR` or `UNKNOWNS`; parameters that are
    left out stay as they are.

    KeyError: the cause or a parameter does not exist.
    """
    known = {**CATALOGUE, **NEAR, **UNKNOWNS}[name]
    for parameter, value in parameters.items():
        *groups, option = known[parameter]
        if groups:
            for group in SEVERAL.get(groups[0], groups):
                if hasattr(sensors, group):
                    sensors = _set(sensors, group, option, value)
                else:
                    rig = _set(rig, group, option, value)
        elif hasattr(sensors, option):
            sensors = replace(sensors, **{option: value})
        else:
            rig = replace(rig, **{option: value})
    return rig, sensors


def _set(record: Record, group: str, option: str, value: Any) -> Record:
    known: Any = getattr(record, group)
    change = known._replace if hasattr(known, "_replace") else partial(replace, known)
    changed: Any = change(**{option: value})
    return replace(record, **{group: changed})
