"""Causes near to the catalogue of effects and not in it, by name: which options they set.

They act where effects of the catalogue act, by another law, and are easily taken for one.
"""

from collections.abc import Mapping

from tsas_studies.challenge.rig.unknowns import Place, places

NEAR: Mapping[str, Mapping[str, Place]] = {
    # Friction that falls with speed, with a long tail.
    "rational_stribeck": places(
        "surface",
        excess="rational_excess",
        velocity_mm_per_s="rational_velocity_mm_per_s",
        power="rational_power",
    ),
    # Friction that falls with speed, with a sharp peak.
    "root_stribeck": places(
        "surface", excess="root_excess", velocity_mm_per_s="root_velocity_mm_per_s"
    ),
    # Friction that grows with the logarithm of the speed.
    "log_speed_friction": places(
        "surface", share="log_share", velocity_mm_per_s="log_velocity_mm_per_s"
    ),
    # Friction that grows with the time at rest.
    "ageing_friction": places(
        "surface", share="ageing_share", time_s="ageing_s", length_mm="ageing_mm"
    ),
    # A tendon that sticks after each rest.
    "breakaway_friction": places("surface", excess="breakaway_excess", length_mm="breakaway_mm"),
    # Presliding of Bouc and Wen.
    "round_presliding": places("friction", length_mm="round_mm"),
    # Friction that follows a temperature up and down.
    "friction_cycles": places(
        "friction", share="cycle_share", period_s="cycle_s", phase_rad="cycle_phase_rad"
    ),
    # Friction that grows with the travel.
    "wearing_friction": places("friction", per_mm="wear_per_mm"),
    # Friction that is periodic in the displacement.
    "strand_roll": places(
        "surface", share="roll_share", period_mm="roll_mm", phase_rad="roll_phase_rad"
    ),
    # A sheath whose bend grows with the tension.
    "shifting_sheath": places("friction", per_N="shift_per_N"),
    # A tendon that gets stiffer as it stretches.
    "stiffening_tendon": {"per_N": ("stiffening_per_N",)},
    # An anchor of the load's spring that slides in a slot.
    "slotted_clamp": places(
        "restraint", play_mm="clamp_play_mm", up_N="clamp_up_N", down_N="clamp_down_N"
    ),
    # A force sensor that reads part of a change late.
    "force_sensor_creep": places("f_in_transducer", share="creep_share", time_s="creep_s"),
    # An offset of f_in that follows a temperature up and down.
    "thermal_offset": places(
        "f_in_N", amplitude_N="hum", frequency_Hz="hum_Hz", phase_rad="hum_phase_rad"
    ),
    # An encoder of the drive that turns off its centre.
    "eccentric_encoder": places(
        "x_in_mm", amplitude_mm="wave", period_mm="wave_period", phase_rad="wave_phase_rad"
    ),
    # A position sensor whose gain changes along its travel.
    "skewed_laser": places("x_out_mm", per_mm="curvature"),
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
