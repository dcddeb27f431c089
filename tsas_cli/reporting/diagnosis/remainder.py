"""What is left, what to measure next, and what these recordings do not say."""

from collections.abc import Iterator

from tsas_cli.records.diagnosis import Diagnosis
from tsas_cli.reporting.content import Section
from tsas_cli.reporting.diagnosis.words import listed, signal_in_words
from tsas_cli.reporting.numbers import fixed, plain


def parts(diagnosis: Diagnosis) -> Iterator[Section]:
    """Yield the parts that close the diagnosis."""
    if left := tuple(_left(diagnosis)):
        yield Section("diagnosis-remainder", "What is left", left)
    if diagnosis.next_experiment:
        yield Section("diagnosis-next", "Next experiment", (diagnosis.next_experiment,))
    if diagnosis.cannot_tell:
        yield Section("diagnosis-unknown", "Cannot tell", points=diagnosis.cannot_tell)


def _left(diagnosis: Diagnosis) -> Iterator[str]:
    left = diagnosis.remainder
    if left.mean_square is not None:
        yield (
            f"The errors that are left have {plain(left.mean_square, 3)} times the mean square "
            "that noise explains; 1 is nothing but noise."
        )
    if diagnosis.named and left.share_percent is not None:
        share = fixed(left.share_percent, 0)
        yield f"Of what was beyond the noise, {share} % is left after what is named."
    if left.unexplained:
        yield "There is structure in them that no effect of the catalogue accounts for."
    if left.depends_on:
        signals = listed([signal_in_words(name) for name in left.depends_on])
        yield f"What is left depends on {signals}."
