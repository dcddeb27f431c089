"""Presliding after Bouc and Wen with n = 2 and equal shares: another shape than Dahl's.

dφ/du = (1 − φ² (1 + sgn(φ du)) / 2) / δ: straight back to φ = 0 after a reversal, then like tanh
to the limit (Y. K. Wen, Journal of the Engineering Mechanics Division 102, 1976).
"""

import numpy as np

from tsas_studies.challenge.rig.compiled import compiled

FULLEST = 1.0 - 1e-12  # of the limit: tanh reaches it nowhere


@compiled
def bouc_wen(du: float, phi: float, delta: float, rise: float) -> float:
    """Return the friction state after a displacement du [mm] of one sign, with limits ±rise."""
    sign = 1.0 if du >= 0.0 else -1.0
    ahead, to_go = sign * phi / rise, abs(du) / delta
    if ahead < 0.0:
        straight = min(to_go, -ahead)
        ahead += straight
        to_go -= straight
    if to_go > 0.0:
        ahead = np.tanh(np.arctanh(min(ahead, FULLEST)) + to_go)
    return float(sign * rise * ahead)


@compiled
def bouc_wen_slope(du: float, phi: float, delta: float, rise: float) -> float:
    """Return ∂φ/∂du [1/mm], at du = 0 the larger one of both sides."""
    if du == 0.0:
        return rise / delta
    sign = 1.0 if du >= 0.0 else -1.0
    ahead = sign * bouc_wen(du, phi, delta, rise) / rise
    return float(rise * (1.0 - max(ahead, 0.0) ** 2) / delta)
