"""The laws of unnamed origin: what each says, its curves, its parameters."""

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from tsas_cli.records.diagnosis import DescribedLaw, DiagnosisFile
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.content import Section, anchor
from tsas_cli.reporting.diagnosis.causes import parameters_of
from tsas_cli.reporting.diagnosis.words import within
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import plain
from tsas_cli.support.wording import listed

Numbers = tuple[float, ...]


def parts(diagnosis: DiagnosisFile, inputs: Inputs) -> Iterator[Section]:
    """Yield a part for each law, and its parameters, folded."""
    for law in diagnosis.laws:
        rivals = f" As good are: {listed(law.rivals)}." if law.rivals else ""
        yield Section(
            anchor("diagnosis", law.law),
            law.title,
            (law.sentence, f"It describes what no proven cause explains; it is no cause.{rivals}"),
            equations=(law.equation,),
            pictures=(
                picture(
                    partial(_draw, law=law),
                    key=law.law,
                    alt=law.sentence,
                    caption="After a reversal, at the mean tension; and along the stroke. "
                    "Bands: 95 % intervals.",
                ),
            ),
            closing=(
                (
                    f"On held-out data the RMS of {law.channel} falls from "
                    f"{plain(law.rmse_before, 3)} to {plain(law.rmse_after, 3)} {law.unit}."
                ),
            ),
        )
        yield Section(
            anchor("parameters", law.law),
            f"Parameters: {within(law.title)}",
            points=tuple(parameters_of(law.parameters, inputs)),
            folded=True,
        )


def _draw(figure: Any, law: DescribedLaw) -> None:
    left, right = figure.subplots(1, 2)
    _with_band(left, law.travel_mm, law.after_reversal, law.after_reversal_margin)
    left.set(xlabel="travel since reversal [mm]", ylabel=law.what)
    left.set_xlim(0.0, max(law.travel_mm))
    _with_band(right, law.place_mm, law.along_stroke, law.along_stroke_margin, marker="o")
    right.set_xlabel("displacement [mm]")


def _with_band(axes: Any, x: Numbers, y: Numbers, margin: Numbers, marker: str = "") -> None:
    """Draw a curve with its 95 % interval; older files have none."""
    axes.plot(x, y, color=STAND_IN["after"], marker=marker, markersize=3.0)
    if margin:
        low, high = np.subtract(y, margin), np.add(y, margin)
        axes.fill_between(x, low, high, color=STAND_IN["after"], alpha=0.2, linewidth=0.0)
