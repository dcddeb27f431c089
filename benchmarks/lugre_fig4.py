"""The models of Fig. 4 of Yang 2025 beside each other: python -m benchmarks lugre_fig4."""

import math
from collections.abc import Iterator

import numpy as np

from benchmarks.row import Row
from tests.physics.references import TABLE_1
from tsas_cli.effects import Effects
from tsas_cli.physics.bristles import Bristles
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import simulate
from tsas_studies.challenge.rig.make_datasets import GROUPS

PRINTED = Bristles(damping_N_s_per_mm=50 * 0.31622)
AT_P_RAD = 0.12  # after the upper reversal


def measure() -> Iterator[Row]:
    """Compare each model with the dynamic one on a fine mesh, over the second period."""
    for group, (omega, radius, bend) in GROUPS.items():
        rig = TABLE_1._replace(sheath_length_mm=radius * bend, total_bend_rad=bend)
        time_s = np.arange(0.0, 4.0 * math.pi / omega, 1e-3)
        drive = DriveInput(10.0 * (1.0 - np.cos(omega * time_s)), time_s=time_s)
        plain = rig._replace(effects=Effects())
        models = {
            "static": simulate(plain, drive, "static"),
            "slip": simulate(plain, drive),
            "50 lumps": simulate(rig, drive, "lugre"),
            "as printed": simulate(rig._replace(bristles=PRINTED), drive, "lugre"),
        }
        exact = simulate(rig, drive, "lugre", nodes=200)
        second, at_p = time_s > 2.0 * math.pi / omega, int(1e3 * (math.pi + AT_P_RAD) / omega)
        for name, found in models.items():
            for channel in ("f_in_N", "f_out_N", "x_out_mm"):
                off = np.abs(getattr(found, channel) - getattr(exact, channel))[second]
                share = 100.0 * np.max(off) / np.ptp(getattr(exact, channel))
                yield Row(f"{group}, {name}: largest difference of {channel}", share, "%")
            yield Row(f"{group}, {name}: f_in at P", found.f_in_N[at_p], "N")
