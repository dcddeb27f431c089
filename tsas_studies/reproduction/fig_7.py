"""Fig. 7: the stiffnesses that the paper measured, beside what the same lines give on the model.

The paper fits straight lines to its own recordings, which are not public. The distributed model
makes recordings of the same rig, and `tsas calibrate`'s fit is made of them.
"""

import numpy as np

from tsas_cli.paper import Paper, Printed
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats
from tsas_studies.reproduction.dead_band import DeadBand, dead_band
from tsas_studies.reproduction.group import Figure, Group, Line, Row
from tsas_studies.reproduction.recording import Fitted, Noise, fitted_stiffness
from tsas_studies.reproduction.rig import bench_rig, stiffness_in_slip
from tsas_studies.reproduction.table_3 import lumped_stiffness
from tsas_studies.reproduction.verdicts import holds, signed, within

PERCENT = 5.0
SEEDS = 8
NOISE = Noise()
LOUD = Noise(tension_N=10.0 * NOISE.tension_N, displacement_mm=10.0 * NOISE.displacement_mm)
PHASES = {  # the paper's names of the phases, ours, and the column of Table 3
    "b_c": ("contraction", "contraction"),
    "e_f": ("loosening", "loosening"),
    "f_b": ("dead_band_up", "dead_band"),
    "c_e": ("dead_band_down", "dead_band"),
}
_BESIDE = (
    "Each measured slope stands beside theory (Table 3) and beside the mean slope that `tsas "
    f"calibrate` fits to {SEEDS} recordings of this rig by the distributed model: group a, second "
    f"and third period, 1 kHz, noise of {NOISE.tension_N:g} N and "
    f"{1e3 * NOISE.displacement_mm:g} µm."
)


def fig_7(paper: Paper) -> Group:
    """Return the measured stiffnesses beside theory and beside the same fit on the model."""
    quiet = fitted_stiffness(paper, NOISE, seeds=SEEDS)
    loud = fitted_stiffness(paper, LOUD, seeds=SEEDS)
    bands = bands_of(bench_rig(paper), paper)
    rows = [
        *(_against_theory(paper, name) for name in PHASES),
        *(_against_the_fit(paper, name, quiet, loud, bands) for name in PHASES),
        _same_in_both(bands),
    ]
    return Group(
        "fig-7",
        "Fig. 7: stiffness as measured",
        (_BESIDE,),
        tuple(rows),
        tuple(_figure(paper, name, bands[name]) for name in ("f_b", "c_e")),
    )


def bands_of(rig: Rig, paper: Paper) -> dict[str, DeadBand]:
    """Return the two dead bands of the paper's motion."""
    top = 2.0 * paper.value("rig.input_amplitude")
    return {"f_b": dead_band(rig, top, up=True), "c_e": dead_band(rig, top, up=False)}


def _measured(paper: Paper, name: str) -> Printed:
    return paper[f"stiffness.measured.km_{name}"]


def _words(name: str) -> str:
    phase = PHASES[name][0].replace("_", " ")
    return f"{name.replace('_', '-')} ({phase})"


def _against_theory(paper: Paper, name: str) -> Row:
    """Judge "close to the corresponding values in Table 3" for one phase."""
    km = lumped_stiffness(paper)[PHASES[name][1]]
    measured = _measured(paper, name)
    off = 100.0 * (measured.value / km - 1.0)
    return within(
        f"km measured, {_words(name)}, against theory",
        measured,
        km,
        percent=PERCENT,
        because=f"the measured slope is {signed(off, 0)} % off theory, which the text calls close "
        "or slightly different; the rows below look for the cause",
        evidence=f"Measured {measured.value:g}, by Eq. (33) {km:.4g} N/mm: {signed(off, 1)} %.",
    )


def _against_the_fit(
    paper: Paper,
    name: str,
    quiet: dict[str, Fitted],
    loud: dict[str, Fitted],
    bands: dict[str, DeadBand],
) -> Row:
    fitted, noisy = quiet[PHASES[name][0]], loud[PHASES[name][0]]
    measured, rig = _measured(paper, name), bench_rig(paper)
    spread = (
        f"One recording's slope varies by {fitted.spread:.2g} N/mm; with ten times the noise the "
        f"mean is {noisy.mean:.4g} and the variation {noisy.spread:.2g} N/mm"
    )
    if name in bands:
        because = _part_of_band(bands[name], measured.value)
        away = abs(measured.value - noisy.mean) / noisy.spread
        spread += f"; the measured slope is {away:.0f} of those away"
    else:
        friction, stiffness = _rig_with_both(paper)
        because = (
            f"the two measured slopes of full slip are those of μ = {friction:.3f} and "
            f"kL = {stiffness:.3f} N/mm, not of Table 1's {rig.friction_coefficient:g} and the "
            f"text's {rig.load_stiffness_N_per_mm:g}"
        )
    return within(
        f"km measured, {_words(name)}, against the same fit on the model",
        measured,
        fitted.mean,
        percent=PERCENT,
        because=because,
        evidence=f"{spread}.",
    )


def _part_of_band(band: DeadBand, slope: float) -> str:
    """Say with which part of the curve a straight line would have this slope."""
    share = band.share_with_slope(slope)
    if share is not None:
        return (
            f"the curve is steep at the reversal and flat at its end; a line through the first "
            f"{100.0 * share:.0f} % of the band would have this slope"
        )
    if slope < band.last_tangent:
        return (
            "no part of the band has a slope below its last tangent, "
            f"{band.last_tangent:.1f} N/mm: something in series gives, or the line reaches into "
            "contraction"
        )
    return ""


def _rig_with_both(paper: Paper) -> tuple[float, float]:
    """Return μ and kL [N/mm] with which b-c and e-f have the measured slopes, Eqs. (30), (32)."""
    from scipy.optimize import root

    rig = bench_rig(paper)
    wanted = np.array([_measured(paper, "b_c").value, _measured(paper, "e_f").value])

    def off(unknown: Floats) -> Floats:
        mu, kL = unknown
        tried = rig._replace(friction_coefficient=mu, load_stiffness_N_per_mm=kL)
        missing: Floats = np.array([stiffness_in_slip(tried, side) for side in (1.0, -1.0)])
        missing -= wanted
        return missing

    start = [rig.friction_coefficient, rig.load_stiffness_N_per_mm]
    found = root(off, start).x
    return float(found[0]), float(found[1])


def _same_in_both(bands: dict[str, DeadBand]) -> Row:
    up, down = bands["f_b"].slope(), bands["c_e"].slope()
    off = 100.0 * (down / up - 1.0)
    return holds(
        "km of the c-e phase over that of the f-b phase",
        "text, Eq. (29)",
        true=abs(off) <= PERCENT,
        criterion=f"within {PERCENT:g} %",
        paper=1.0,
        ours=down / up,
        because="only the secants are the same; a line through evenly spaced points has another "
        f"slope in each band, {signed(off, 0)} %",
        evidence=f"Lines: {up:.1f} (f-b) and {down:.1f} N/mm (c-e); secants "
        f"{bands['f_b'].secant:.1f} and {bands['c_e'].secant:.1f}; last tangents "
        f"{bands['f_b'].last_tangent:.1f} and {bands['c_e'].last_tangent:.1f}.",
    )


def _figure(paper: Paper, name: str, band: DeadBand) -> Figure:
    """Draw a dead band over the drive's travel, and straight lines through its middle."""
    x, f = 1e3 * np.abs(band.x_mm), band.f_in_N
    sign = 1.0 if f[-1] > f[0] else -1.0
    middle_x, middle_f = float(np.mean(x)), float(np.mean(f))
    ends = np.array([x[0], x[-1]])

    def line(slope: float) -> Floats:
        return middle_f + sign * 1e-3 * slope * (ends - middle_x)

    measured = _measured(paper, name).value
    return Figure(
        f"fig-7-{name.replace('_', '-')}",
        f"Dead band {_words(name)}: the curve of the model, the line fitted to evenly spaced "
        "points of it, the secant, and a line with the measured slope through the middle.",
        ("travel of the drive since the reversal [µm]", "f_in [N]"),
        (
            Line("model", x, f, "simulated"),
            Line(f"fitted line, {band.slope():.0f} N/mm", ends, line(band.slope()), "after", True),
            Line(
                f"secant, Eq. (29), {band.secant:.0f} N/mm",
                ends,
                np.array([f[0], f[-1]]),
                "muted",
                True,
            ),
            Line(f"measured, {measured:.0f} N/mm", ends, line(measured), "before", True),
        ),
    )
