"""Which effects, and which laws, are a fair description of a cause that is not in the catalogue.

Right in kind is a name of the same place and of the same dependence by another law: it sends nobody
to another part of the rig. A cause that is not listed has no fair name but its own.
"""

from collections.abc import Mapping

RIGHT_KIND: Mapping[str, tuple[str, ...]] = {
    "load_damping": ("load_friction",),
    "load_hysteresis": ("load_friction",),
    "load_relaxation": ("load_damping",),
    "drive_damping": ("drive_friction",),
    "force_sensor_curvature": ("force_sensor_gain",),
    "sensor_lag": ("channel_delay",),
    "rational_stribeck": ("stribeck_friction",),
    "root_stribeck": ("stribeck_friction",),
    "log_speed_friction": ("viscous_friction",),
    "ageing_friction": ("stribeck_friction",),
    "breakaway_friction": ("stribeck_friction",),
    "round_presliding": ("presliding",),
    "friction_cycles": ("friction_drift",),
    "wearing_friction": ("friction_drift",),
    "strand_roll": ("position_dependent_friction",),
    "shifting_sheath": ("load_dependent_friction",),
    "pulley_friction": ("drive_friction", "load_friction"),
    "slotted_clamp": ("load_hysteresis",),
    "force_sensor_gain_drift": ("force_sensor_drift",),
    "force_sensor_tilt": ("force_sensor_curvature",),
    "skewed_laser": ("position_sensor_gain",),
    "channel_delay": ("sensor_lag",),
    "force_sensor_creep": ("force_sensor_hysteresis",),
    "thermal_offset": ("force_sensor_drift",),
    "eccentric_encoder": ("drive_ripple",),
    "amplifier_filter": ("channel_delay", "sensor_lag"),
    "warm_friction": ("friction_drift",),
    "end_stop": ("load_spring_nonlinearity",),
}

# At which places a law of unnamed origin can say what such a cause does; a cause that follows time
# alone has none.
_ON_FRICTION = (
    "uneven_friction", "rational_stribeck", "root_stribeck", "log_speed_friction",
    "ageing_friction", "breakaway_friction", "round_presliding", "strand_roll",
    "position_dependent_friction", "shifting_sheath",
)  # fmt: skip
RIGHT_LAW: Mapping[str, frozenset[str]] = {
    **dict.fromkeys(_ON_FRICTION, frozenset({"tendon_law"})),
    **dict.fromkeys(
        ("pulley_friction", "drive_damping", "drive_inertia"), frozenset({"drive_law"})
    ),
    **dict.fromkeys(
        ("encoder_play", "skewed_laser", "position_sensor_ripple"), frozenset({"load_law"})
    ),
}
