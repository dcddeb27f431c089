"""The residual on held-out data before and after, beside what noise and the best model leave."""

from collections.abc import Mapping
from functools import partial
from typing import Any

from tsas_cli.records.diagnosis import DiagnosisFile, HeldOut
from tsas_cli.reporting.channels import called
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.content import Section, Table
from tsas_cli.reporting.drawing import legend, picture
from tsas_cli.reporting.numbers import ABSENT, plain

_BOUNDS = (
    "Normalised: over the noise level, which is then 1. Attainable is what a flexible regression "
    "on the recorded signals leaves, whatever the cause."
)


def part(diagnosis: DiagnosisFile, channels: Mapping[str, HeldOut]) -> Section | None:
    """Return the part, None where no channel was judged."""
    if not channels:
        return None
    named = diagnosis.extended
    alt = "; ".join(_in_words(name, c, named=named) for name, c in channels.items())
    shown = picture(
        partial(draw_gains, channels=channels, named=named),
        key="diagnosis-gains",
        alt=f"RMS of the residual on held-out data. {alt}.",
        caption="RMS of the residual on held-out data, by channel.",
        height_in=0.6 + 0.75 * len(channels),
    )
    return Section(
        "diagnosis-gains",
        "Residual on held-out data",
        tuple(text for text in (_judged(diagnosis), _BOUNDS) if text),
        tables=(table(channels, named=named),),
        pictures=(shown,),
    )


def _judged(diagnosis: DiagnosisFile) -> str:
    how = diagnosis.evidence.sentence
    return how[:1].upper() + how[1:]


def table(channels: Mapping[str, HeldOut], *, named: bool) -> Table:
    """Return the residuals in numbers, in the channel's unit and over its noise level."""
    rows = tuple(
        (
            name,
            plain(c.rmse_before, 3),
            plain(c.rmse_after, 3) if named else ABSENT,
            plain(c.attainable, 3),
            plain(c.noise_floor, 3),
            c.unit,
            _normalised(c.rmse_before, c),
            _normalised(c.rmse_after, c) if named else ABSENT,
        )
        for name, c in channels.items()
    )
    header = (
        "channel",
        "nominal model",
        "extended model",
        "attainable",
        "noise level",
        "unit",
        "nominal, normalised",
        "extended, normalised",
    )
    caption = "RMS of the residual on held-out data"
    numeric = frozenset({1, 2, 3, 4, 6, 7})
    return Table(caption, header, rows, numeric=numeric).without_empty()


def _normalised(rms: float | None, channel: HeldOut) -> str:
    return ABSENT if rms is None or not channel.noise_floor else plain(rms / channel.noise_floor, 3)


def _in_words(name: str, channel: HeldOut, *, named: bool) -> str:
    after = f", extended model {plain(channel.rmse_after, 3)}" if named else ""
    return (
        f"{called(name)}: nominal model {plain(channel.rmse_before, 3)}"
        f"{after}, attainable {plain(channel.attainable, 3)}, noise level "
        f"{plain(channel.noise_floor, 3)} {channel.unit}"
    )


def draw_gains(figure: Any, channels: Mapping[str, HeldOut], *, named: bool) -> None:
    """Draw the channels below each other, each with an axis of its own from zero.

    With `named` a cause is named, so that there is an error after to show.
    """
    rows = figure.subplots(len(channels), 1, squeeze=False)[:, 0]
    for axes, (name, channel) in zip(rows, channels.items(), strict=True):
        _bar(axes, channel.rmse_before, at=0.2 * named, role="before", label="nominal model")
        if named:
            _bar(axes, channel.rmse_after, at=-0.2, role="after", label="extended model")
        _mark(axes, channel.noise_floor, linestyle="-", label="noise level")
        _mark(axes, channel.attainable, linestyle=(0, (2, 1.5)), label="attainable")
        axes.set(ylim=(-0.5, 0.5), yticks=[], xlim=(0, None))
        axes.set_ylabel(
            f"{name.rsplit('_', 1)[0]} [{channel.unit}]", rotation=0, ha="right", va="center"
        )
        axes.spines["left"].set_visible(False)
    legend(figure, rows[0])


def _bar(axes: Any, value: float | None, *, at: float, role: str, label: str) -> None:
    if value is not None:
        axes.barh(at, value, 0.36, color=STAND_IN[role], label=label)


def _mark(axes: Any, value: float | None, **style: Any) -> None:
    if value is not None:
        axes.plot([value, value], [-0.5, 0.5], color=STAND_IN["ink"], linewidth=1.6, **style)
