"""Contradictions 3 and 7 to 9: the last lump, free tendon, the biased line, ill-posed bristles."""

import math
from collections.abc import Iterator

import numpy as np
from scipy.optimize import brentq

from tsas_cli.effects import Effects
from tsas_cli.effects.free_tendon import FreeTendon
from tsas_cli.paper import Paper
from tsas_cli.physics.lugre.stability import Sliding, growth_rate
from tsas_cli.physics.response import simulate
from tsas_studies.reproduction.fig_7 import bands_of
from tsas_studies.reproduction.group import Row
from tsas_studies.reproduction.rig import (
    bench_rig,
    dynamic_rig,
    motion,
    quasi_static_rig,
    stiffness_in_slip,
    tendon_stiffness,
    wrap_of,
)
from tsas_studies.reproduction.verdicts import holds, signed, undetermined, within

PERCENT = 5.0
F_OUT_N = 40.0  # at which the limit of stable sliding is stated
FASTEST_MM_S = 1000.0


def last_lump(paper: Paper) -> list[Row]:
    """3: K(n, n) of Eq. (14) against the balance of forces of the last lump."""
    n, kL = int(paper.value("rig.microelements")), paper.value("rig.load_stiffness")
    L = paper.value("rig.sheath_length")
    k = tendon_stiffness(paper) * n / L
    printed, right = -2.0 * k, -(k + kL)
    seen = []  # the static stiffness of n lumps without friction, K X = −k x_in e1
    for corner in (printed, right):
        K = k * (np.eye(n, k=1) + np.eye(n, k=-1) - 2.0 * np.eye(n))
        K[-1, -1] = corner
        seen.append(float(k * (1.0 - np.linalg.solve(K, np.eye(n)[0] * -k)[0])))
    series = 1.0 / (L / tendon_stiffness(paper) + 1.0 / kL)
    return [
        holds(
            "K(n, n) = −2k of Eq. (14) is the balance of the last lump",
            "Eq. (14)",
            true=math.isclose(printed, right, rel_tol=1e-2 * PERCENT),
            criterion=f"within {PERCENT:g} %",
            unit="N/mm",
            paper=printed,
            ours=right,
            because="the load's spring stands behind the last lump, not a segment: −(k + kL), "
            f"with k = {k:.0f} and kL = {kL:g} N/mm",
            evidence=f"Without friction the drive would feel {seen[0]:.1f} N/mm, a tendon clamped "
            f"at its end; with −(k + kL) it feels {seen[1]:.4f}, tendon and load spring in series "
            f"({series:.4f}).",
        )
    ]


def free_tendon(paper: Paper) -> list[Row]:
    """7: tendon outside of the sheath, which the paper supposes and does not test."""
    theory = paper.value("stiffness.theory.km_dead_band")
    up, down = paper["stiffness.measured.km_f_b"], paper["stiffness.measured.km_c_e"]
    length = tendon_stiffness(paper) * (1.0 / up.value - 1.0 / theory)
    for_down = tendon_stiffness(paper) * (1.0 / down.value - 1.0 / theory)
    both = 1.0 / (1.0 / theory + length / tendon_stiffness(paper))
    rig, (_, drive) = quasi_static_rig(paper), motion(paper, "a")
    plain = simulate(rig, drive)
    free = simulate(rig._replace(effects=Effects(free_tendon=FreeTendon(length, 0.0))), drive)
    less = float(np.max(plain.x_out_mm) - np.max(free.x_out_mm))
    return [
        within(
            "Tendon outside of the sheath that explains km of f-b explains that of c-e",
            down,
            both,
            percent=PERCENT,
            because="tendon in series makes both bands softer; for c-e its length would have to be "
            f"{signed(for_down, 0)} mm",
            evidence=f"{length:.0f} mm in series with {theory:g} N/mm give {both:.2f} N/mm, in "
            f"both bands; measured are {up.value:g} (f-b) and {down.value:g} N/mm (c-e).",
        ),
        undetermined(
            "Tendon outside of the sheath makes the measured x_out smaller than calculated",
            "text, Model validation",
            unit="mm",
            ours=-less,
            because="Fig. 4 prints no number for how much smaller it is",
            evidence=f"{length:.0f} mm of it at the drive take {less:.2f} mm off the largest x_out "
            f"of group a, {np.max(plain.x_out_mm):.2f} mm: the sign is right.",
        ),
    ]


def biased(paper: Paper) -> Iterator[Row]:
    """8: a straight line through a whole dead band against the secant that (33) takes."""
    for name, band in bands_of(bench_rig(paper), paper).items():
        printed, slope = paper["stiffness.theory.km_dead_band"], band.slope()
        yield within(
            f"A line through the dead band {name.replace('_', '-')} has km of Eq. (29)",
            printed,
            slope,
            percent=PERCENT,
            because="slip spreads along the sheath, so that the tension is steep after the "
            "reversal and flat at the end of the band: the line is biased without any noise",
            evidence=f"Evenly spaced points over {band.width_mm:.3f} mm; secant "
            f"{band.secant:.1f}, tangent from infinity to {band.last_tangent:.1f} N/mm.",
        )


def ill_posed(paper: Paper) -> Iterator[Row]:
    """9: steady sliding of the dynamic model as printed, by the eigenvalues of disturbances."""
    for group in ("a", "b"):
        fastest = paper.value("rig.input_amplitude") * paper.value(
            f"groups.{group}.angular_frequency"
        )
        limit = speed_limit(paper, group)
        rates = [
            growth_rate(dynamic_rig(paper, group, as_printed=literal), _contraction(paper, fastest))
            for literal in (True, False)
        ]
        yield holds(
            f"Contraction of group {group} is stable as printed",
            "Eq. (15), Table 1, Fig. 4",
            true=limit is None or fastest < limit,
            criterion="with its fastest speed below the limit",
            unit="mm/s",
            paper=fastest,
            ours=limit,
            because=f"at f_out = {F_OUT_N:g} N sliding is unstable above the limit, and Fig. 4 "
            "shows a curve all the same",
            evidence=f"At {fastest:g} mm/s the fastest disturbance grows by "
            f"{signed(rates[0], 0)}/s as printed, {signed(rates[1], 0)}/s with critically "
            "damped bristles.",
        )


def _contraction(paper: Paper, speed: float) -> Sliding:
    """Return full slip towards the drive at `F_OUT_N`, the load's spring winding up."""
    rig = quasi_static_rig(paper)
    rate = stiffness_in_slip(rig, 1.0) * speed
    return Sliding(F_OUT_N * math.exp(wrap_of(rig)), rate, speed, whole=True)


def speed_limit(paper: Paper, group: str) -> float | None:
    """Return the speed above which contraction as printed is unstable [mm/s], None if it is not."""
    rig = dynamic_rig(paper, group, as_printed=True)

    def growth(speed: float) -> float:
        return growth_rate(rig, _contraction(paper, speed))

    if growth(FASTEST_MM_S) < 0.0:
        return None
    return float(brentq(growth, 1.0, FASTEST_MM_S, xtol=1e-3))
