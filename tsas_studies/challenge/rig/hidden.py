"""From a hidden cause's name and parameters to the options of the rig and its sensors."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any, TypeVar

from tsas_studies.challenge.rig.near import NEAR
from tsas_studies.challenge.rig.sensors import Sensors
from tsas_studies.challenge.rig.tendon import Rig
from tsas_studies.challenge.rig.unknowns import UNKNOWNS, Place

Parameters = Mapping[str, Any]
Record = TypeVar("Record", Rig, Sensors)

# Every effect of the catalogue, with its parameters' names and units there. A place that begins
# with a channel is an option of that sensor, any other one of the rig.
CATALOGUE: Mapping[str, Mapping[str, Place]] = {
    "backlash": {"play_mm": ("drive_end", "play_mm")},
    "drive_friction": {"friction_N": ("drive_end", "friction_N")},
    "drive_ripple": {
        "sine_mm": ("drive_end", "ripple_sine_mm"),
        "cosine_mm": ("drive_end", "ripple_cosine_mm"),
        "period_mm": ("drive_end", "ripple_period_mm"),
    },
    "drive_compliance": {"compliance_mm_per_N": ("drive_end", "compliance_mm_per_N")},
    "proximal_spring": {"stiffness_N_per_mm": ("drive_end", "spring_N_per_mm")},
    "free_tendon": {
        "proximal_length_mm": ("proximal_length_mm",),
        "distal_length_mm": ("distal_length_mm",),
    },
    "sheath_compression": {"compliance_ratio": ("sheath_compliance_ratio",)},
    "antagonist": {
        "preload_N": ("antagonist", "preload_N"),
        "friction_ratio": ("antagonist", "friction_ratio"),
        "f_in_share": ("antagonist", "f_in_share"),
    },
    "direction_dependent_friction": {"asymmetry": ("friction", "asymmetry")},
    "stribeck_friction": {
        "excess": ("friction", "stribeck_excess"),
        "velocity_mm_per_s": ("friction", "stribeck_velocity_mm_per_s"),
    },
    "viscous_friction": {"coefficient_N_s_per_mm": ("friction", "viscous_N_s_per_mm")},
    "load_dependent_friction": {"exponent": ("friction", "load_exponent")},
    "presliding": {"length_mm": ("friction", "presliding_mm")},
    "bend_drift": {
        "rate_rad_per_s": ("friction", "bend_rate_rad_per_s"),
        "settling_per_s": ("friction", "bend_settling_per_s"),
    },
    "friction_drift": {
        "rate_per_s": ("friction", "rate_per_s"),
        "settling_per_s": ("friction", "settling_per_s"),
        "session_rate_per_s": ("friction", "session_rate_per_s"),
    },
    "preload_loss": {
        "rate_N_per_s": ("load_end", "anchor_rate_N_per_s"),
        "settling_per_s": ("load_end", "anchor_settling_per_s"),
    },
    "load_spring_nonlinearity": {
        "quadratic_per_mm": ("load_end", "quadratic_per_mm"),
        "cubic_per_mm2": ("load_end", "cubic_per_mm2"),
    },
    "load_friction": {
        "after_sensor_N": ("load_end", "friction_after_N"),
        "before_sensor_N": ("load_end", "friction_before_N"),
    },
    "load_inertia": {"mass_kg": ("load_end", "mass_kg")},
    "force_sensor_gain": {"f_out_gain": ("f_out_N", "gain")},
    "force_sensor_offset": {
        "f_in_offset_N": ("f_in_N", "offset"),
        "f_out_offset_N": ("f_out_N", "offset"),
    },
    "force_sensor_drift": {
        "f_in_rate_N_per_s": ("f_in_N", "rate_per_s"),
        "f_out_rate_N_per_s": ("f_out_N", "rate_per_s"),
        "settling_per_s": ("forces", "settling_per_s"),
    },
    "position_sensor_gain": {"x_out_gain": ("x_out_mm", "gain")},
    "channel_delay": {
        "f_in_delay_s": ("f_in_N", "delay_s"),
        "f_out_delay_s": ("f_out_N", "delay_s"),
        "x_out_delay_s": ("x_out_mm", "delay_s"),
    },
    "position_dependent_friction": {"slope_per_mm": ("friction", "slope_per_mm")},
    "uneven_friction": {"slope": ("friction", "slope_along")},
    "load_damping": {"coefficient_N_s_per_mm": ("restraint", "damping_N_s_per_mm")},
    "load_hysteresis": {
        "force_N": ("restraint", "hysteresis_N"),
        "travel_mm": ("restraint", "hysteresis_mm"),
    },
    "load_relaxation": {
        "share": ("restraint", "relaxing_share"),
        "time_s": ("restraint", "relaxing_s"),
    },
    "load_ripple": {
        "sine_mm": ("restraint", "ripple_sine_mm"),
        "cosine_mm": ("restraint", "ripple_cosine_mm"),
        "period_mm": ("restraint", "ripple_period_mm"),
    },
    "drive_inertia": {"mass_kg": ("drive_end", "mass_kg")},
    "drive_damping": {"coefficient_N_s_per_mm": ("drive_end", "damping_N_s_per_mm")},
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
    "position_sensor_ripple": {
        "sine_mm": ("x_out_mm", "wave"),
        "cosine_mm": ("x_out_mm", "wave_cosine"),
        "period_mm": ("x_out_mm", "wave_period"),
    },
    "sensor_lag": {
        "f_in_lag_s": ("f_in_transducer", "lag_s"),
        "f_out_lag_s": ("f_out_transducer", "lag_s"),
        "x_out_lag_s": ("x_out_transducer", "lag_s"),
    },
}


def hide(name: str, parameters: Parameters, rig: Rig, sensors: Sensors) -> tuple[Rig, Sensors]:
    """Return the rig and its sensors with one cause hidden in them.

    The cause is an effect of the catalogue, or one of `NEAR` or `UNKNOWNS`; parameters that are
    left out stay as they are.

    KeyError: the cause or a parameter does not exist.
    """
    places = {**CATALOGUE, **NEAR, **UNKNOWNS}[name]
    for parameter, value in parameters.items():
        match places[parameter]:
            case ("forces", option):
                sensors = _set(_set(sensors, "f_in_N", option, value), "f_out_N", option, value)
            case ("transducers", option):
                for group in ("f_in_transducer", "f_out_transducer"):
                    sensors = _set(sensors, group, option, value)
            case (group, option) if hasattr(sensors, group):
                sensors = _set(sensors, group, option, value)
            case (option,) if hasattr(sensors, option):
                sensors = replace(sensors, **{option: value})
            case (group, option):
                rig = _set(rig, group, option, value)
            case (option,):
                rig = replace(rig, **{option: value})
    return rig, sensors


def _set(record: Record, group: str, option: str, value: Any) -> Record:
    known: Any = getattr(record, group)
    change = known._replace if hasattr(known, "_replace") else partial(replace, known)
    changed: Any = change(**{option: value})
    return replace(record, **{group: changed})
