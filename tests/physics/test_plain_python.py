"""Compiled and plain Python are the same program."""

import pytest

from tests.both_ways import answers

PROGRAM = """
import json
import sys
import numpy as np
from tests.physics.references import GROUP_A, course_of
from tsas_cli.effects import Effects, FreeTendon, StribeckFriction
from tsas_cli.physics.closed_form.branches import branches
from tsas_cli.physics.boundary import (DISPLACEMENT, FORCE, SPRING, Boundary)
from tsas_cli.physics.frames import empty_frames
from tsas_cli.physics.course import DRIVE, LOAD, TIME
from tsas_cli.physics.lugre.chain import StepControl, lugre_chain
from tsas_cli.physics.slip.chain import slip_chain
from tsas_cli.physics.closed_form.static import static_model

rig = GROUP_A._replace(effects=Effects(free_tendon=FreeTendon(152.0, 61.0)))
x = np.interp(np.linspace(0, 7, 300), np.arange(8), [0, 14, 13.9, 13.95, 13.2, -60, 13, 12])
varying = {"pulled": np.linspace(0.3, 0.5, 300), "lost": np.linspace(0.0, 5.0, 300)}
spiral = 14 + 0.1 * np.linspace(1, 0, 100) * (-1.0) ** np.arange(100)
equal_steps = np.arange(2e-3, 0.4, 2e-3)
answers = [branches(x, rig), branches(spiral, rig), static_model(x, rig)]
for drive, load, boundary in (
    (x, 0.0 * x, Boundary(DISPLACEMENT, SPRING)),
    (x, 25.0 - 3.0 * x, Boundary(DISPLACEMENT, FORCE)),
    (x, 0.9 * x, Boundary(DISPLACEMENT, DISPLACEMENT)),
    (25.0 + x, 0.0 * x, Boundary(FORCE, SPRING)),
):
    course = course_of(drive, rig, load=load, **varying)
    answers.append(slip_chain(course, rig, boundary, 10))
    few, start = course[:, 40:80].copy(), np.zeros((2, 7))
    few[DRIVE] -= few[DRIVE, 0] * (boundary.drive == DISPLACEMENT)
    few[LOAD] -= few[LOAD, 0] * (boundary.load == DISPLACEMENT)
    few[TIME] = np.arange(40) / 100
    start[1] = rig.preload_N
    lively = rig._replace(effects=Effects(stribeck_friction=StribeckFriction(0.1, 8.0)))
    steps = StepControl(1e3, equal_steps)  # their control would magnify rounding
    output, progress = lugre_chain(few, start, lively, boundary, 5, steps, None)
    answers.append([*output, np.hstack(progress)])
few[DRIVE], start = np.linspace(0, -20, 40), np.zeros((2, 7))  # it ends slack
start[1] = rig.preload_N
call = few, start, rig, Boundary(DISPLACEMENT, SPRING), 5, steps
output, progress = lugre_chain(*call, None)
assert output.phase[-1] == 2
along = [empty_frames(np.arange(0, 300, 7), 10) for _ in range(2)]
branches(x, rig, along[0])
slip_chain(course_of(x, rig), rig, Boundary(DISPLACEMENT, SPRING), 10, along[1])
along.append(empty_frames(np.arange(0, 40, 3), 5))
lugre_chain(*call, along[2])
answers += [[one.tension_N.ravel(), one.slip.ravel(), one.front] for one in along]
answers.append([*output, np.hstack(progress)])
columns = [column.tolist() for answer in answers for column in answer]
print(json.dumps(["numba" in sys.modules, columns]))
"""


def test_compiled_is_plain_python_to_rounding():
    plain, compiled = answers(PROGRAM, plain=True), answers(PROGRAM, plain=False)
    assert len(plain) == 3 * 3 + 4 * 5 + 5 * 6 + 3 * 3
    for ours, theirs in zip(plain, compiled, strict=True):
        assert ours == pytest.approx(theirs, rel=1e-9, abs=1e-9)
