"""Three lumps in the middle of a step, looked at row by row, and short runs of them."""

import numpy as np

from tests.physics.references import GROUP_A, LOADED_BY_SPRING, course_of
from tsas_cli.physics.lugre.chain import OWN_STEPS, StepControl, lugre_chain
from tsas_cli.physics.lugre.start import clear_state, lugre_laws
from tsas_cli.physics.lugre.state import PITCH, ROWS, Given, Step

N, LAST, GH = 3, 4, 2e-3
STEP = Step(GH, Given(30.0, 0.0), Given(27.0, 0.0), Given(0.0, 1.5), 0.14, 0.11, 1.2)


def nodes(s, row):
    return s[row : row + N + 2]


def segments(s, row):
    return s[row : row + N + 1]


def cleared(rig):
    """Return a state without motion, and the laws of its lumps."""
    s = np.zeros(ROWS * PITCH)
    clear_state(s, rig, N)
    return s, lugre_laws(rig, N, LOADED_BY_SPRING)


def run(
    drive, time_s, *, rig=GROUP_A, boundary=LOADED_BY_SPRING, n=N,
    tolerance=1e-3, steps=OWN_STEPS, **given,
):  # fmt: skip
    """Follow a drive from rest at the preload, where all places are zero."""
    start = np.zeros((2, n + 2))
    start[1] = rig.preload_N
    course = course_of(drive, rig, time_s=time_s, **given)
    return lugre_chain(course, start, rig, boundary, n, StepControl(tolerance, steps))
