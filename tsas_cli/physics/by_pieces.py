"""Simulate a run that is too long for memory piece by piece; the solver's state is carried over.

The result is that of `simulate` for the whole run: the model goes on from piece to piece. Speeds
and delays need samples before and after; so the model runs ahead of each piece by the longest
delay, and some samples of the piece before are kept.
"""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import chain

import numpy as np

from tsas_cli.physics.course import DIRECTION, DRIVE, TRAVEL, Output, samples_of
from tsas_cli.physics.ends import DriveInput, ends_of
from tsas_cli.physics.response import (
    Dynamics,
    Prediction,
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

OVERLAP = 3  # samples of a neighbour: for a speed, an acceleration, an interpolation
SIGNALS = ("x_in_mm", "x_out_mm", "f_in_N", "f_out_N", "phase")  # of a prediction


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
    delay_s = max(map(abs, rig.effects.channel_delay))
    upcoming = iter(drives)
    drive = next(upcoming)
    ends = ends_of(rig, drive)
    mesh = nodes_of(rig, drive, dynamics, nodes)
    before = history(rig, ends, drive, mesh)
    past = ends.first().after(before)
    state, memory, start = at_rest(rig, past, mesh), new_memory(), None
    if before:
        _, state = advanced(rig, past.part(0, len(before)), mesh, state)
    signals: Output | None = None
    first = solved = 0  # of the present samples, of the piece and not yet solved
    for after in chain(upcoming, (None,)):
        end = until = drive.values.size
        whole = drive
        if after is not None:
            last_s, next_s = float(_times(drive)[-1]), _times(after)
            ahead = np.searchsorted(next_s, last_s + 2.0 * delay_s, side="right") + OVERLAP
            whole = _joined(drive, after.part(slice(int(ahead))))
            until = int(np.searchsorted(_times(whole), last_s + delay_s)) + 1
        time_s, ends = _times(whole), ends_of(rig, whole, start)
        output, state = advanced(rig, ends.part(solved, until), mesh, state)
        motor = None if whole.motor_mm is None else whole.motor_mm[solved:until]
        read = sensed(output, time_s[solved:until], rig, ends.boundary, memory, motor)
        if signals is not None:
            pairs = ((getattr(signals, name), getattr(read, name)) for name in Output._fields)
            read = Output._make(np.concatenate(pair) for pair in pairs)
        signals = read
        response = readings_of(rig, whole.part(slice(until)), signals, solver_of(mesh))
        own = {name: getattr(response, name)[first:end] for name in SIGNALS}
        yield replace(response, **own)  # without the samples of the neighbours
        if after is None:
            return
        kept_s = float(time_s[end]) - 2.0 * delay_s
        if delay_s > 0.0 and kept_s < time_s[first]:
            raise ValueError("a piece is shorter than a channel's delay")
        keep = max(int(np.searchsorted(time_s, kept_s)) - OVERLAP, 0)
        position, direction, travel = ends.course[[DRIVE, DIRECTION, TRAVEL], keep].tolist()
        start = position, direction, travel
        signals = samples_of(signals, slice(keep, None))
        drive = _joined(drive.part(slice(keep, None)), after)
        first, solved = end - keep, until - keep


def _times(drive: DriveInput) -> Floats:
    if drive.time_s is None:
        raise ValueError("pieces need the times of their samples")
    return drive.time_s


def _joined(one: DriveInput, other: DriveInput) -> DriveInput:
    columns = ((one.load_values, other.load_values), (one.motor_mm, other.motor_mm))
    load, motor = (None if a is None or b is None else np.append(a, b) for a, b in columns)
    return replace(
        one,
        values=np.append(one.values, other.values),
        load_values=load,
        time_s=np.append(_times(one), _times(other)),
        motor_mm=motor,
    )
