"""Causes that are not in the catalogue of effects, by name: which options of the rig they set."""

from collections.abc import Mapping

Place = tuple[str, ...]

UNKNOWNS: Mapping[str, Mapping[str, Place]] = {
    "rough_spot": {  # more friction of the drive around one place of its stroke
        "friction_N": ("drive_end", "rough_N"),
        "position_mm": ("drive_end", "rough_at_mm"),
        "width_mm": ("drive_end", "rough_width_mm"),
    },
    "hum": {  # a sine on the load's force sensor, picked up from something that turns
        "amplitude_N": ("f_out_N", "hum"),
        "frequency_Hz": ("f_out_N", "hum_Hz"),
        "phase_rad": ("f_out_N", "hum_phase_rad"),
    },
    # Friction that follows a temperature: it rises and falls again within a run.
    "warm_friction": {"course": ("friction_course",)},
    "loose_clamp": {  # the sheath's clamp gives way by a jump when pulled hard, and comes back late
        "step_mm": ("give", "clamp_step_mm"),
        "up_N": ("give", "clamp_up_N"),
        "down_N": ("give", "clamp_down_N"),
    },
    # The encoder at the load loses counts at a few moments.
    "missed_counts": {"jumps": ("x_out_mm", "jumps")},
    "tendon_creep": {  # the tendon stretches further for seconds after the tension has changed
        "compliance_mm_per_N": ("give", "creep_mm_per_N"),
        "time_s": ("give", "creep_time_s"),
    },
    "end_stop": {  # the load meets a soft stop near the end of its stroke
        "position_mm": ("load_end", "stop_at_mm"),
        "stiffness_N_per_mm": ("load_end", "stop_N_per_mm"),
    },
}
