"""Verdicts on a drive and data sheets that are made up, as several tests need them."""

import numpy as np

from tsas_cli.diagnosis.evidence import gain
from tsas_cli.drive.file import UNITS
from tsas_cli.drive.sentences import EQUATION_NAME, STIFF_NAME
from tsas_cli.effects import EFFECTS
from tsas_cli.identification.estimate import Estimate
from tsas_cli.recordings.manifest import Manifest
from tsas_cli.records.base import Value
from tsas_cli.records.diagnosis import HeldOut, RemainingResidual
from tsas_cli.records.drive import DriveCause, DriveDiagnosis

TITLE = {e.name: e.title for e in EFFECTS}
STATED = frozenset({"stated"})
TOLD = {
    name: Estimate(name, 0.5, UNITS[name], "fitted", None, 0.1, 0.3, 0.7)
    for name in ("delay_s", "motor_lag_s", "play_mm", "damping_ratio", "gain_mm_per_s_rpm")
}


def terms(*names):
    return frozenset(names)


class MadeUpSquares:
    """A search whose mean squares are given by set of terms, alike in all blocks of some size."""

    def __init__(self, squares, default=10.0, *, blocks=20, size=1):
        self.given, self.default, self.blocks, self.size = squares, default, blocks, size

    def mean_square(self, names):
        return float(self.given.get(names, self.default))

    def held_out(self, names):
        return np.full(self.blocks, self.size * self.mean_square(names))

    def gain(self, before, after):
        return gain(self.held_out(before), self.held_out(after))


def cause(effect, kind="", rivals=()):
    return DriveCause(
        effect=effect,
        title=TITLE[effect],
        kind=kind,
        rivals=rivals,
        parameters={"play_mm": Value.model_validate(TOLD["play_mm"], from_attributes=True)},
        gain_percent=40.0,
        gain_interval_percent=(30.0, 50.0),
    )


def verdict(name, *causes, stated=False, unexplained=False, depends=()):
    return DriveDiagnosis(
        verdict=name,
        reason="why",
        nominal=EQUATION_NAME if stated else STIFF_NAME,
        named=causes,
        gain_percent=40.0,
        gain_interval_percent=(30.0, 50.0),
        channels={
            "x_in_mm": HeldOut(
                unit="mm", rmse_before=0.4, rmse_after=0.2, noise_floor=0.1, attainable=0.15
            )
        },
        remainder=RemainingResidual(
            unexplained=unexplained, depends_on=depends, share_percent=5.0, mean_square=1.44
        ),
    )


def manifest(bends=(3.0, 3.0), **rig):
    sheet = {"load_stiffness_N_per_mm": 1.579, "friction_coefficient": 0.125} | rig
    runs = [
        {"id": f"r{k}", "file": f"runs/r{k}.parquet", "sha256": "0" * 64}
        | ({} if bend is None else {"total_bend_rad": bend})
        for k, bend in enumerate(bends)
    ]
    rig = {name: value for name, value in sheet.items() if value is not None}
    return Manifest.model_validate(
        {"format": 1, "name": "n", "kind": "measured", "rig": rig, "run": runs}
    )
