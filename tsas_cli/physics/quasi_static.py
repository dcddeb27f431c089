"""Simulate one run quasi-statically: which solver, how it starts, what the sensors would read."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from tsas_cli.physics.branches import branches
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.slip_chain import DISPLACEMENT, FORCE, Boundary, slip_chain
from tsas_cli.physics.static import static_model

Floats = npt.NDArray[np.float64]
Phases = npt.NDArray[np.int8]
Answer = tuple[Floats, Floats, Floats, Floats, Phases]
Dynamics = Literal["static", "slip"]

NODES = 60  # of the slip chain, where the closed form does not hold
MOST_DOUBLINGS = 30  # of the way that the drive goes before a run
SLACK, UNSETTLED = 2, 3  # phases beside +1, 0, −1


@dataclass(frozen=True)
class Drive:
    """What is given at the two ends during a run, as the sensors read it, shape (n,).

    `start_f_in_N` is the tension at the drive when the run begins, where it was measured: the
    tendon's history before that is chosen so that it fits.
    """

    values: Floats
    kind: Literal["displacement", "force"] = "displacement"
    load: Literal["spring", "force", "displacement"] = "spring"
    load_values: Floats | None = None
    start_f_in_N: float | None = None


@dataclass(frozen=True)
class Response:
    """What the model answers, as the sensors would read it, shape (n,) [mm, N].

    `phase` is +1 in contraction and −1 in loosening with the whole tendon slipping, 0 in a dead
    band, 2 slack, 3 not settled. `solver` says what computed it.
    """

    x_in_mm: Floats
    x_out_mm: Floats
    f_in_N: Floats
    f_out_N: Floats
    phase: Phases
    solver: str


def simulate(rig: Rig, drive: Drive, dynamics: Dynamics = "slip") -> Response:
    """Follow a run with the distributed model (`slip`) or the paper's lumped one (`static`).

    The distributed model takes the closed form where the load is a spring, and the slip chain
    everywhere else; the lumped one knows spring loads only.
    """
    ends = _Ends.of(rig, drive)
    if dynamics == "static":
        f_in, f_out, phase = static_model(ends.drive, rig)
        x_out = (f_out - rig.preload_N) / rig.load_stiffness_N_per_mm
        return _as_read(rig, (ends.drive, x_out, f_in, f_out, phase), 0, "lumped dead bands")
    before = _history(rig, ends, drive.start_f_in_N)
    solver = "closed form" if ends.is_plain else f"slip chain, {NODES} nodes"
    return _as_read(rig, _solve(rig, ends.after(before)), len(before), solver)


def _as_read(rig: Rig, answer: Answer, skip: int, solver: str) -> Response:
    """Add the sensors' zeros and drop the samples before the run."""
    x_in, x_out, f_in, f_out, phase = answer
    return Response(
        x_in[skip:] + rig.x_in_zero_mm,
        x_out[skip:] + rig.x_out_zero_mm,
        f_in[skip:],
        f_out[skip:],
        phase[skip:],
        solver,
    )


@dataclass(frozen=True)
class _Ends:
    """The ends in the model's own coordinates."""

    drive: Floats
    load: Floats
    boundary: Boundary

    @staticmethod
    def of(rig: Rig, drive: Drive) -> "_Ends":
        at_drive, at_load = drive.values, np.zeros_like(drive.values)
        if drive.kind == "displacement":
            at_drive = at_drive - rig.x_in_zero_mm
        if drive.load_values is not None and drive.load == "force":
            at_load = drive.load_values
        if drive.load_values is not None and drive.load == "displacement":
            at_load = drive.load_values - rig.x_out_zero_mm
        compliance = 1.0 / rig.load_stiffness_N_per_mm if drive.load == "spring" else 0.0
        kinds = (
            FORCE if drive.kind == "force" else DISPLACEMENT,
            FORCE if drive.load == "force" else DISPLACEMENT,
        )
        return _Ends(at_drive, at_load, Boundary(*kinds, compliance))

    @property
    def is_plain(self) -> bool:
        """Whether the closed form holds: displacement at the drive, a spring at the load."""
        drive, load, compliance = self.boundary
        return drive == DISPLACEMENT and load == DISPLACEMENT and compliance > 0.0

    def after(self, before: list[float]) -> "_Ends":
        """Return the ends with samples put before the first one."""
        load = np.full(len(before), self.load[0])
        return _Ends(
            np.concatenate((before, self.drive)), np.concatenate((load, self.load)), self.boundary
        )

    def first(self) -> "_Ends":
        """Return the first sample alone."""
        return _Ends(self.drive[:1], self.load[:1], self.boundary)


def _solve(rig: Rig, ends: _Ends) -> Answer:
    if ends.is_plain:
        f_in, f_out, phase = branches(ends.drive, rig)
        x_out = (f_out - rig.preload_N) / rig.load_stiffness_N_per_mm
        return ends.drive, x_out, f_in, f_out, phase
    wrap = np.array([rig.friction_coefficient * rig.total_bend_rad])
    return slip_chain(
        ends.drive, ends.load, wrap, np.array([rig.preload_N]), rig, ends.boundary, NODES
    )


def forgotten(rig: Rig, drive: Drive) -> int | None:
    """Return the first sample whose answer does not depend on what came before the run, or None.

    The tendon has forgotten that when it slips as a whole in the same direction (or hangs slack),
    whether the drive came from far above or from far below.
    """
    ends = _Ends.of(rig, drive)
    phases = [_solve(rig, ends.after([_far(rig, ends, side)]))[4][1:] for side in (1.0, -1.0)]
    same = np.flatnonzero((phases[0] == phases[1]) & np.isin(phases[0], (1, -1, SLACK)))
    return int(same[0]) if same.size else None


def _far(rig: Rig, ends: _Ends, side: float) -> float:
    """Return a drive from which the way back to the first sample makes the whole tendon slip."""
    first = float(ends.drive[0])
    stretch = rig.preload_N * rig.sheath_length_mm / rig.tendon_stiffness_N
    step = 1e-3
    for _ in range(MOST_DOUBLINGS):
        by_force = ends.boundary.drive == FORCE
        past = first * (1.0 + step) ** side if by_force else first + side * step * stretch
        if _solve(rig, ends.first().after([past]))[4][-1] in (1, -1, SLACK):
            break
        step *= 2.0
    return past


def _history(rig: Rig, ends: _Ends, wanted_f_in: float | None) -> list[float]:
    """Return a drive position to pass before the first sample, if one is needed, so that f_in fits.

    From rest the drive goes past its first position and back; how far decides the tension there,
    between those of contraction and loosening. It is found by bisection.
    """
    if wanted_f_in is None or ends.boundary.drive == FORCE:
        return []
    x = float(ends.drive[0])
    first = ends.first()
    at_rest = float(_solve(rig, first)[2][-1])
    side = math.copysign(1.0, at_rest - wanted_f_in)  # pulling past and back lowers the tension
    near, far = x, _far(rig, ends, side)
    for _ in range(40):
        middle = 0.5 * (near + far)
        if (float(_solve(rig, first.after([middle]))[2][-1]) - wanted_f_in) * side > 0.0:
            near = middle
        else:
            far = middle
    return [far]
