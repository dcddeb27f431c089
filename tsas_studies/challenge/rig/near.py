"""Causes near to the catalogue of effects and not in it, by name: which options they set.

They act where effects of the catalogue act, by another law, and are easily taken for one.
"""

from collections.abc import Mapping

from tsas_studies.challenge.rig.unknowns import Place

NEAR: Mapping[str, Mapping[str, Place]] = {
    "rational_stribeck": {  # friction that falls with speed, with a long tail
        "excess": ("surface", "rational_excess"),
        "velocity_mm_per_s": ("surface", "rational_velocity_mm_per_s"),
        "power": ("surface", "rational_power"),
    },
    "root_stribeck": {  # friction that falls with speed, with a sharp peak
        "excess": ("surface", "root_excess"),
        "velocity_mm_per_s": ("surface", "root_velocity_mm_per_s"),
    },
    "log_speed_friction": {  # friction that grows with the logarithm of the speed
        "share": ("surface", "log_share"),
        "velocity_mm_per_s": ("surface", "log_velocity_mm_per_s"),
    },
    "ageing_friction": {  # friction that grows with the time at rest
        "share": ("surface", "ageing_share"),
        "time_s": ("surface", "ageing_s"),
        "length_mm": ("surface", "ageing_mm"),
    },
    "breakaway_friction": {  # a tendon that sticks after each rest
        "excess": ("surface", "breakaway_excess"),
        "length_mm": ("surface", "breakaway_mm"),
    },
    "round_presliding": {"length_mm": ("friction", "round_mm")},  # presliding of Bouc and Wen
    "friction_cycles": {  # friction that follows a temperature up and down
        "share": ("friction", "cycle_share"),
        "period_s": ("friction", "cycle_s"),
        "phase_rad": ("friction", "cycle_phase_rad"),
    },
    # Friction that grows with the travel.
    "wearing_friction": {"per_mm": ("friction", "wear_per_mm")},
    "strand_roll": {  # friction that is periodic in the displacement
        "share": ("surface", "roll_share"),
        "period_mm": ("surface", "roll_mm"),
        "phase_rad": ("surface", "roll_phase_rad"),
    },
    # A sheath whose bend grows with the tension.
    "shifting_sheath": {"per_N": ("friction", "shift_per_N")},
    # A tendon that gets stiffer as it stretches.
    "stiffening_tendon": {"per_N": ("stiffening_per_N",)},
    # Friction of a pulley at the drive, by the tension on it.
    "pulley_friction": {"share": ("drive_end", "pulley_share")},
    "slotted_clamp": {  # an anchor of the load's spring that slides in a slot
        "play_mm": ("restraint", "clamp_play_mm"),
        "up_N": ("restraint", "clamp_up_N"),
        "down_N": ("restraint", "clamp_down_N"),
    },
    "force_sensor_creep": {  # a force sensor that reads part of a change late
        "share": ("f_in_transducer", "creep_share"),
        "time_s": ("f_in_transducer", "creep_s"),
    },
    "thermal_offset": {  # an offset of f_in that follows a temperature up and down
        "amplitude_N": ("f_in_N", "hum"),
        "frequency_Hz": ("f_in_N", "hum_Hz"),
        "phase_rad": ("f_in_N", "hum_phase_rad"),
    },
    "eccentric_encoder": {  # an encoder of the drive that turns off its centre
        "amplitude_mm": ("x_in_mm", "wave"),
        "period_mm": ("x_in_mm", "wave_period"),
        "phase_rad": ("x_in_mm", "wave_phase_rad"),
    },
    # A position sensor whose gain changes along its travel.
    "skewed_laser": {"per_mm": ("x_out_mm", "curvature")},
    "encoder_play": {  # play between the load, or the drive, and its encoder
        "play_mm": ("x_out_transducer", "play"),
        "x_in_play_mm": ("x_in_transducer", "play"),
    },
    "amplifier_filter": {  # a Butterworth filter of second order on one force
        "f_in_time_s": ("f_in_transducer", "filter_s"),
        "f_out_time_s": ("f_out_transducer", "filter_s"),
    },
    "coarse_converter": {  # a channel that is read in coarse steps
        "f_in_step_N": ("f_in_N", "step"),
        "f_out_step_N": ("f_out_N", "step"),
        "x_in_step_mm": ("x_in_mm", "step"),
        "x_out_step_mm": ("x_out_mm", "step"),
    },
    # Samples that are taken earlier or later than their time stamps say.
    "unsteady_clock": {"jitter_s": ("jitter_s",)},
}
