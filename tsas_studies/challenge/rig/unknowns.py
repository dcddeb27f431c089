"""Causes that are not in the catalogue of effects, by name: which options of the rig they set."""

from collections.abc import Mapping

Place = tuple[str, ...]


def places(group: str, *same: str, **named: str) -> Mapping[str, Place]:
    """Return the places of parameters in a group: options of the `same` names, or so `named`."""
    return {name: (group, option) for name, option in ({n: n for n in same} | named).items()}


UNKNOWNS: Mapping[str, Mapping[str, Place]] = {
    # More friction of the drive around one place of its stroke.
    "rough_spot": places(
        "drive_end", friction_N="rough_N", position_mm="rough_at_mm", width_mm="rough_width_mm"
    ),
    # A sine on the load's force sensor, picked up from something that turns.
    "hum": places("f_out_N", amplitude_N="hum", frequency_Hz="hum_Hz", phase_rad="hum_phase_rad"),
    # Friction that follows a temperature: it rises and falls again within a run.
    "warm_friction": {"course": ("friction_course",)},
    # The sheath's clamp gives way by a jump when pulled hard, and comes back late.
    "loose_clamp": places(
        "give", step_mm="clamp_step_mm", up_N="clamp_up_N", down_N="clamp_down_N"
    ),
    # The encoder at the load loses counts at a few moments.
    "missed_counts": places("x_out_mm", "jumps"),
    # The tendon stretches further for seconds after the tension has changed.
    "tendon_creep": places("give", compliance_mm_per_N="creep_mm_per_N", time_s="creep_time_s"),
    # The load meets a soft stop near the end of its stroke.
    "end_stop": places("load_end", position_mm="stop_at_mm", stiffness_N_per_mm="stop_N_per_mm"),
}
