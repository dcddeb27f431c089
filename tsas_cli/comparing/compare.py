"""Two sides held against each other: values, causes, errors per run, and where the errors are."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tsas_cli.comparing.predictions import Both, ComparedRun, Predictions, error_rows, matched
from tsas_cli.comparing.sides import Overlap, Side, overlap, pairs, read_side
from tsas_cli.diagnosis.residual_map import LABELS, binned, edges_of
from tsas_cli.diagnosis.signals import signals_of
from tsas_cli.identification.model import Model
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.records.comparison import ErrorRow, ParameterPair
from tsas_cli.records.diagnosis import Maps
from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError
from tsas_cli.support.steps import NO_PROGRESS, Steps


@dataclass(frozen=True)
class Comparison:
    """What two sides say, side by side.

    `on` is the dataset that both models are held to, None where each is held to what it has read.
    """

    a: Side
    b: Side
    overlap: Overlap
    pairs: list[ParameterPair]
    recordings: list[Both]
    errors: list[ErrorRow]
    maps: dict[str, Maps]
    on: Dataset | None = None

    @property
    def sides(self) -> dict[str, Side]:
        """Both sides by their names."""
        return {"A": self.a, "B": self.b}

    @property
    def tested(self) -> list[ParameterPair]:
        """The parameters whose difference has an interval."""
        return [p for p in self.pairs if p.difference and p.difference.excludes_zero is not None]

    @property
    def differing(self) -> list[ParameterPair]:
        """The parameters that differ by more than their uncertainty."""
        return [p for p in self.tested if p.difference and p.difference.excludes_zero]

    @property
    def shared(self) -> list[Both]:
        """The recordings that both sides predict."""
        return [both for both in self.recordings if both.a and both.b]


def compare(
    a: Path | Model, b: Path | Model, *, on: Dataset | None = None, step: Steps = NO_PROGRESS
) -> Comparison:
    """Hold two models, or what two stages wrote, against each other.

    `a` and `b` are models, their files, or folders that `tsas calibrate`, `diagnose` or `simulate`
    wrote. Without a dataset `on` a folder's model is held to the recordings that the stage has
    read, and a model file to none.

    InputError: A or B is none of these, there is nothing that both hold, or a recording cannot be
    read.
    """
    sides = read_side(a), read_side(b)
    _refuse(sides, on)
    predictions = Predictions(step)
    predicted = [
        predictions.of(side, on or (None if side.kind == "model" else side.dataset))
        for side in sides
    ]
    recordings = matched(*predicted)
    return Comparison(
        *sides,
        overlap(*sides),
        pairs(*sides),
        recordings,
        error_rows(*sides, recordings),
        residual_maps(recordings),
        on,
    )


def _refuse(sides: tuple[Side, Side], on: Dataset | None) -> None:
    """Refuse what has nothing in common, or asks for a model where there is none."""
    without = [side for side in sides if side.model is None]
    if without and on is not None:
        raise InputError(
            "a simulation does not hold its model, so that it cannot be simulated on --on",
            where=without[0].path,
            remedy="give the model that it was made with",
        )
    if without and any(side.kind == "model" for side in sides):
        raise InputError(
            "a simulation and a model file have nothing to compare",
            where=without[0].path,
            expected="two models, or two folders that hold errors",
            remedy="give the simulation's model, or simulate the other one too",
        )
    gone = [side for side in without if side.dataset is None]
    if gone:
        raise InputError(gone[0].gone, where=gone[0].path, remedy="run `tsas simulate` again")


Errors = dict[tuple[str, str], tuple[Floats, Floats]]  # by channel and signal: signal, error


def residual_maps(recordings: list[Both]) -> dict[str, Maps]:
    """Return under `a` and `b`, per channel and signal, bins with mean and scatter of the error.

    The error is measured less simulated, in units of the channel's noise; the bins hold about as
    many samples of both sides together. Taken are the recordings that both sides predict; where
    there is none, each side's own. A channel or signal that one side lacks is left out.
    """
    shared = [both for both in recordings if both.a and both.b] or recordings
    a = _collected([both.a for both in shared if both.a])
    b = _collected([both.b for both in shared if both.b])
    out: dict[str, Maps] = {"a": {}, "b": {}}
    for channel, signal in (key for key in a if key in b):
        edges = edges_of(np.concatenate((a[channel, signal][0], b[channel, signal][0])), signal)
        bins = [binned(*side[channel, signal], edges, signal) for side in (a, b)]
        if signal in LABELS and len(bins[0]) != len(bins[1]):
            continue
        if all(bins):
            for side, of_side in zip(("a", "b"), bins, strict=True):
                out[side].setdefault(channel, {})[signal] = of_side
    return out if out["a"] else {}


def _collected(compared: list[ComparedRun]) -> Errors:
    """Return the errors of all runs over each signal, where both are numbers."""
    parts: dict[tuple[str, str], list[tuple[Floats, Floats]]] = {}
    for one in compared:
        signals = signals_of(one.run, one.f_in_N)
        for channel, error in one.errors.items():
            noise = one.noise(channel)
            if not noise:
                continue
            for name, signal in signals.items():
                there = np.isfinite(signal) & np.isfinite(error)
                part = signal[there], error[there] / noise
                parts.setdefault((channel, name), []).append(part)
    joined = {
        key: (np.concatenate([s for s, _ in some]), np.concatenate([e for _, e in some]))
        for key, some in parts.items()
    }
    return {key: both for key, both in joined.items() if both[0].size}
