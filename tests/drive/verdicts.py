"""Verdicts on a drive that are made up, as several tests need them."""

from tsas_cli.diagnosis.channel_errors import HeldOutErrors
from tsas_cli.drive.diagnosis import FoundDriveCause, FoundDriveDiagnosis
from tsas_cli.drive.search import NOTHING
from tsas_cli.effects import EFFECTS
from tsas_cli.identification.estimate import Estimate

TITLE = {e.name: e.title for e in EFFECTS}
STATED = frozenset({"stated"})
TOLD = {
    name: Estimate(name, 0.5, name.rpartition("_")[2], "fitted", None, 0.1, 0.3, 0.7)
    for name in ("delay_s", "motor_lag_s", "play_mm", "damping_ratio", "gain_mm_per_s_rpm")
}


def terms(*names):
    return frozenset(names)


def cause(effect, kind="", rivals=()):
    return FoundDriveCause(effect, kind, rivals, (TOLD["play_mm"],), 40.0, (30.0, 50.0))


def verdict(name, *causes, nominal=NOTHING, unexplained=False, depends=(), left=1.44):
    return FoundDriveDiagnosis(
        name, "why", nominal, terms("play"), causes, HeldOutErrors(0.4, 0.2, 0.1, 0.15),
        (40.0, 30.0, 50.0), left, 0.05, unexplained, depends,
    )  # fmt: skip
