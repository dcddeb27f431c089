"""What the colours in a plane stand for, written in its upper right corner."""

from collections.abc import Iterable

import numpy as np

from tsas_cli.reporting.stream.palette import colour
from tsas_cli.reporting.stream.plane import HEIGHT, WIDTH
from tsas_cli.reporting.stream.recorder import Recorder
from tsas_cli.reporting.stream.recorder.paths import Entity
from tsas_cli.reporting.which import Which

LINE = 0.09  # of the frame's height


def record_key(
    recorder: Recorder,
    entity: Entity,
    models: Iterable[Which],
    *,
    measured: bool = False,
) -> None:
    """Write the names of the models, and of what was measured, each in its colour."""
    named = [(which.key, which.label, which.role) for which in models]
    named += [("measured", "measured", "measured")] if measured else []
    for line, (key, label, role) in enumerate(named):
        place = np.array([[0.86 * WIDTH, -HEIGHT + LINE * line]])
        recorder.labels_2d([*entity, "key", key], place, [label], colour(role))
