"""Rigs with some effects, and runs of them, for the tests of single laws."""

import numpy as np

from tests.physics.references import GROUP_A
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import NODES, simulate
from tsas_cli.physics.rig import with_values

A = GROUP_A.friction_coefficient * GROUP_A.total_bend_rad
UP_AND_DOWN = np.concatenate((np.linspace(0.0, 14.0, 701), np.linspace(14.0, 0.0, 701)[1:]))


def run(values, x_in=UP_AND_DOWN, *, speed=1.0, rig=GROUP_A, **given):
    """Simulate on the mesh a motion, at a speed [mm/s], of the rig with some values replaced."""
    way = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(x_in)))))
    time_s = given.pop("time_s", way / speed)
    return simulate(with_values(rig, values), DriveInput(x_in, time_s=time_s, **given), nodes=NODES)
