"""The tendon's part of the stream: in space, along the sheath, and the dead band from near."""

from tsas_cli.reporting.stream.portraits import view_of
from tsas_cli.reporting.stream.recorder import Recorder
from tsas_cli.reporting.stream.recorder.layout import Columns, Part, Rows, Tabs
from tsas_cli.reporting.stream.seen import SeenRun
from tsas_cli.reporting.stream.tendon.along import record_along
from tsas_cli.reporting.stream.tendon.band import record_band
from tsas_cli.reporting.stream.tendon.fronts import record_passages
from tsas_cli.reporting.stream.tendon.scene import record_scene
from tsas_cli.reporting.stream.tendon.told import F_IN, tendons_of


def record_tendon(recorder: Recorder, run: SeenRun) -> Part | None:
    """Record the tendon of one run, as one model or two see it; return what shows it.

    None where no stage tells a model of it, or only the lumped one, which does not say what is
    along the tendon.

    Raises
    ------
    InputError
        A file cannot be read, or is not what it was.
    """
    tendons = tendons_of(run)
    if not tendons:
        return None
    entity, clock = run.entity("tendon"), run.clock
    record_passages(recorder, run, tendons)
    space = record_scene(recorder, [*entity, "space"], clock, tendons)
    along = record_along(recorder, [*entity, "along"], clock, tendons)
    measured = run.measured(F_IN) if F_IN in run.file.names else None
    band = record_band(recorder, [*entity, "dead-band"], clock, tendons, measured)
    near: list[Part] = [] if band is None else [band]
    near += [view_of(run, channel) for channel in run.loops if channel.column == F_IN]
    beside: list[Part] = [along, Tabs(near)] if near else [along]
    return Columns([space, Rows(beside)], shares=[3.0, 2.0])
