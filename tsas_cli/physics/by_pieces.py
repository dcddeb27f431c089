"""Simulate a run that is too long for memory piece by piece; the solver's state is carried over.

The result is that of `simulate` for the whole run: each piece starts from the final state of the
one before. Speeds and delays need samples before and after; so a piece is computed with some of its
neighbours' samples, which each neighbour computes again.
"""

from collections.abc import Iterable, Iterator, Sequence
from copy import deepcopy
from dataclasses import dataclass, replace
from itertools import chain
from typing import NamedTuple

import numpy as np

from tsas_cli.physics.course import DIRECTION, DRIVE, TRAVEL, Output
from tsas_cli.physics.ends import DriveInput, EndInputs, ends_of
from tsas_cli.physics.response import (
    Dynamics,
    Prediction,
    State,
    advanced,
    at_rest,
    history,
    nodes_of,
    readings_of,
    solver_of,
)
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.sensors import new_memory, sensed
from tsas_cli.support.arrays import Floats

OVERLAP = 2  # samples of a neighbour: one for a speed, one more for an acceleration


class Start(NamedTuple):
    """Start of a piece: states of solver and sensors, and of the drive.

    Its position [mm], the direction of its last motion, and the travel since its last reversal.
    """

    state: State
    memory: Floats  # of the sensors
    position: float
    direction: float
    travel: float


@dataclass(frozen=True)
class _OverlappingPiece:
    """A piece with samples of its neighbours, indexed from the first of them.

    The piece is `first` … `end`−1. The model runs from `begin` to `until`−1, the range that delays
    and speeds need. The next piece's samples begin at `handover` and its model at `next_begin`;
    both are None in the last piece.
    """

    drive: DriveInput
    first: int
    end: int
    begin: int
    until: int
    handover: int | None
    next_begin: int | None


def simulate_pieces(
    rig: Rig,
    drives: Iterable[DriveInput],
    dynamics: Dynamics = "slip",
    *,
    nodes: int | None = None,
) -> Iterator[Prediction]:
    """Yield the response of each piece of a run, equal to that of `simulate` for the whole run.

    `drives` are one run's samples in order, with times since the start of the run; the fields
    besides the samples are those of the first one.

    ValueError: the dynamic model, which cannot be split, or a channel's delay longer than a piece.
    """
    if dynamics == "lugre":
        raise ValueError("the dynamic model cannot be simulated in pieces")
    start: Start | None = None
    mesh = 0
    for piece in _overlapping(drives, _longest_delay(rig)):
        ends = ends_of(rig, piece.drive, start and (start.position, start.direction, start.travel))
        if start is None:
            mesh = nodes_of(rig, piece.drive, dynamics, nodes)
            before = history(rig, ends, piece.drive.start_f_in_N, mesh)
            past_inputs = ends.first().after(before)
            state, memory = at_rest(rig, past_inputs, mesh), new_memory()
            if before:
                _, state = advanced(rig, past_inputs.part(0, len(before)), mesh, state)
        else:
            state, memory = start.state, start.memory
        to = piece.until if piece.next_begin is None else piece.next_begin
        outputs, state = advanced(rig, ends.part(piece.begin, to), mesh, state)
        signals = _read(rig, piece, ends, outputs, slice(piece.begin, to), memory)
        if piece.handover is not None:
            at = piece.handover
            of_drive = ends.course[[DRIVE, DIRECTION, TRAVEL], at].tolist()
            start = Start(deepcopy(state), memory.copy(), *of_drive)
            further, _ = advanced(rig, ends.part(to, piece.until), mesh, state)
            further = _read(rig, piece, ends, further, slice(to, piece.until), memory)
            signals = _concatenated(signals, further)
        drive = piece.drive.part(slice(piece.begin, piece.until))
        response = readings_of(rig, drive, signals, solver_of(mesh))
        yield _own_samples(response, piece.first - piece.begin, piece.end - piece.begin)


def _read(
    rig: Rig,
    piece: _OverlappingPiece,
    ends: EndInputs,
    outputs: Output,
    at: slice,
    memory: Floats,
) -> Output:
    """Return the signals of some samples of a piece, with the memory of the sensors."""
    motor = piece.drive.motor_mm
    own = None if motor is None else motor[at]
    return sensed(outputs, _times(piece.drive)[at], rig, ends.boundary, memory, own)


def _longest_delay(rig: Rig) -> float:
    return max(abs(delay) for delay in rig.effects.channel_delay)


def _overlapping(drives: Iterable[DriveInput], delay_s: float) -> Iterator[_OverlappingPiece]:
    """Yield each piece with samples of its neighbours, over more than twice the longest delay."""
    tail: DriveInput | None = None
    begin = 0
    upcoming = iter(drives)
    now = next(upcoming)
    for after in chain(upcoming, (None,)):
        first = 0 if tail is None else tail.values.size
        end = first + now.values.size
        head = None if after is None else _head(now, after, delay_s)
        drive = _concatenated_drives([part for part in (tail, now, head) if part is not None])
        size = drive.values.size
        if after is None:
            yield _OverlappingPiece(drive, first, end, begin, size, None, None)
            return
        time_s = _times(drive)
        next_s = float(_times(after)[0])
        handover = int(np.searchsorted(time_s, next_s - 2.0 * delay_s)) - OVERLAP
        if handover < begin:
            raise ValueError("a piece is shorter than a channel's delay")
        far_enough = int(np.searchsorted(time_s, time_s[handover + 1] + delay_s))
        next_begin = max(handover + OVERLAP, far_enough)
        yield _OverlappingPiece(drive, first, end, begin, size - 1, handover, next_begin)
        tail, begin, now = drive.part(slice(handover, end)), next_begin - handover, after


def _head(now: DriveInput, after: DriveInput, delay_s: float) -> DriveInput:
    until = float(_times(now)[-1]) + 2.0 * delay_s
    return after.part(slice(int(np.searchsorted(_times(after), until, side="right")) + OVERLAP))


def _times(drive: DriveInput) -> Floats:
    if drive.time_s is None:
        raise ValueError("pieces need the times of their samples")
    return drive.time_s


def _concatenated_drives(parts: Sequence[DriveInput]) -> DriveInput:
    loads = [part.load_values for part in parts if part.load_values is not None]
    motors = [part.motor_mm for part in parts if part.motor_mm is not None]
    return replace(
        parts[0],
        values=np.concatenate([part.values for part in parts]),
        load_values=np.concatenate(loads) if loads else None,
        time_s=np.concatenate([_times(part) for part in parts]),
        motor_mm=np.concatenate(motors) if motors else None,
    )


def _concatenated(one: Output, other: Output) -> Output:
    x_in, x_out, f_in, f_out = (
        np.concatenate(pair) for pair in zip(one[:4], other[:4], strict=True)
    )
    return Output(x_in, x_out, f_in, f_out, np.concatenate((one.phase, other.phase)))


def _own_samples(response: Prediction, first: int, end: int) -> Prediction:
    """Return a response without the samples of the neighbours."""
    names = ("x_in_mm", "x_out_mm", "f_in_N", "f_out_N", "phase")
    return replace(response, **{name: getattr(response, name)[first:end] for name in names})
