"""The tendon in space: tension as colour and as a curtain's height, thick where it slips."""

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt
import rerun as rr
import rerun.blueprint as rrb
from rerun.blueprint import View

from tsas_cli.physics.phases import SLACK, UNCONVERGED
from tsas_cli.physics.response import ELEMENTS
from tsas_cli.physics.rig import Rig
from tsas_cli.reporting.colours import dark
from tsas_cli.reporting.stream.recorder import Entity, Recorder, Times
from tsas_cli.reporting.stream.sources import Which
from tsas_cli.reporting.stream.tendon.followed import TendonStates
from tsas_cli.reporting.stream.tendon.shades import Scale, dimmed, packed, scale_of
from tsas_cli.reporting.stream.tendon.stage import LEFT, TALL, Stand, stage_of
from tsas_cli.reporting.stream.views import all_below

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]

GROUND = 0x0D1014FF
SLIDES, STICKS, SHEATH, MARK = 0xFFFFFFFF, 0x6D7681FF, 0x4A535EFF, 0x0D1014FF
BRIGHT, PALE, FOOT = 0.1, 0.62, 0.55  # by which colours go down to the ground: slips, sticks, low
THICK, THIN, RAIL = 0.011, 0.004, 0.022  # radii, and where the sheath is, of the scene's size
MARKS = 24  # on the tendon, to see it move
STEPS = 48  # of the legend


def view_of_scene(entity: Entity, rigs: Sequence[Rig]) -> View:
    """Return the view of tendons, one for each rig."""
    stage = stage_of(rigs, ELEMENTS)
    up = (0.0, 0.0, 1.0)
    return rrb.Spatial3DView(
        name="Tendon",
        contents=all_below([entity]),
        background=rrb.Background(color=GROUND, kind="SolidColor"),
        eye_controls=rrb.EyeControls3D(position=stage.eye, look_target=stage.target, eye_up=up),
        line_grid=False,
    )


def record_scene(recorder: Recorder, entity: Entity, tendons: Mapping[Which, TendonStates]) -> None:
    """Record the tendons of one run above each other."""
    every = np.concatenate([one.frames.tension_N.ravel() for one in tendons.values()])
    scale = scale_of(float(np.nanmin(every)), float(np.nanmax(every)))
    followed = list(tendons.values())
    stage = stage_of([one.rig for one in followed], followed[0].frames.slip.shape[1])
    for (which, one), stand in zip(tendons.items(), stage.stands, strict=True):
        mine, times = [*entity, which.key], one.times
        _sheath(recorder, mine, times, one, stand, scale)
        _curtain(recorder, mine, times, one, stand, scale)
        _front(recorder, mine, times, one, stand, scale)
        _ends(recorder, mine, times, one, stand, scale)
        _captions(recorder, mine, times, one, stand, which)
    _legend(recorder, [*entity, "tension"], stage.stands[0], scale)


def _sheath(
    recorder: Recorder, entity: Entity, times: Times, one: TendonStates, stand: Stand, scale: Scale
) -> None:
    """Draw the tendon between the sheath's walls, with marks that move with it."""
    for side in (1.0, -1.0):
        wall = stand.at + stand.shape.beside(side * RAIL * stand.size)
        look = rr.LineStrips3D([wall], colors=SHEATH, radii=-1.5)
        recorder.static([*entity, "sheath", f"{side:+.0f}"], look)
    tension, line = one.frames.tension_N, stand.sheath
    shades = packed(scale.colours(0.5 * (tension[:, 1:] + tension[:, :-1])))
    radii = stand.size * np.where(one.slips, THICK, THIN)
    pieces = np.stack((line[:-1], line[1:]), axis=1)
    recorder.static([*entity, "tendon"], rr.LineStrips3D(pieces.astype(np.float32)))
    columns = rr.LineStrips3D.columns(colors=shades.ravel(), radii=radii.ravel())
    each = np.full(len(times), len(pieces))
    recorder.columns([*entity, "tendon"], times, columns.partition(each))
    painted = (np.arange(2 * MARKS) - 0.5 * MARKS) / MARKS
    marks = []
    for by in one.moved_mm() / one.rig.sheath_length_mm:
        at = painted - np.interp(painted, one.frames.places, by)
        marks.append(stand.at + stand.shape.at(at[(at >= 0.0) & (at <= 1.0)]))
    recorder.points_3d([*entity, "marks"], times, marks, MARK, radius=-2.5)


def _curtain(
    recorder: Recorder, entity: Entity, times: Times, one: TendonStates, stand: Stand, scale: Scale
) -> None:
    """Draw a surface from the sheath up to the tension, bright and edged where the tendon slips."""
    line, tension = stand.sheath, np.nan_to_num(one.frames.tension_N)
    top, count = line + _raised(stand, scale, tension), len(line)
    beside = np.zeros(tension.shape, dtype=bool)
    beside[:, :-1] |= one.slips
    beside[:, 1:] |= one.slips
    shades = scale.colours(tension)
    high = np.where(beside[..., None], dimmed(shades, BRIGHT, GROUND), dimmed(shades, PALE, GROUND))
    both = np.concatenate((packed(dimmed(high, FOOT, GROUND)), packed(high)), axis=1)
    corners = np.concatenate((np.broadcast_to(line, top.shape), top), axis=1)
    low = np.arange(count - 1, dtype=np.uint32)
    halves = (low, low + 1, low + count), (low + 1, low + count + 1, low + count)
    triangles = np.concatenate([np.stack(half, axis=1) for half in halves]).astype(np.uint32)
    recorder.static([*entity, "curtain"], rr.Mesh3D.from_fields(triangle_indices=triangles))
    columns = rr.Mesh3D.columns(
        vertex_positions=corners.reshape(-1, 3).astype(np.float32), vertex_colors=both.ravel()
    )
    each = np.full(len(times), 2 * count)
    recorder.columns([*entity, "curtain"], times, columns.partition(each))
    for name, where, shade, radius in (
        ("sticks", ~one.slips, STICKS, -1.0),
        ("slips", one.slips, SLIDES, -2.2),
    ):
        edge = [
            [points[first : end + 1] for first, end in _stretches(here)]
            for points, here in zip(top, where, strict=True)
        ]
        recorder.curves_3d([*entity, name], times, edge, shade, radius=radius)


def _raised(stand: Stand, scale: Scale, tension_N: Floats) -> Floats:
    """Return how far above the sheath tensions are drawn, shape (..., 3)."""
    height: Floats = TALL * stand.size / scale.high * tension_N
    raised: Floats = height[..., None] * np.array([0.0, 0.0, 1.0])
    return raised


def _front(
    recorder: Recorder, entity: Entity, times: Times, one: TendonStates, stand: Stand, scale: Scale
) -> None:
    """Draw the front where it runs: bright points on the tendon and on the curtain's edge."""
    low = stand.at + stand.shape.at(one.frames.front)
    posts = np.stack((low, low + _raised(stand, scale, one.tension_at_front())), axis=1)
    runs = one.front_runs_now
    points = [post[: 2 * here] for post, here in zip(posts, runs, strict=True)]
    lines = [[post] * bool(here) for post, here in zip(posts, runs, strict=True)]
    recorder.points_3d([*entity, "front", "ends"], times, points, SLIDES, radius=-6.0)
    recorder.curves_3d([*entity, "front", "line"], times, lines, SLIDES, radius=-1.2)


def _ends(
    recorder: Recorder, entity: Entity, times: Times, one: TendonStates, stand: Stand, scale: Scale
) -> None:
    """Draw free tendon, the drive's pulley and the load's spring."""
    ends, at, muted = stand.ends, stand.at, dark("muted")
    tension, thick = one.frames.tension_N, THICK * stand.size
    rim = rr.LineStrips3D([ends.rim + at], colors=muted, radii=-2.0)
    recorder.static([*entity, "drive", "rim"], rim)
    spokes = [list(now) for now in ends.spokes(one.x_in_mm) + at]
    recorder.curves_3d([*entity, "drive", "spokes"], times, spokes, muted, radius=-1.2)
    moving = ends.distal(one.x_out_mm)
    for name, lines, felt in (
        ("drive", np.broadcast_to(ends.proximal, moving.shape), tension[:, 0]),
        ("load", moving, tension[:, -1]),
    ):
        shades, strips = packed(scale.colours(felt)), [[line] for line in lines + at]
        recorder.curves_3d([*entity, name, "tendon"], times, strips, shades, radius=thick)
    springs = [[line] for line in ends.spring(one.x_out_mm) + at]
    recorder.curves_3d([*entity, "load", "spring"], times, springs, muted, radius=-1.5)
    anchor = rr.LineStrips3D([ends.anchor + at], colors=muted, radii=-2.5)
    recorder.static([*entity, "load", "anchor"], anchor)
    recorder.labels([*entity, "names"], ends.names + at, ["drive", "load"], muted)


def _captions(
    recorder: Recorder, entity: Entity, times: Times, one: TendonStates, stand: Stand, which: Which
) -> None:
    """Write the model's name, and under it what the tendon does at each time."""
    title, state = stand.captions
    recorder.labels([*entity, "title"], title[None], [which.label], dark(which.role))
    places = np.tile(state, (len(one.time_s), 1))
    look = rr.Points3D.from_fields(colors=dark("ink"), radii=0.0, show_labels=True)
    recorder.static([*entity, "state"], look)
    columns = rr.Points3D.columns(positions=places.astype(np.float32), labels=_said(one))
    recorder.columns([*entity, "state"], times, columns)


def _said(one: TendonStates) -> list[str]:
    """Say in a few words what the tendon does at each time."""
    texts = []
    for slip, front in zip(one.frames.slip, one.frames.front, strict=True):
        first = slip[0]
        drive = {1: "the drive pulls", -1: "the drive lets go"}.get(int(first), "")
        if first in (SLACK, UNCONVERGED):
            texts.append("slack" if first == SLACK else "not settled")
        elif not drive:
            texts.append("sticks at the drive")
        elif front == 1.0:
            texts.append(f"{drive}: all of it slips")
        else:
            texts.append(f"{drive}: dead band, the front is at {100.0 * front:.0f} %")
    return texts


def _legend(recorder: Recorder, entity: Entity, stand: Stand, scale: Scale) -> None:
    """Draw the scale of tension: a bar as high as the curtains, coloured as they are."""
    left = float(stand.shape.sheath[:, 0].min()) - 0.8 * LEFT * stand.size
    foot = stand.at + left * np.array([1.0, 0.0, 0.0])
    levels = np.linspace(scale.low, scale.high, STEPS + 1)
    bar = foot + _raised(stand, scale, levels)
    shades = packed(scale.colours(0.5 * (levels[1:] + levels[:-1]))).tolist()
    pieces = list(np.stack((bar[:-1], bar[1:]), axis=1))
    look = rr.LineStrips3D(pieces, colors=shades, radii=0.012 * stand.size)
    recorder.static([*entity, "bar"], look)
    beside = foot + _raised(stand, scale, np.array(scale.ticks))
    beside[:, 0] -= 0.07 * stand.size
    names = [f"{tick:g} N" for tick in scale.ticks]
    recorder.labels([*entity, "ticks"], beside, names, dark("muted"))


def _stretches(where: Bools) -> Sequence[Sequence[int]]:
    """Return first and end of each stretch that is true."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], where, [False])).astype(np.int8)))
    pairs: Sequence[Sequence[int]] = edges.reshape(-1, 2).tolist()
    return pairs
