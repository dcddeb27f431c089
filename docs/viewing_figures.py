"""Draw the figure of docs/viewing.md: `.venv/bin/python -m docs.viewing_figures`."""

from pathlib import Path

import matplotlib as mpl
import numpy as np

from tests.physics.references import GROUP_A
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import simulate

mpl.use("svg")
import matplotlib.pyplot as plt

FRONTS = (0.0, 0.25, 0.5, 0.75, 1.0)
STROKE_MM, AFTER_MM, SAMPLES = 20.0, 0.4, 4000


def main() -> None:
    """Draw tension along the sheath and at the drive while the front runs through."""
    mpl.rcParams["svg.hashsalt"] = "viewing"  # the same file each time
    pull = np.linspace(0.0, STROKE_MM, SAMPLES + 1)
    x_in = np.concatenate((pull, STROKE_MM - np.linspace(0.0, AFTER_MM, SAMPLES + 1)[1:]))
    every = np.arange(SAMPLES, x_in.size)
    run = simulate(GROUP_A, DriveInput(x_in), nodes=200, looked_at=every)
    frames, f_in = run.frames, run.f_in_N
    front = np.where(run.phase[every] == 1, 0.0, frames.front)  # all slips still when it turns
    travel, places = STROKE_MM - x_in[every], frames.places * GROUP_A.sheath_length_mm
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 3.4), layout="constrained")
    right.plot(travel, f_in[every], color="0.6")
    shades = mpl.colormaps["viridis"](np.linspace(0.0, 0.85, len(FRONTS)))
    for share, shade in zip(FRONTS, shades, strict=True):
        k = int(np.argmax(front >= share))
        tension = frames.tension_N[k]
        left.plot(places, tension, color=shade, label=f"front at {100.0 * share:.0f} %")
        at = share * GROUP_A.sheath_length_mm
        left.plot(at, np.interp(at, places, tension), "o", color=shade)
        right.plot(travel[k], f_in[every[k]], "o", color=shade)
    left.set(xlabel="place along the sheath [mm], drive to load", ylabel="tension [N]")
    left.legend(frameon=False, fontsize="small")
    right.set(xlabel="travel since the last reversal [mm]", ylabel="tension at the drive [N]")
    figure.savefig(Path(__file__).parent / "dead-band.svg", metadata={"Date": None})


if __name__ == "__main__":
    main()
