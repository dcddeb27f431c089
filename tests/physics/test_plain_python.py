"""Compiled and plain Python are the same program."""

import pytest

from tests.both_ways import answers

PROGRAM = """
import json
import sys
import numpy as np
from tests.physics.lugre.lumps import run
from tests.physics.references import (DRIVEN_BY_FORCE, FREE, GROUP_A, LOADED_BY_DISPLACEMENT,
    LOADED_BY_FORCE, LOADED_BY_SPRING, branches, course_of, follow, slip_chain, static_model)
from tsas_cli.physics.boundary import DISPLACEMENT
from tsas_cli.physics.frames import empty_frames
from tsas_cli.physics.rig import with_values

x = np.interp(np.linspace(0, 7, 300), np.arange(8), [0, 14, 13.9, 13.95, 13.2, -60, 13, 12])
spiral = 14 + 0.1 * np.linspace(1, 0, 100) * (-1.0) ** np.arange(100)
answers = [branches(x, FREE), branches(spiral, FREE), static_model(x, FREE)]
stribeck = {"stribeck_friction.excess": 0.1, "stribeck_friction.velocity_mm_per_s": 8.0}
lively, time_s, few = with_values(GROUP_A, stribeck), np.arange(40) / 100, slice(40, 80)
steps = np.arange(2e-3, 0.4, 2e-3)  # their control would magnify rounding
pulled, lost = np.linspace(0.3, 0.5, 300), np.linspace(0.0, 5.0, 300)
for drive, load, boundary in (
    (x, 0.0 * x, LOADED_BY_SPRING),
    (x, 25.0 - 3.0 * x, LOADED_BY_FORCE),
    (x, 0.9 * x, LOADED_BY_DISPLACEMENT),
    (25.0 + x, 0.0 * x, DRIVEN_BY_FORCE),
):
    given = {"load": load, "pulled": pulled, "lost": lost}
    answers.append(follow(drive, rig=FREE, boundary=boundary, n=10, **given))
    drive = drive - drive[40] * (boundary.drive == DISPLACEMENT)
    given["load"] = load - load[40] * (boundary.load == DISPLACEMENT)
    given = {name: values[few] for name, values in given.items()}
    how = {"rig": lively, "boundary": boundary, "n": 5, "tolerance": 1e3, "steps": steps}
    output, progress = run(drive[few], time_s, **how, **given)
    answers.append([*output, np.hstack(progress)])
along = empty_frames(np.arange(0, 300, 7), 10)
slip_chain(course_of(x, FREE), FREE, LOADED_BY_SPRING, 10, along)
how = {"rig": FREE, "n": 5, "tolerance": 1e3, "steps": steps}
output, progress = run(np.linspace(0, -20, 40), time_s, **how)
assert output.phase[-1] == 2  # it ends slack
answers.append([along.tension_N.ravel(), along.slip.ravel(), along.front])
answers.append([*output, np.hstack(progress)])
columns = [column.tolist() for answer in answers for column in answer]
print(json.dumps(["numba" in sys.modules, columns]))
"""


def test_compiled_is_plain_python_to_rounding():
    plain, compiled = answers(PROGRAM, plain=True), answers(PROGRAM, plain=False)
    assert len(plain) == 3 * 3 + 4 * 5 + 5 * 6 + 3
    for ours, theirs in zip(plain, compiled, strict=True):
        assert ours == pytest.approx(theirs, rel=1e-9, abs=1e-9)
