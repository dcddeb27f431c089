"""Each effect that gains: what it is, its equation, its parameters, its rivals, its gain.

A stand-in says what it does not prove.
"""

from collections.abc import Iterator, Mapping

from tsas_cli.records.base import Value
from tsas_cli.records.diagnosis import DiagnosisFile, NamedCause
from tsas_cli.reporting.content import Section, Table, anchor
from tsas_cli.reporting.diagnosis.words import EFFECT, heading_of, sentence_of, title_of, within
from tsas_cli.reporting.numbers import ABSENT, plain, with_interval


def parts(diagnosis: DiagnosisFile) -> Iterator[Section]:
    """Yield one part for each named cause, and one for each stand-in."""
    for cause in (*diagnosis.named, *diagnosis.stand_ins):
        law = EFFECT[cause.effect].equation if cause.effect in EFFECT else ""
        equation = cause.equation or law
        yield Section(
            anchor("diagnosis", cause.effect),
            f"Not proven: {within(heading_of(cause))}" if cause.failed else heading_of(cause),
            tuple(text for text in (sentence_of(cause.effect), *_failed(cause)) if text),
            equations=tuple(equation.split(",  ")) if equation else (),
            tables=(parameters_of(cause.effect, cause.parameters),),
            closing=(*_rivals(cause), *_gain(cause)),
        )


def parameters_of(effect: str, parameters: Mapping[str, Value]) -> Table:
    """Return the table of an effect's parameters, by name."""
    rows = tuple(
        (
            name,
            *with_interval(p.value, p.interval_low, p.interval_high),
            p.unit or ABSENT,
            "yes" if p.at_bound else "no",
        )
        for name, p in parameters.items()
    )
    header = ("parameter", "value", "95 % interval", "unit", "at its bound")
    return Table(f"Parameters of {effect}", header, rows, numeric=frozenset({1, 2}))


def _failed(cause: NamedCause) -> Iterator[str]:
    for failure in cause.failed:
        yield f"It {failure}."
    if cause.law_differs:
        yield f"Its law differs from this {cause.law_differs}."


def _rivals(cause: NamedCause) -> Iterator[str]:
    for rival in cause.rivals:
        yield (
            "In these recordings it is indistinguishable from "
            f"{within(title_of(rival))} (`{rival}`). {sentence_of(rival)}"
        )


def _gain(cause: NamedCause) -> Iterator[str]:
    if cause.gain_percent is None:
        return
    low, high = cause.gain_interval_percent or (None, None)
    gain, interval = with_interval(cause.gain_percent, low, high)
    if interval == ABSENT:
        gain, sure = plain(cause.gain_percent, 3), ""
    else:
        sure = f" (95 % interval {interval} %)"
    yield (
        f"On held-out data it takes {gain} %{sure} off the normalised residual, which averages "
        "noise over neighbouring samples."
    )
