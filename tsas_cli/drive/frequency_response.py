"""The measured frequency response from motor speed to x_in, with its coherence (H1)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from tsas_cli.drive.runs import DriveRun

Floats = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]

SEGMENTS = 10.0  # of the longest run: long ones show low frequencies, many show coherence
LONGEST_S = 5.0
COHERENT = 0.8
POWER = 1e-5  # of the largest power of the input, below which it says nothing


@dataclass(frozen=True)
class FrequencyResponse:
    """H1 = S_ux/S_uu over frequency [mm per rpm s], its coherence, and where both tell, (m,)."""

    frequency_Hz: Floats
    response: Complex
    coherence: Floats
    excited: npt.NDArray[np.bool_]

    @property
    def band(self) -> tuple[float, float] | None:
        """Lowest and highest frequency that the input shows, None where there is none."""
        at = self.frequency_Hz[self.excited]
        return (float(at[0]), float(at[-1])) if at.size else None


def frequency_response(runs: Sequence[DriveRun]) -> FrequencyResponse:
    """Return the response that all runs show together, in segments that overlap by half.

    x_in drifts while the motor turns one way: each segment loses its straight line.
    """
    from scipy.signal import csd, welch

    longest = max(run.time_s[-1] for run in runs)
    segment_s = min(LONGEST_S, longest / SEGMENTS, *(run.time_s[-1] / 2.0 for run in runs))
    sums: list[npt.NDArray[np.complex128]] = []
    bins = min(round(segment_s / run.u.step_s) for run in runs) // 2
    for run in runs:
        n = round(segment_s / run.u.step_s)
        how = {"fs": 1.0 / run.u.step_s, "nperseg": n, "detrend": "linear"}
        spectra = (
            welch(run.u.values, **how)[1],
            csd(run.u.values, run.x_in, **how)[1],
            welch(run.x_in, **how)[1],
        )
        sums.append(run.time_s[-1] * np.array([s[1:bins] for s in spectra]))
    uu, ux, xx = np.sum(sums, axis=0)
    frequency = np.arange(1, bins) / segment_s
    coherence = np.abs(ux) ** 2 / np.maximum(np.abs(uu * xx), 1e-300)
    excited = (coherence > COHERENT) & (np.abs(uu) > POWER * np.abs(uu).max())
    # One bin that is coherent by chance is no band.
    excited &= np.convolve(excited, np.ones(3), mode="same") > 1.0
    response = ux / np.where(np.abs(uu) > 0.0, uu, 1.0)
    return FrequencyResponse(frequency, response, np.real(coherence), excited)
