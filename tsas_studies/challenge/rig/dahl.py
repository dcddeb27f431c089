"""Dahl's law of friction, which the tendon, the drive's end and the load's guide share.

Over a displacement Δu of one sign the state φ goes as φ → l + (φ − l) exp(−|Δu|/δ), without
regard to time, where l is the limit in this direction, sgn(Δu) at rest of all else (P. R. Dahl,
"Solid friction damping of mechanical vibrations", AIAA Journal 14, 1976). As δ → 0 this is
Coulomb friction. Friction that differs by direction has l = ±1 + asymmetry; friction that differs
by speed has the limits times a rise.
"""

import numpy as np

from tsas_studies.challenge.rig.compiled import compiled


@compiled
def dahl(du: float, phi: float, delta: float, asymmetry: float, rise: float) -> float:
    """Return the friction state after a displacement du [mm] of one sign."""
    limit = (np.sign(du) + asymmetry) * rise
    return float(limit + (phi - limit) * np.exp(-abs(du) / delta))


@compiled
def dahl_slope(du: float, phi: float, delta: float, asymmetry: float, rise: float) -> float:
    """Return ∂φ/∂du [1/mm], at du = 0 the larger one of both sides."""
    if du == 0.0:
        up, down = (1.0 + asymmetry) * rise, (-1.0 + asymmetry) * rise
        return float(max(up - phi, phi - down) / delta)
    sign = np.sign(du)
    limit = (sign + asymmetry) * rise
    return float(sign * (limit - phi) / delta * np.exp(-abs(du) / delta))
