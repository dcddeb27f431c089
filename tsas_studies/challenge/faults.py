"""Small faults of one sensor: what a good laboratory may not notice, at the size of the noise.

No cause of them is a mechanism of the rig. An answer may name the fault where the catalogue has it,
warn, or say nothing; it may not name something else.
"""

from collections.abc import Mapping

from tsas_studies.challenge.near import PHASE, Size, sized

# A force is read wrong by 0.1 to 0.4 N, a position by 0.02 to 0.06 mm.
FAULTS: Mapping[str, tuple[Size, ...]] = {
    "amplifier_filter": (sized(f_in_time_s=0.004), sized(f_out_time_s=0.01)),
    "channel_delay": (
        sized(False, f_in_delay_s=0.004), sized(False, f_out_delay_s=0.01),
        sized(False, x_out_delay_s=0.002),
    ),
    "coarse_converter": (
        sized(f_in_step_N=0.5), sized(f_out_step_N=0.5),
        sized(x_in_step_mm=0.06), sized(x_out_step_mm=0.06),
    ),
    "eccentric_encoder": (sized(amplitude_mm=0.02, period_mm=(4.0, 8.0), phase_rad=PHASE),),
    "encoder_play": (sized(play_mm=0.03), sized(x_in_play_mm=0.03)),
    "force_crosstalk": (sized(False, f_in_of_f_out=0.01), sized(False, f_out_of_f_in=0.01)),
    "force_sensor_creep": (sized(share=0.012, time_s=(1.0, 3.0)),),
    "force_sensor_curvature": (sized(False, f_in_per_N=5e-5), sized(False, f_out_per_N=5e-5)),
    "force_sensor_drift": (
        sized(False, f_in_rate_N_per_s=0.02), sized(False, f_out_rate_N_per_s=0.02),
    ),
    "force_sensor_gain_drift": (
        sized(False, f_in_rate_per_s=0.002), sized(False, f_out_rate_per_s=0.002),
    ),
    "force_sensor_hysteresis": (
        sized(f_in_share=0.02, span_N=(5.0, 15.0)), sized(f_out_share=0.02, span_N=(5.0, 15.0)),
    ),
    "force_sensor_offset": (sized(False, f_in_offset_N=0.3), sized(False, f_out_offset_N=0.3)),
    "force_sensor_tilt": (sized(False, f_in_per_mm=3e-4), sized(False, f_out_per_mm=3e-4)),
    "hum": (sized(amplitude_N=0.2, frequency_Hz=(1.0, 8.0), phase_rad=PHASE),),
    "position_sensor_ripple": (sized(False, sine_mm=0.02, cosine_mm=0.0, period_mm=(4.0, 8.0)),),
    "sensor_lag": (sized(f_in_lag_s=0.005), sized(f_out_lag_s=0.01), sized(x_out_lag_s=0.002)),
    "thermal_offset": (sized(amplitude_N=0.2, frequency_Hz=(0.08, 0.2), phase_rad=PHASE),),
    "unsteady_clock": (sized(jitter_s=0.002),),
}  # fmt: skip
