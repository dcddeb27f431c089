"""The tendon in its sheath: coloured by its tension, thick where it slips, its slip front.

Of the sheath are known length and total bend. It is drawn evenly bent: flat as an arc up to a
little over half a turn; beyond, where its ends would meet, as a helix of a gentle pitch.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import cast

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from tsas_cli.identification.model import Model
from tsas_cli.identification.model_file import read_model
from tsas_cli.identification.prepared import prepare
from tsas_cli.physics.frames import Frames
from tsas_cli.physics.response import simulate
from tsas_cli.physics.rig import Rig
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.run_files import read_recording
from tsas_cli.recordings.session import seconds_into
from tsas_cli.records.simulation import SimulationFile
from tsas_cli.reporting.colours import dark
from tsas_cli.reporting.inputs import series_of, written_in
from tsas_cli.reporting.names import TENSIONS
from tsas_cli.reporting.sources import Source, diagnosed_models, simulation_of
from tsas_cli.reporting.stream.recorder import Recorder, Times
from tsas_cli.reporting.stream.seen import SeenRun
from tsas_cli.support.arrays import Floats, Indices

PER_SECOND = 15.0
PER_SPAN = 120.0  # while a tension goes through all that it has in the run
MOST = 1500  # moments of one run, whatever its length
FLAT_UP_TO_RAD = 1.2 * math.pi
RISE = 0.15  # of a helix, over the way along the ground
THICK, THIN, TALL, APART = 0.011, 0.004, 0.36, 0.8  # of the scene's size
EYE = np.array([0.0, -0.9, 0.9])  # of the scene's size, from where it looks to its middle


@dataclass(frozen=True)
class TendonModels:
    """The models that a stage simulated a run with, its folder, and the nodes of their chains."""

    folder: Path
    models: Mapping[Source, Model]
    nodes: int | None


def models_of(run: SeenRun) -> TendonModels | None:
    """Return both models of a diagnosis, else the simulated one.

    None where neither stage took the run or wrote its models, and for a simulation with other
    dynamics than the slip chain's, which alone gives profiles along the tendon.
    """
    simulation, nodes = run.inputs.get(SimulationFile), None
    sources = diagnosed_models(run.inputs)
    if not sources:
        if simulation is None or simulation.dynamics != "slip":
            return None
        sources, nodes = simulation_of(run.inputs), simulation.nodes
    files = {source: source.folder / source.model for source in sources}
    folder = sources[0].folder
    if not written_in(folder, run.id) or not all(file.is_file() for file in files.values()):
        return None
    return TendonModels(folder, {source: read_model(file) for source, file in files.items()}, nodes)


def record_tendon(recorder: Recorder, run: SeenRun) -> None:
    """Simulate the run again with the models that a stage wrote, and record their tendons."""
    given = models_of(run)
    if given is None:
        return
    dataset, entry = cast("Dataset", run.inputs.dataset), run.file.run
    drive = prepare(read_recording(dataset.folder, entry)).drive
    tensions = [name for name in TENSIONS if name in written_in(given.folder, run.id)]
    rows = run.file.rows
    at = moments(run.time_s, [series_of(given.folder, run.id, rows, name) for name in tensions])
    followed: dict[Source, tuple[Rig, Frames]] = {}
    for source, model in given.models.items():
        rig, start = model.rig(entry), model.session_start(dataset.manifest)
        of_session = replace(drive, session_s=seconds_into(start, entry.started))
        found = simulate(rig, of_session, nodes=given.nodes, looked_at=at)
        if found.frames is not None:
            followed[source] = rig, found.frames
    record_tendons(recorder, run.entity("tendon"), run.times.at(at), followed)


def moments(time_s: Floats, tensions: Sequence[Floats]) -> Indices:
    """Return the samples to look at, increasing: more where a tension changes fast.

    `time_s` and each of the tensions, which may hold NaN, are of shape (n,).
    """
    steps = PER_SECOND * np.diff(time_s)
    for tension in tensions:
        finite = tension[np.isfinite(tension)]
        span = float(np.ptp(finite)) if finite.size else 0.0
        if span > 0.0:
            steps = np.fmax(steps, PER_SPAN / span * np.abs(np.diff(tension)))
    passed = np.concatenate(([0.0], np.cumsum(steps)))
    found = np.searchsorted(passed, np.arange(0.0, passed[-1], max(1.0, passed[-1] / MOST)))
    return np.unique(np.append(found, time_s.size - 1)).astype(np.int64)


def record_tendons(
    recorder: Recorder,
    entity: str,
    times: Times,
    tendons: Mapping[Source, tuple[Rig, Frames]],
) -> None:
    """Record tendons behind each other, and above each the tension along it, to one scale."""
    from matplotlib import colormaps

    every = np.concatenate([frames.tension_N.ravel() for _, frames in tendons.values()])
    low, high = float(np.nanmin(every)), float(np.nanmax(every))
    size = _size([rig for rig, _ in tendons.values()])
    for number, (source, (rig, frames)) in enumerate(tendons.items()):
        path, colour = f"{entity}/{source.key}", dark(source.role)
        line = sheath_of(rig.sheath_length_mm, rig.total_bend_rad, frames.slip.shape[1])
        line[:, 1] += APART * size * number
        tension = np.nan_to_num(frames.tension_N)
        raised = np.broadcast_to(line, (*tension.shape, 3)).astype(np.float32)
        raised[..., 2] += TALL * size / high * tension
        recorder.static(f"{path}/tension", rr.LineStrips3D.from_fields(colors=colour, radii=-1.5))
        recorder.columns(f"{path}/tension", times, rr.LineStrips3D.columns(strips=raised))
        text = f"{source.label}, {low:.3g} to {high:.3g} N"
        name = rr.Points3D([line[0]], labels=[text], colors=colour, radii=0.0, show_labels=True)
        recorder.static(f"{path}/name", name)
        # A map that is even to the eye and never lost on black; colours as 0xRRGGBBAA.
        middles = 0.5 * (tension[:, 1:] + tension[:, :-1])
        share = 0.18 + 0.79 * (middles - low) / ((high - low) or 1.0)
        packed = np.ascontiguousarray(colormaps["plasma"](share, bytes=True)).view(">u4")
        shades = packed[..., 0].astype(np.uint32)
        # The tendon in pieces, thick where they slip.
        pieces = np.stack((line[:-1], line[1:]), axis=1).astype(np.float32)
        recorder.static(f"{path}/tendon", rr.LineStrips3D(pieces))
        radii = size * np.where(np.isin(frames.slip, (1, -1)), THICK, THIN)
        columns = rr.LineStrips3D.columns(colors=shades.ravel(), radii=radii.ravel())
        counts = np.full(len(radii), len(pieces))
        recorder.columns(f"{path}/tendon", times, columns.partition(counts))
        # The front where it runs, as a point on the tension.
        runs = (frames.front > 0.0) & (frames.front < 1.0)
        places = [
            [np.interp(front, frames.places, axis) for axis in now.T]
            for front, now in zip(frames.front[runs], raised[runs], strict=True)
        ]
        look = rr.Points3D.from_fields(colors=dark("ink"), radii=-6.0)
        recorder.static(f"{path}/front", look)
        points = rr.Points3D.columns(positions=np.array(places).reshape(-1, 3))
        recorder.columns(f"{path}/front", times, points.partition(runs.astype(np.int64)))


def view_of_tendon(run: SeenRun) -> rrb.View | None:
    """Return the view of a run's tendon, None where no stage tells a model of it."""
    given = models_of(run)
    if given is None:
        return None
    size = _size([model.rig(run.file.run) for model in given.models.values()])
    others = len(given.models) - 1
    middle = np.array([0.0, 0.5 * APART * size * others, 0.2 * size])
    eye = rrb.EyeControls3D(
        position=middle + (1.0 + 0.3 * others) * size * EYE, look_target=middle, eye_up=(0, 0, 1)
    )
    return rrb.Spatial3DView(
        name="Tendon, and the tension along it",
        contents=f"+ {run.entity('tendon')}/**",
        eye_controls=eye,
        line_grid=False,
    )


def sheath_of(length_mm: float, bend_rad: float, elements: int) -> Floats:
    """Return the centre line, evenly spaced, shape (elements + 1, 3) [mm].

    Drive and load are at the near side (−y), the drive on the left, the arc behind them.
    """
    rise = math.atan(RISE) if bend_rad > FLAT_UP_TO_RAD else 0.0
    turn = bend_rad / math.cos(rise)  # of the heading: a helix bends by its cosine
    heading = turn * (0.5 - (np.arange(elements) + 0.5) / elements)
    flat = np.column_stack((np.cos(heading), np.sin(heading))) * math.cos(rise)
    steps = np.column_stack((flat, np.full(elements, math.sin(rise)))) * length_mm / elements
    line: Floats = np.vstack((np.zeros(3), np.cumsum(steps, axis=0)))
    middle = 0.5 * (line.min(axis=0) + line.max(axis=0))
    centred: Floats = line - [middle[0], middle[1], 0.0]
    return centred


def _size(rigs: Sequence[Rig]) -> float:
    """Return how large the scene is [mm]: half a turn of the longest sheath is as wide."""
    return 2.0 / math.pi * max(rig.sheath_length_mm for rig in rigs)
