"""The drive: its frequency response with coherence, and its poles."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from tsas_cli.records.drive import BodeCurve, MeasuredResponse, Pole
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.figures import legend
from tsas_cli.reporting.numbers import RAISED


def draw_bode(
    figure: Any,
    measured: MeasuredResponse,
    fitted: BodeCurve,
    band_Hz: tuple[float, float] | None,
) -> None:
    """Draw magnitude, phase and coherence below each other; dots where the input does not tell."""
    rows = figure.subplots(3, 1, sharex=True, height_ratios=(3, 3, 1.5))
    at, excited = np.array(measured.frequency_Hz), np.array(measured.excited, dtype=bool)
    for axes, seen, curve in (
        (rows[0], measured.magnitude, fitted.magnitude),
        (rows[1], measured.phase_deg, fitted.phase_deg),
    ):
        dots = {"linestyle": "none", "marker": "o", "markeredgewidth": 0.0}
        values = np.array(seen)
        dots |= {"markersize": 3.2, "color": STAND_IN["measured"], "label": "measured"}
        axes.plot(at[excited], values[excited], **dots)
        axes.plot(fitted.frequency_Hz, curve, color=STAND_IN["simulated"], label="fitted")
    rows[0].set(xscale="log", yscale="log", ylabel="|G| [mm/(rpm s)]")
    rows[1].set_ylabel("phase [°]")
    rows[2].plot(at, measured.coherence, color=STAND_IN["muted"], linewidth=0.9)
    rows[2].axhline(0.8, color=STAND_IN["ink"], linewidth=1.0, linestyle=(0, (4, 3)))
    rows[2].set(ylim=(0.0, 1.05), ylabel="coherence", xlabel="frequency [Hz]")
    if band_Hz is not None:
        for axes in rows:
            axes.axvspan(*band_Hz, color=STAND_IN["line"], alpha=0.5, linewidth=0.0, zorder=0)
            for edge in band_Hz:
                axes.axvline(edge, color=STAND_IN["muted"], linewidth=0.5, zorder=0)
    rows[0].set_xlim(at[0], at[-1])
    # The page's text is no mathematics: powers of ten are written out.
    rows[0].yaxis.set_major_formatter(_power)
    rows[2].xaxis.set_major_formatter("{x:g}")
    rows[2].xaxis.set_minor_formatter("")
    figure.align_ylabels()
    legend(figure, rows[0])


def _power(value: float, _: object) -> str:
    return "10" + str(round(math.log10(value))).translate(RAISED) if value > 0.0 else ""


def draw_poles(figure: Any, poles: Sequence[Pole], band_Hz: tuple[float, float] | None) -> None:
    """Draw the poles by their decay and their frequency, open ones outside of the band."""
    axes = figure.subplots()
    for pole in poles:
        real, imaginary = pole.real_per_s, pole.imaginary_per_s / (2.0 * math.pi)
        mirror = (imaginary,) if imaginary == 0.0 else (imaginary, -imaginary)
        for y in mirror:
            axes.plot(
                real, y, linestyle="none",
                marker="x" if pole.kind == "pole" else "D", markersize=8, markeredgewidth=1.8,
                markerfacecolor="none",
                color=STAND_IN["after" if pole.in_band else "before"],
            )  # fmt: skip
    axes.plot(0.0, 0.0, linestyle="none", marker="x", markersize=8, markeredgewidth=1.8,
              color=STAND_IN["ink"])  # fmt: skip
    for edge in band_Hz or ():
        angle = np.linspace(0.5 * math.pi, 1.5 * math.pi, 100)
        axes.plot(
            2.0 * math.pi * edge * np.cos(angle), edge * np.sin(angle),
            color=STAND_IN["muted"], linewidth=1.0, linestyle=(0, (4, 3)),
        )  # fmt: skip
    axes.axvline(0.0, color=STAND_IN["muted"], linewidth=0.8)
    axes.set(xlabel="real part [1/s]", ylabel="imaginary part [Hz]")
