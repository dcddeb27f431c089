"""What the diagnosis says: the verdict, its causes, the evidence, and what to measure next."""

from collections.abc import Iterator
from dataclasses import replace

from tsas_cli.records.diagnosis import DiagnosisFile
from tsas_cli.reporting.content import Section, missing
from tsas_cli.reporting.diagnosis import candidates, causes, gains, maps, similarity
from tsas_cli.reporting.diagnosis.words import signal_in_words
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import fixed, plain
from tsas_cli.support.wording import listed

_TITLE = "Diagnosis"


def section(inputs: Inputs) -> Section:
    """Return the section of the diagnosis; its first sentence is the verdict."""
    diagnosis = inputs.get(DiagnosisFile)
    if diagnosis is None:
        return missing("diagnosis", _TITLE, what="diagnosis", stage="diagnose")
    evidence = (
        gains.part(diagnosis, inputs.held_out),
        *(part.part(diagnosis) for part in (maps, candidates, similarity)),
    )
    return Section(
        "diagnosis",
        _TITLE,
        (_verdict(diagnosis),),
        parts=(
            *causes.parts(diagnosis.named, inputs),
            *causes.law_parts(diagnosis, inputs),
            *causes.parts(diagnosis.stand_ins, inputs),
            *closing(diagnosis),
            *(replace(part, folded=True) for part in evidence if part is not None),
        ),
    )


def _verdict(diagnosis: DiagnosisFile) -> str:
    undecided = diagnosis.verdict == "undecided"
    return f"Undecided: {diagnosis.reason}" if undecided else diagnosis.reason


def closing(diagnosis: DiagnosisFile) -> Iterator[Section]:
    """Yield the parts that close the diagnosis; what is left stands first where it is unknown."""
    left = Section("diagnosis-remainder", "What is left", tuple(_left(diagnosis)))
    unknown = diagnosis.remainder.unexplained
    if unknown:
        yield left
    if diagnosis.next_experiment:
        yield Section("diagnosis-next", "Next experiment", (diagnosis.next_experiment,))
    if diagnosis.cannot_tell:
        yield Section("diagnosis-unknown", "Cannot tell", points=diagnosis.cannot_tell)
    if left.intro and not unknown:
        yield replace(left, folded=True)


def _left(diagnosis: DiagnosisFile) -> Iterator[str]:
    left = diagnosis.remainder
    if left.mean_square is not None:
        yield (
            f"The reduced chi-square of the remaining residual is {plain(left.mean_square, 3)}; "
            "1 is the noise level."
        )
    if diagnosis.named and left.share_percent is not None:
        share = fixed(left.share_percent, 0)
        yield f"Of what could be explained, {share} % is left after what is named."
    if left.unexplained:
        yield "There is structure in it that no effect of the catalogue accounts for."
    yield from (noise.text(name) for name, noise in left.slow_noise.items())
    if left.depends_on:
        signals = listed([signal_in_words(name) for name in left.depends_on])
        yield f"What is left depends on {signals}."
