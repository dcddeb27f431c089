"""One case on the independent rig: four runs as in Table 2 of Yang 2025, each with nested loops."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from datetime import datetime, timedelta

import numpy as np

from tsas_studies.challenge.cases import Hidden
from tsas_studies.challenge.conditions import Nuisance, spoiled
from tsas_studies.challenge.rig.courses import Course
from tsas_studies.challenge.rig.hidden import hide
from tsas_studies.challenge.rig.load_end import LoadEnd
from tsas_studies.challenge.rig.motions import Floats, Motion, clock
from tsas_studies.challenge.rig.recordings import DATA_SHEET
from tsas_studies.challenge.rig.sensors import Sensor, Sensors, measure
from tsas_studies.challenge.rig.tendon import CleanRun, Rig, simulate

# Angular frequency [rad/s], periods, radius of curvature [mm], total bend [rad] of each run.
RUNS = {
    "a": (1.0, 2, 250.0, math.pi),
    "b": (2.0, 4, 250.0, math.pi),
    "c": (1.0, 2, 200.0, math.pi),
    "d": (1.0, 2, 200.0, math.pi / 2.0),
}
AMPLITUDE_MM = 10.0
NESTED_MM = (20.0, 6.0, 14.0, 8.0, 20.0, 0.0)
ACCELERATION_MM_S2 = 40.0
FINER = 2  # samples of the rig's clock per sample of the recording
CELLS = 60
PRELOAD_N = 25.0
LOOSE_SHARE = 0.5  # of a hidden mass, so that it does not swing long on the tendon
OFF = 0.1  # a nominal parameter differs from its data sheet by up to this share
UNEVEN = 0.1  # of the curvature along the sheath: 0.015 to 0.06 N in f_in beyond a refit
FIRST_RUN = datetime(2026, 3, 2, 9, 30)  # noqa: DTZ001 # a lab's clock has no zone
SENSORS = Sensors(
    jitter_s=5e-5,
    x_in_mm=Sensor(noise=0.01, step=0.002),
    x_out_mm=Sensor(noise=0.01, step=0.002),
    f_in_N=Sensor(noise=0.1, step=0.01),
    f_out_N=Sensor(noise=0.1, step=0.01),
)


@dataclass(frozen=True)
class Bench:
    """What one case's rig is really like, beside what is hidden."""

    nominal: Mapping[str, float]  # friction, load stiffness, tendon modulus, preload: rig options
    bend_profile: Course  # where the sheath is bent more and where less
    started: Mapping[str, datetime]  # when each run began
    nuisance: Nuisance = field(default_factory=Nuisance)  # what its conditions add


def data_sheet() -> dict[str, float]:
    """Return what the manifest says of every case's rig: Table 1 of Yang 2025."""
    return DATA_SHEET | {"preload_N": PRELOAD_N}


def drawn_bench(rng: np.random.Generator) -> Bench:
    """Draw a rig whose parameters are off from their data sheet, and the times of its runs."""
    sheet = data_sheet()
    names = (
        "friction_coefficient",
        "load_stiffness_N_per_mm",
        "tendon_modulus_GPa",
        "preload_N",
    )
    nominal = {name: float(sheet[name] * rng.uniform(1.0 - OFF, 1.0 + OFF)) for name in names}
    places = np.linspace(0.0, 1.0, 5)
    profile = tuple((float(s), float(rng.uniform(1.0 - UNEVEN, 1.0 + UNEVEN))) for s in places)
    started, at = {}, FIRST_RUN + timedelta(minutes=int(rng.integers(0, 300)))
    for run in RUNS:
        started[run] = at
        at += timedelta(seconds=int(rng.integers(180, 900)))
    return Bench(nominal, profile, started)


def motion(run: str, rate_Hz: float) -> Motion:
    """Return the paper's sine of a run, then smooth strokes between the points of NESTED_MM."""
    omega, periods, _, _ = RUNS[run]
    points = np.array((0.0, *NESTED_MM))
    lasts = math.pi * np.sqrt(np.abs(np.diff(points)) / (2.0 * ACCELERATION_MM_S2))
    corners = periods * 2.0 * math.pi / omega + np.concatenate(([0.0], np.cumsum(lasts)))
    t = clock(corners[-1], rate_Hz)
    stroke = np.clip(np.searchsorted(corners, t, side="right") - 1, 0, lasts.size - 1)
    share = 0.5 * (1.0 - np.cos(math.pi * (t - corners[stroke]) / lasts[stroke]))
    nested = points[stroke] + share * np.diff(points)[stroke]
    return Motion(t, np.where(t < corners[0], AMPLITUDE_MM * (1.0 - np.cos(omega * t)), nested))


def rig_of(bench: Bench, run: str) -> Rig:
    """Return the rig of a run with nothing hidden."""
    _, _, radius, bend = RUNS[run]
    return Rig(
        total_bend_rad=bend,
        sheath_length_mm=radius * bend,
        bend_profile=bench.bend_profile,
        cells=CELLS,
        load_end=LoadEnd(loose_share=LOOSE_SHARE),
        **bench.nominal,  # type: ignore[arg-type] # all of them are numbers
    )


def clean_run(
    bench: Bench, hidden: Iterable[Hidden], run: str, *, rate_Hz: float
) -> tuple[CleanRun, Sensors]:
    """Return one run with its causes, and the sensors that are to read it."""
    session_s = (bench.started[run] - bench.started["a"]).total_seconds()
    rig, sensors = rig_of(bench, run), replace(SENSORS, rate_Hz=rate_Hz, session_s=session_s)
    rig, sensors = spoiled(bench.nuisance, run, rig, sensors)
    for cause in hidden:
        rig, sensors = hide(cause.cause, cause.parameters, rig, sensors)
    return simulate(rig, motion(run, FINER * rate_Hz), session_s=session_s), sensors


def recorded(
    bench: Bench, hidden: Iterable[Hidden], run: str, *, rate_Hz: float, seed: int
) -> dict[str, Floats]:
    """Return the columns of one run as recorded."""
    clean, sensors = clean_run(bench, hidden, run, rate_Hz=rate_Hz)
    return measure(clean, sensors, seed=seed)
