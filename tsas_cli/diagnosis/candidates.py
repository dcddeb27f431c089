"""The runs that a plan may propose: a fixed list, within the limits of the rig."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tsas_cli.diagnosis.motions import Kind
from tsas_cli.diagnosis.rig_file import Limits, PlannedRun
from tsas_cli.identification.prepared import Prepared
from tsas_cli.physics.rig import Rig

FASTER = 2.0  # than the planned runs, where no limit is stated
TIGHTER = 1.5  # the preload, where no limit is stated
MIDDLE, SLOW = 1.0 / 3.0, 0.1  # of the highest speed
LONG = 12  # periods of a run in which drifts are visible


@dataclass(frozen=True)
class CandidateRun:
    """A run that may be proposed, and a name for it; `assumed` are conditions not stated."""

    title: str
    run: PlannedRun
    assumed: frozenset[str] = frozenset()

    @property
    def sentence(self) -> str:
        """The instruction to record it."""
        r = self.run
        stroke = f"{r.periods} times 0 to {2.0 * r.amplitude_mm:.3g} mm and back"
        parts = [f"{self.title}: {stroke} at up to {r.speed:.3g} mm/s"]
        if r.dwell_s:
            parts.append(f"{r.dwell_s:g} s of rest after each stroke")
        conditions = {
            "preload_N": f"preload {r.preload_N:.3g} N",
            "total_bend_rad": f"bend {r.total_bend_rad:.3g} rad",
            "sheath_length_mm": f"sheath {r.sheath_length_mm:.4g} mm",
        }
        parts += [text for name, text in conditions.items() if name not in self.assumed]
        return ", ".join(parts)


def planned_limits(runs: Sequence[PlannedRun]) -> Limits:
    """Return plausible limits of the rig by planned runs, for limits that are not stated."""
    return _limits(
        [r.amplitude_mm for r in runs],
        [r.speed for r in runs],
        [r.preload_N for r in runs],
        [r.total_bend_rad for r in runs],
    )


def recorded_limits(runs: Sequence[Prepared]) -> Limits:
    """Return plausible limits of the rig by recorded runs."""
    driven = [r for r in runs if r.drive_column == "x_in_mm"]
    return _limits(
        [0.5 * float(np.ptp(r.drive.values)) for r in driven],
        [float(np.abs(np.gradient(r.drive.values, r.time_s)).max()) for r in driven],
        [r.run.preload_N for r in driven if r.run.preload_N],
        [r.run.total_bend_rad for r in driven if r.run.total_bend_rad is not None],
    )


def _limits(
    amplitudes: Sequence[float],
    speeds: Sequence[float],
    preloads: Sequence[float],
    bends: Sequence[float],
) -> Limits:
    tighter = [TIGHTER * max(preloads)] if preloads else []
    return Limits(
        amplitude_mm=max(amplitudes),
        speed_mm_per_s=FASTER * max(speeds),
        preload_N=tuple(sorted({*preloads, *tighter})),
        total_bend_rad=tuple(sorted(set(bends))),
    )


def within(stated: Limits, otherwise: Limits) -> Limits:
    """Return the stated limits, and others where nothing is stated."""
    return otherwise.model_copy(update=stated.model_dump(exclude_defaults=True))


def candidates(
    limits: Limits, usual: Rig, repeated: PlannedRun | None = None
) -> list[CandidateRun]:
    """Return the runs that may be proposed.

    `limits` are those of the rig, with amplitude and speed stated; `usual` has the conditions that
    a candidate does not vary, and `repeated` is a planned run that may be repeated.
    """
    A, v = limits.amplitude_mm or 1.0, limits.speed_mm_per_s or 1.0

    def made(
        title: str,
        motion: Kind,
        speed: float,
        *,
        periods: int = 2,
        dwell_s: float = 0.0,
        amplitude: float = 1.0,
        preload_N: float = usual.preload_N,
        bend_rad: float = usual.total_bend_rad,
    ) -> CandidateRun:
        run = PlannedRun(
            id=f"proposed: {title}",
            sheath_length_mm=usual.sheath_length_mm,
            total_bend_rad=bend_rad,
            preload_N=preload_N,
            motion=motion,
            amplitude_mm=amplitude * A,
            speed_mm_per_s=speed * v,
            periods=periods,
            dwell_s=dwell_s,
        )
        return CandidateRun(title, run)

    out = [
        made("a slow sine", "sine", SLOW),
        made("a fast sine", "sine", 1.0, periods=6),
        made("fast ramps", "ramps", 1.0, periods=4),
        made("nested loops", "nested", MIDDLE),
        made("short strokes", "sine", MIDDLE, periods=4, amplitude=0.3),
        made("a staircase with rests", "steps", MIDDLE, dwell_s=2.0),
        made("a chirp", "chirp", 1.0, periods=6),
        made("a long run", "sine", MIDDLE, periods=LONG),
    ]
    preload = _farthest(limits.preload_N, usual.preload_N)
    if preload is not None:
        out.append(made("another preload", "sine", MIDDLE, preload_N=preload))
    bend = _farthest(limits.total_bend_rad, usual.total_bend_rad)
    if bend is not None:
        out.append(made("another bend", "sine", MIDDLE, bend_rad=bend))
    if repeated is not None:
        again = repeated.model_copy(update={"id": f"proposed: {repeated.id} again"})
        out.append(CandidateRun(f"run {repeated.id} again", again))
    return out


def _farthest(values: Sequence[float], usual: float) -> float | None:
    """Return the value farthest from the usual one, or None where none differs."""
    farthest = max(values, key=lambda value: abs(value - usual), default=usual)
    return farthest if abs(farthest - usual) > 0.05 * abs(usual) else None
