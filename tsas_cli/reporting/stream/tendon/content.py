"""The tendon's part of the stream: in space, along the sheath, the dead band, slip fronts."""

from collections.abc import Mapping

from rerun.blueprint import Horizontal, Tabs, Vertical

from tsas_cli.physics.passages import ends_of
from tsas_cli.reporting.stream.events import Event, record_events
from tsas_cli.reporting.stream.plane import plane_view
from tsas_cli.reporting.stream.portraits import view_of
from tsas_cli.reporting.stream.recorder import Recorder
from tsas_cli.reporting.stream.seen import SeenRun
from tsas_cli.reporting.stream.sources import Which
from tsas_cli.reporting.stream.tendon.along import record_along
from tsas_cli.reporting.stream.tendon.band import record_band
from tsas_cli.reporting.stream.tendon.followed import TendonStates
from tsas_cli.reporting.stream.tendon.models import F_IN, models_of, tendons_of
from tsas_cli.reporting.stream.tendon.scene import record_scene, view_of_scene
from tsas_cli.reporting.stream.views import Part

SPACE, ALONG, BAND = ("tendon", "space"), ("tendon", "along"), ("tendon", "dead-band")
_WORDS = {1: "pulled", -1: "let go"}


def view_of_tendon(run: SeenRun) -> Part | None:
    """Return what shows the tendon of a run, None where no stage tells a model of it.

    Raises
    ------
    InputError
        A model's file cannot be read.
    """
    given = models_of(run)
    if given is None:
        return None
    rigs = [model.rig(run.file.run) for model in given.models.values()]
    space = view_of_scene(run.entity(*SPACE), rigs)
    along = plane_view("Tension along the sheath", run.entity(*ALONG))
    band = plane_view("The dead band from near", run.entity(*BAND))
    loops = [view_of(run, channel) for channel in run.loops if channel.column == F_IN]
    near = Tabs(band, *loops, active_tab=0) if loops else band
    return Horizontal(space, Vertical(along, near), column_shares=[3.0, 2.0])


def record_tendon(recorder: Recorder, run: SeenRun) -> None:
    """Record the tendon of one run, as one model or two see it, and when its fronts came through.

    Raises
    ------
    InputError
        A file cannot be read, or is not what it was.
    """
    tendons = tendons_of(run)
    if not tendons:
        return
    measured = run.measured(F_IN) if F_IN in run.file.names else None
    record_passages(recorder, run, tendons)
    record_scene(recorder, run.entity(*SPACE), tendons)
    record_along(recorder, run.entity(*ALONG), tendons)
    record_band(recorder, run.entity(*BAND), tendons, measured)


def record_passages(
    recorder: Recorder, run: SeenRun, tendons: Mapping[Which, TendonStates]
) -> None:
    """Record when the front of each stroke has reached the load, or that it never did."""
    for which, one in tendons.items():
        events = sorted(_events(run.id, which, one), key=lambda event: event.at_s)
        record_events(recorder, run, f"fronts-{which.key}", events)


def _events(run: str, which: Which, one: TendonStates) -> list[Event]:
    time_s, found = one.sample_time_s, []
    for passage, end in zip(one.passages, ends_of(one.passages, time_s.size - 1), strict=True):
        way = _WORDS[passage.direction]
        if passage.arrived is None:
            text = f"the slip front has not reached the load since the drive {way}"
            found.append(Event(float(time_s[end]), f"{run}: {which.label}: {text}"))
            continue
        took = float(time_s[passage.arrived] - time_s[passage.start])
        text = f"the slip front reaches the load, {took:.3g} s after the drive {way}"
        found.append(Event(float(time_s[passage.arrived]), f"{run}: {which.label}: {text}"))
    return found
