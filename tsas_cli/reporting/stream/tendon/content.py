"""The tendon's part of the stream: in space, along the sheath, and the dead band from near."""

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from tsas_cli.reporting.stream.recorder import Clock, Recorder
from tsas_cli.reporting.stream.recorder.layout import Columns, Part, Rows
from tsas_cli.reporting.stream.recorder.paths import Entity
from tsas_cli.reporting.stream.tendon.along import record_along
from tsas_cli.reporting.stream.tendon.band import record_band
from tsas_cli.reporting.stream.tendon.scene import record_scene
from tsas_cli.reporting.tendon.followed import Followed, Which

Floats = npt.NDArray[np.float64]


def record_tendons(
    recorder: Recorder,
    entity: Entity,
    clock: Clock,
    tendons: Mapping[Which, Followed],
    f_in_N: Floats | None,
) -> Part:
    """Record the tendon of one run, as one model or two see it; return what shows it.

    `f_in_N` is the measured tension at the drive, shape (n,), NaN for gaps, or None.
    """
    space = record_scene(recorder, [*entity, "space"], clock, tendons)
    along = record_along(recorder, [*entity, "along"], clock, tendons)
    band = record_band(recorder, [*entity, "dead-band"], clock, tendons, f_in_N)
    beside = [along] if band is None else [along, band]
    return Columns([space, Rows(beside)], shares=[3.0, 2.0])
