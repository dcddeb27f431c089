"""Eqs. (53) to (55): the function V that shall never grow, with exact rates and along sampled runs.

V = ½ φ1 s² + Σ (φ̂i − φi)²/(2 ψi), φ the true parameters of the drive equation (37).
"""

import math

import numpy as np

from tsas_cli.controllers.adaptive_sliding_mode import adaptation
from tsas_cli.controllers.closed_loop import DISTANCE, MEMORY_AT
from tsas_cli.controllers.signals import Signals
from tsas_cli.controllers.sliding_mode import Phi, Surface, distance, sliding_mode
from tsas_cli.paper import Paper
from tsas_cli.physics.closed_form.capstan import tension_ratio
from tsas_cli.support.arrays import Floats
from tsas_studies.reproduction.closed_loops import (
    CONDITIONS,
    READINGS,
    Reading,
    followed,
    paper_plant,
    settings_for,
)
from tsas_studies.reproduction.group import Group, Row
from tsas_studies.reproduction.verdicts import holds

TRUE = Phi(0.004, 25.0, 0.01)  # of the ideal plant, inside the bounds of Table 4
DISTURBANCE_RPM, DISTURBANCE_RAD_PER_S = 0.5, 3.0  # below the paper's ε of 1 rpm
BOUNDARY = 1e-3  # mm/s², so thin that the sign function is not missed
IDEAL_S, SAMPLES = 2.0, 4001
ROUNDING = 1e-6  # of the whole fall, or of the largest V
_HOW = (
    "V shall never grow while ε exceeds the disturbance. With exact rates, no noise and no "
    "sampling, the controller on the drive equation (37) itself; then along the sampled runs of "
    "Table 5, with the φ that the drive with its reaction has."
)


def lyapunov(paper: Paper) -> Group:
    """Return the rows on the argument for stability."""
    del paper  # its gains are the settings' defaults
    rows = [
        _ideal(),
        *(_sampled(condition, reading) for condition in CONDITIONS for reading in READINGS),
    ]
    return Group(
        "stability",
        "Eqs. (53) to (55): the argument for stability",
        (_HOW,),
        tuple(rows),
    )


def _ideal() -> Row:
    V = ideal_value()
    fall = float(V[0] - V[-1])
    rise = float(np.maximum(np.diff(V), 0.0).max()) / abs(fall)
    return holds(
        "V never grows, exact rates, no sampling",
        "Eq. (55)",
        true=fall > 0.0 and rise < ROUNDING,
        criterion=f"in the largest rise being below {ROUNDING:g} of the whole fall",
        ours=rise,
        because="it grows",
        evidence=f"V falls by {fall:.4g} in {IDEAL_S:g} s; ks per mm, "
        f"disturbance {DISTURBANCE_RPM:g} rpm, true φ {TRUE.phi1:g}, {TRUE.phi2:g}, "
        f"{TRUE.phi3:g}.",
    )


def ideal_value(sign: float = 1.0) -> Floats:
    """Return V at even times of a run on Eq. (37) itself; `sign` turns the adaptation round."""
    from scipy.integrate import solve_ivp

    law = settings_for("per mm").controllers.adaptive_sliding_mode
    surface = Surface(law.c1, law.c2, law.epsilon_rpm, law.ks, BOUNDARY)
    psi, start = Phi(*law.psi), Phi(*law.phi)

    def seen(t: float, y: Floats) -> Signals:
        x, v, a, jerk = 5.0 * math.sin(t), 5.0 * math.cos(t), -5.0 * math.sin(t), -5.0 * math.cos(t)
        e = x - y[0]
        return Signals(e, e, v - y[1], a - y[2], v, a, jerk, 0.0, limited=False)

    def rates(t: float, y: Floats) -> Floats:
        signals = seen(t, y)
        u = sliding_mode(signals, surface, Phi(y[3], y[4], y[5]))
        disturbance = DISTURBANCE_RPM * math.sin(DISTURBANCE_RAD_PER_S * t)
        jerk = (u - disturbance - TRUE.phi3 * y[2] - TRUE.phi2 * y[1]) / TRUE.phi1
        return np.array([y[1], y[2], jerk, *(sign * r for r in adaptation(signals, surface, psi))])

    first = np.array([0.1, 5.0, 0.0, *start])
    times = np.linspace(0.0, IDEAL_S, SAMPLES)
    run = solve_ivp(
        rates, (0.0, IDEAL_S), first, method="Radau", t_eval=times, rtol=1e-9, atol=1e-12
    )
    s = np.array([distance(seen(t, y), surface) for t, y in zip(times, run.y.T, strict=True)])
    return value(s, run.y[3:], TRUE, psi)


def value(s: Floats, estimates: Floats, true: Phi, psi: Phi) -> Floats:
    """Return V, shape (m,), of s, shape (m,), and the estimates, shape (3, m), Eq. (53)."""
    V: Floats = 0.5 * true.phi1 * s**2
    for estimate, phi, rate in zip(estimates, true, psi, strict=True):
        V = V + (estimate - phi) ** 2 / (2.0 * rate)
    return V


def true_phi() -> Phi:
    """Return φ of the paper's drive with the reaction of its stiffness, in contraction."""
    _, plant = paper_plant(settings_for("per m"), "undisturbed")
    rig, drive = plant.rig, plant.actuator
    wrap = rig.friction_coefficient * rig.total_bend_rad
    pull = rig.load_stiffness_N_per_mm / tension_ratio(wrap, 1.0)
    per = drive.stiffness_N_per_mm * drive.gain_mm_per_s_rpm
    return Phi(
        drive.inertia_N_s2_per_mm / per,
        (drive.stiffness_N_per_mm + pull) / per,
        drive.damping_N_s_per_mm / per,
    )


def _sampled(condition: str, reading: Reading) -> Row:
    law = settings_for(reading).controllers.adaptive_sliding_mode
    run = followed("adaptive-sliding-mode", condition, reading).run
    true, psi = true_phi(), Phi(*law.psi)
    V = value(run.columns[DISTANCE], run.columns[MEMORY_AT : MEMORY_AT + 3], true, psi)
    rises = np.diff(V)
    share = 100.0 * float(np.mean(rises > ROUNDING * V.max()))
    largest = float(rises.max() / V[0])
    at = float(run.time_s[int(np.argmax(rises))])
    return holds(
        f"V never grows, sampled, {condition}, ks {reading}",
        "Eq. (55)",
        true=share == 0.0,
        criterion="in no sample",
        unit="%",
        ours=share,
        because=f"it grows in {share:.0f} % of the samples: rates are estimates that come late, "
        f"and the bounds of Table 4 keep φ̂1 above {law.lowest[0]:g} while φ1 is {true.phi1:.3g}",
        evidence=f"The largest rise of a sample is {100.0 * largest:.2g} % of the first V, at "
        f"{at:.2f} s; over the run V goes to {V[-1] / V[0]:.3g} times the first.",
    )
