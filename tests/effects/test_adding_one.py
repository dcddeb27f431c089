"""Adding an effect: one new file, its line in the catalogue, its call; then it is found."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import tsas_cli

PACKAGE = Path(tsas_cli.__file__).parent

TOY = '''"""A force sensor bends its scale.

What one sees: f_out is off by the square of the tension.
Equation: f_out reads T + curvature T². Made up for this test.
Mistaken for: force_sensor_gain, which is straight.
Not validated: anything.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel


class BentScale(NamedTuple):
    """Curvature of the scale of f_out [1/N]."""

    curvature_per_N: float = 0.0


@kernel
def bent(force: float, curvature_per_N: float) -> float:
    """Return what a sensor with a bent scale reads [N]."""
    return force + curvature_per_N * force * force


BENT_SCALE = Effect(
    name="bent_scale",
    title="Bent scale of a force sensor",
    acts_on="sensor",
    closed_form=True,
    equation="reading of f_out = T + curvature · T²",
    doc=__doc__,
    parameters=(
        Parameter("curvature_per_N", "1/N", neutral=0.0, start=1e-3, lower=-0.01, upper=0.01),
    ),
    experiment="Hang weights on the sensor.",
)
'''

LINES = {
    "effects/__init__.py": {
        "from tsas_cli.effects.bend_drift import": "from tsas_cli.effects.bent_scale import "
        "BENT_SCALE, BentScale\nfrom tsas_cli.effects.bend_drift import",
        "    FORCE_SENSOR_GAIN,\n": "    BENT_SCALE,\n    FORCE_SENSOR_GAIN,\n",
        "    force_sensor_gain: ": "    bent_scale: BentScale = BentScale()\n"
        "    force_sensor_gain: ",
    },
    "physics/sensors.py": {
        "from tsas_cli.effects.force_sensor_drift": "from tsas_cli.effects.bent_scale import bent\n"
        "from tsas_cli.effects.force_sensor_drift",
        "    return delayed * _gain": '    if channel == "f_out_N":\n'
        "        bend = bent(1.0, rig.effects.bent_scale.curvature_per_N) - 1.0\n"
        "        delayed = delayed + bend * delayed * delayed\n"
        "    return delayed * _gain",
    },
}

NEAREST = ("bent_scale", "force_sensor_gain")
# Rows and rate of each run, its bends, the effects to choose from; as plain Python, and compiled.
SMALL = (130, 20.0, (3.0, 1.0), NEAREST)
WHOLE = (1500, 100.0, (3.0, 2.0, 1.0), (*NEAREST, "force_sensor_offset", "free_tendon"))
SCRIPT = """
import numpy as np
from tsas_cli.diagnosis.fits import Fits
from tsas_cli.diagnosis.held_out import folds_of
from tsas_cli.diagnosis.search import significant_effects
from tsas_cli.effects import EFFECTS
from tsas_cli.identification.base_fit import base_fit, slopes_of
from tsas_cli.identification.extension import bench_of
from tsas_cli.identification.joint_fit import solve_fit
from tsas_cli.identification.model import data_sheet
from tsas_cli.identification.phases import segment
from tsas_cli.identification.prepared import prepare
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import simulate
from tsas_cli.physics.rig import Rig, with_values
from tsas_cli.recordings.recording import Recording
from tsas_cli.recordings.manifest import Manifest, Run
from tsas_cli.recordings.manifest import RigSheet as Sheet

rng = np.random.default_rng(1)
ROWS, RATE_HZ, BENDS, AMONG = SIZE
time_s = np.arange(ROWS) / RATE_HZ
runs = []
for k, bend in enumerate(BENDS):
    x_in = 8.0 * (1.0 - np.cos((1.0 + 0.2 * k) * time_s))
    rig = with_values(Rig(0.12, 6e4, 1.5, 600.0, bend, 25.0), {"bent_scale.curvature_per_N": 1e-3})
    r = simulate(rig, DriveInput(x_in, time_s=time_s))
    clean = {"x_in_mm": x_in, "f_in_N": r.f_in_N, "f_out_N": r.f_out_N, "x_out_mm": r.x_out_mm}
    noise = {"x_in_mm": 0.005, "f_in_N": 0.05, "f_out_N": 0.05, "x_out_mm": 0.005}
    columns = {n: v + noise[n] * rng.standard_normal(v.size) for n, v in clean.items()}
    about = dict(sheath_length_mm=600.0, total_bend_rad=bend, preload_N=25.0)
    run = Run(id=f"r{k}", file="runs/r.parquet", sha256="0" * 64, **about)
    runs.append(prepare(Recording(run, {"time_s": time_s} | columns)))
manifest = Manifest(format=1, name="toy", kind="simulated", run=tuple(r.run for r in runs))
parts = [segment(run) for run in runs]
slopes = [slopes_of(run, p) for run, p in zip(runs, parts)]
fit = solve_fit(base_fit(data_sheet(manifest), runs, parts, slopes))
folds = folds_of([e.blocks(rig, 200) for e, rig in zip(fit.errors, fit.rigs)])
fits = Fits(bench_of(fit), folds, effects=tuple(e for e in EFFECTS if e.name in AMONG))
named = significant_effects(fits)
print(sorted(named), *fits.trial(named).values().values())
"""


@pytest.fixture(scope="module")
def extended(tmp_path_factory):
    """A copy of the package with the toy effect in it."""
    root = tmp_path_factory.mktemp("extended")
    shutil.copytree(PACKAGE, root / "tsas_cli", ignore=shutil.ignore_patterns("__pycache__"))
    (root / "tsas_cli/effects/bent_scale.py").write_text(TOY, encoding="utf-8")
    for file, changes in LINES.items():
        path = root / "tsas_cli" / file
        text = path.read_text(encoding="utf-8")
        for old, new in changes.items():
            assert old in text
            text = text.replace(old, new, 1)
        path.write_text(text, encoding="utf-8")
    return root


def run(extended, *arguments, plain=""):
    env = os.environ | {"PYTHONPATH": str(extended), "TSAS_CACHE_DIR": str(extended / "cache")}
    env["TSAS_PLAIN_PYTHON"] = plain
    done = subprocess.run(
        [sys.executable, *arguments],
        env=env,
        cwd=extended,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_it_is_explained_from_its_file(extended):
    said = run(extended, "-m", "tsas_cli", "explain", "bent_scale")
    assert "off by the square of the tension" in said
    assert "curvature_per_N" in said
    assert "bent_scale" in run(extended, "-m", "tsas_cli", "effects")


@pytest.mark.parametrize(
    ("size", "plain"), [(SMALL, "1"), pytest.param(WHOLE, "", marks=pytest.mark.large)]
)
def test_hidden_in_recordings_it_is_found(extended, size, plain):
    name, value = run(extended, "-c", f"SIZE = {size}\n{SCRIPT}", plain=plain).split("] ")
    assert name == "['bent_scale'"
    assert float(value) == pytest.approx(1e-3, rel=0.05)
