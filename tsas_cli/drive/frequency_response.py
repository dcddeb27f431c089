"""The measured frequency response from motor speed to x_in, with its coherence (H1)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tsas_cli.drive.runs import FEWEST_SAMPLES, DriveRun
from tsas_cli.support.arrays import Complex, Floats, Mask

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
    excited: Mask

    @property
    def band(self) -> tuple[float, float] | None:
        """Lowest and highest frequency that the input shows, None where there is none."""
        at = self.frequency_Hz[self.excited]
        return (float(at[0]), float(at[-1])) if at.size else None


def frequency_response(runs: Sequence[DriveRun]) -> FrequencyResponse:
    """Return the response that all runs show together, in segments that overlap by half.

    x_in drifts while the motor turns one way: each segment loses its straight line. Of a run that
    shares samples with another one the longest stretch that counts is taken, if that is long enough
    for a run.
    """
    from scipy.signal import csd, welch

    whole = [
        (run, stretch)
        for run, stretch in ((run, run.longest) for run in runs)
        if run.counts.all() or stretch.stop - stretch.start >= FEWEST_SAMPLES
    ]
    lasts_s = [run.u.step_s * (s.stop - s.start - 1) for run, s in whole]
    segment_s = min(LONGEST_S, max(lasts_s) / SEGMENTS, *(lasts / 2.0 for lasts in lasts_s))
    sums: list[Complex] = []
    bins = min(round(segment_s / run.u.step_s) for run, _ in whole) // 2
    for (run, stretch), lasts in zip(whole, lasts_s, strict=True):
        n = round(segment_s / run.u.step_s)
        how = {"fs": 1.0 / run.u.step_s, "nperseg": n, "detrend": "linear"}
        u, x_in = run.u.values[stretch], run.x_in[stretch]
        spectra = (welch(u, **how)[1], csd(u, x_in, **how)[1], welch(x_in, **how)[1])
        sums.append(lasts * np.array([s[1:bins] for s in spectra]))
    uu, ux, xx = np.sum(sums, axis=0)
    frequency = np.arange(1, bins) / segment_s
    coherence = np.abs(ux) ** 2 / np.maximum(np.abs(uu * xx), 1e-300)
    excited = (coherence > COHERENT) & (np.abs(uu) > POWER * np.abs(uu).max())
    # One bin that is coherent by chance is no band.
    excited &= np.convolve(excited, np.ones(3), mode="same") > 1.0
    response = ux / np.where(np.abs(uu) > 0.0, uu, 1.0)
    return FrequencyResponse(frequency, response, np.real(coherence), excited)
