"""What the diagnosis says: the verdict, its causes, the evidence, and what to measure next."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from tsas_cli.records.diagnosis import DiagnosisFile, HeldOut, NamedCause, TriedHypothesis
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.content import Section, Table, missing, table_by_column, table_of
from tsas_cli.reporting.diagnosis import causes, maps, similarity
from tsas_cli.reporting.drawing import legend, picture, stacked
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.names import in_words, quantity_of
from tsas_cli.reporting.numbers import ABSENT, fixed, over, plain

_NORMALISED = "Normalised: over the noise level, which is then 1. "
_ATTAINABLE = (
    "Attainable is what a flexible regression on the recorded signals leaves, whatever the cause; "
    "a dash where that is no less."
)
_NO_LESS = "A flexible regression on the recorded signals leaves no less."
_LEAD = 2  # sentences of a verdict above its list; one more is a paragraph with them
_TRIED = "What was tried"
_SHOWN = 10  # and what is named, and its rivals
_HYPOTHESES = (
    "Each of these was fitted together with all parameters of the nominal model. Reduction: by how "
    "much the normalised residual on held-out data falls; figures above are of a further fit. "
    "Test statistic: how many standard deviations the reduction is above what chance gives."
)
_NOTHING_TRIED = "Screening left no effect that could explain enough of the error to be fitted."
_TITLE = "Diagnosis"


def section(inputs: Inputs) -> Section:
    """Return the section of the diagnosis; its first sentence is the verdict."""
    diagnosis = inputs.get(DiagnosisFile)
    if diagnosis is None:
        return missing("diagnosis", _TITLE, what="diagnosis", stage="diagnose")
    sentences = re.split(r"(?<=\.) (?=[A-Z])", diagnosis.reason)
    above = _LEAD if len(sentences) > _LEAD + 1 else len(sentences)
    lead = " ".join(sentences[:above])
    evidence = (
        gains_part(diagnosis, inputs.held_out),
        maps.part(diagnosis),
        candidates_part(diagnosis),
        similarity.part(diagnosis),
    )
    return Section(
        "diagnosis",
        _TITLE,
        (f"Undecided: {lead}" if diagnosis.verdict == "undecided" else lead,),
        points=tuple(sentences[above:]),
        parts=(
            *causes.parts(diagnosis.named, inputs),
            *causes.law_parts(diagnosis, inputs),
            *causes.parts(diagnosis.stand_ins, inputs, reason=diagnosis.reason),
            *closing(diagnosis),
            *(replace(part, folded=True) for part in evidence if part is not None),
        ),
    )


def closing(diagnosis: DiagnosisFile) -> Iterator[Section]:
    """Yield the parts that close the diagnosis."""
    if diagnosis.cannot_tell:
        yield Section("diagnosis-unknown", "Cannot tell", points=diagnosis.cannot_tell)
    if left := tuple(_left(diagnosis)):
        yield Section("diagnosis-remainder", "What is left", left, folded=True)


def _left(diagnosis: DiagnosisFile) -> Iterator[str]:
    left = diagnosis.remainder
    if left.mean_square is not None:
        yield (
            f"The reduced chi-square of the remaining residual is {plain(left.mean_square, 3)}; "
            "1 is the noise level."
        )
    if diagnosis.named and left.share_percent is not None:
        share = fixed(left.share_percent, 0)
        yield (
            "Of what a regression on the recorded signals explains of the nominal model's "
            f"residual, {share} % is left after what is named."
        )
    yield from (noise.text(name) for name, noise in left.slow_noise.items())


def candidates_part(diagnosis: DiagnosisFile) -> Section | None:
    """Return the part, None where it was undecided before anything was tried."""
    tried = diagnosis.candidates
    if not tried:
        if diagnosis.verdict == "undecided":
            return None
        return Section("diagnosis-candidates", _TRIED, (_NOTHING_TRIED,))
    standing = {frozenset(c.effects): _standing(c, diagnosis.named) for c in tried}
    shown = [c for place, c in enumerate(tried) if place < _SHOWN or standing[frozenset(c.effects)]]
    caption = "Hypotheses"
    if len(shown) < len(tried):
        caption += f", {len(shown)} of {len(tried)}, best first"
    header = ("effects", "reduction [%]", "test statistic", "convincing", "remark")
    rows = [
        (
            " + ".join(c.effects),
            "none"
            if c.gain_percent is not None and c.gain_percent < 0.0
            else fixed(c.gain_percent, 1),
            fixed(c.test_statistic, 1),
            "yes" if c.convincing else "no",
            standing[frozenset(c.effects)] if c.converged else "did not converge",
        )
        for c in shown
    ]
    table = table_of(caption, header, rows)
    return Section("diagnosis-candidates", _TRIED, (_HYPOTHESES,), tables=(table,))


def _standing(candidate: TriedHypothesis, named: Sequence[NamedCause]) -> str:
    """Say whether a hypothesis is what is named, or has a rival in place of a cause."""
    causes = {cause.effect for cause in named}
    if not causes:
        return ""
    if set(candidate.effects) == causes:
        return "named"
    rivals = [causes - {c.effect} | {rival} for c in named for rival in c.rivals]
    return "rival" if set(candidate.effects) in rivals else ""


def gains_part(diagnosis: DiagnosisFile, channels: Mapping[str, HeldOut]) -> Section | None:
    """Return the part, None where no channel was judged."""
    if not channels:
        return None
    named, how = diagnosis.extended, diagnosis.evidence.sentence
    less = any(c.less_attainable for c in channels.values())
    alt = "; ".join(
        f"{in_words(name)}: nominal model {plain(c.rmse_before, 3)}"
        + (f", extended model {plain(c.rmse_after, 3)}" if named else "")
        + (f", attainable {plain(c.attainable, 3)}" if c.less_attainable else "")
        + f", noise level {plain(c.noise_floor, 3)} {c.unit}"
        for name, c in channels.items()
    )
    shown = picture(
        partial(draw_gains, channels=channels, named=named),
        key="diagnosis-gains",
        alt=f"RMS of the residual on held-out data. {alt}.",
        caption="RMS of the residual on held-out data, by channel.",
        height_in=0.6 + 0.75 * len(channels),
    )
    bounds = _NORMALISED + (_ATTAINABLE if less else _NO_LESS)
    return Section(
        "diagnosis-gains",
        "Residual on held-out data",
        tuple(filter(None, (how[:1].upper() + how[1:], bounds))),
        tables=(gains_table(channels, named=named),),
        pictures=(shown,),
    )


def gains_table(channels: Mapping[str, HeldOut], *, named: bool) -> Table:
    """Return the residuals in numbers, in the channel's unit and over its noise level."""
    rows = (
        {
            "channel": name,
            "nominal model": plain(c.rmse_before, 3),
            "extended model": plain(c.rmse_after, 3) if named else ABSENT,
            "attainable": plain(c.attainable, 3) if c.less_attainable else ABSENT,
            "noise level": plain(c.noise_floor, 3),
            "unit": c.unit,
            "nominal, normalised": over(c.rmse_before, c.noise_floor),
            "extended, normalised": over(c.rmse_after, c.noise_floor) if named else ABSENT,
        }
        for name, c in channels.items()
    )
    return table_by_column("RMS of the residual on held-out data", rows)


def draw_gains(figure: Any, channels: Mapping[str, HeldOut], *, named: bool) -> None:
    """Draw the channels below each other, each with an axis of its own from zero.

    With `named` a cause is named, so that there is an error after to show.
    """
    rows = stacked(figure, len(channels))
    for axes, (name, channel) in zip(rows, channels.items(), strict=True):
        _bar(axes, channel.rmse_before, at=0.2 * named, role="before", label="nominal model")
        if named:
            _bar(axes, channel.rmse_after, at=-0.2, role="after", label="extended model")
        _mark(axes, channel.noise_floor, linestyle="-", label="noise level")
        if channel.less_attainable:
            _mark(axes, channel.attainable, linestyle=(0, (2, 1.5)), label="attainable")
        axes.set(ylim=(-0.5, 0.5), yticks=[], xlim=(0, None))
        label = f"{quantity_of(name)} [{channel.unit}]"
        axes.set_ylabel(label, rotation=0, ha="right", va="center")
        axes.spines["left"].set_visible(False)
    legend(figure, rows[0])


def _bar(axes: Any, value: float | None, *, at: float, role: str, label: str) -> None:
    if value is not None:
        axes.barh(at, value, 0.36, color=STAND_IN[role], label=label)


def _mark(axes: Any, value: float | None, **style: Any) -> None:
    if value is not None:
        axes.plot([value, value], [-0.5, 0.5], color=STAND_IN["ink"], linewidth=1.6, **style)
