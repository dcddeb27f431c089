"""Draw the figures of docs/lugre.md: `.venv/bin/python -m docs.lugre_figures`."""

import math
from pathlib import Path

import matplotlib as mpl
import numpy as np

from tests.physics.references import TABLE_1, wrap_of
from tsas_cli.physics.bristles import Bristles
from tsas_cli.physics.lugre.stability import Sliding, growth_rate

mpl.use("svg")
import matplotlib.pyplot as plt

AS_PRINTED = 50 * 0.31622  # N s/mm over the whole sheath
CRITICAL = 2.0 * math.sqrt(5000.0 * 2.5e-9 * TABLE_1.sheath_length_mm)
WRAP = wrap_of(TABLE_1)


def growth(damping: float, moment: Sliding) -> float:
    """Return the growth rate with a damping of the bristles [1/s]."""
    return growth_rate(TABLE_1._replace(bristles=Bristles(damping_N_s_per_mm=damping)), moment)


def contraction(speed: float, f_out: float) -> Sliding:
    """Return full slip towards the drive, the load's spring winding up."""
    return Sliding(f_out * math.exp(WRAP), 2.29 * speed, speed, whole=True)


def main() -> None:
    """Draw the map of steady contraction, and the dead band of loosening over the damping."""
    mpl.rcParams["svg.hashsalt"] = "lugre"  # the same file each time
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 3.4), layout="constrained")
    speeds, tensions = np.linspace(1.0, 40.0, 40), np.linspace(10.0, 80.0, 36)
    rates = [[growth(AS_PRINTED, contraction(v, f)) for v in speeds] for f in tensions]
    shown = left.contourf(
        speeds,
        tensions,
        rates,
        levels=[-1000, -500, -200, 0, 200, 500, 1000],
        cmap="PuOr_r",
        extend="both",
        alpha=0.6,
    )
    left.contour(speeds, tensions, rates, levels=[0.0], colors="black")
    figure.colorbar(shown, ax=left, label="growth [1/s]")
    for omega, name in ((1.0, "a"), (2.0, "b")):
        angle = np.linspace(0.0, math.pi, 100)
        x_in = 10.0 * (1.0 - np.cos(angle))
        left.plot(
            10.0 * omega * np.sin(angle),
            25.0 + 1.5 * x_in,
            "--",
            color="black",
            linewidth=0.8,
        )
        left.annotate(name, (10.0 * omega, 41.0), xytext=(3, 3), textcoords="offset points")
    left.set(
        xlabel="speed [mm/s]",
        ylabel="f_out [N]",
        title="As printed, contraction",
        xlim=(1, 40),
        ylim=(10, 80),
    )
    times = np.geomspace(0.3, 100.0, 40)
    for f_in in (20.0, 40.0, 80.0):
        moment = Sliding(f_in, -170.0, -1.0, whole=False)
        right.plot(times, [growth(k * CRITICAL, moment) for k in times], label=f"f_in {f_in:.0f} N")
    right.axvline(AS_PRINTED / CRITICAL, color="black", linestyle=":", linewidth=0.8)
    right.annotate("as printed", (AS_PRINTED / CRITICAL, 10.0), rotation=90, ha="right")
    right.axvline(1.0, color="black", linestyle=":", linewidth=0.8)
    right.annotate("critical", (1.0, 10.0), rotation=90, ha="right")
    right.set_xscale("log")
    right.set_yscale("symlog", linthresh=10.0)
    right.axhline(0.0, color="black", linewidth=0.8)
    right.set(
        xlabel="damping of the bristles over critical",
        ylabel="growth [1/s]",
        title="Dead band of loosening",
    )
    right.legend(frameon=False)
    figure.savefig(Path(__file__).parent / "lugre-stability.svg", metadata={"Date": None})


if __name__ == "__main__":
    main()
