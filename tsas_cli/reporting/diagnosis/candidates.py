"""Every hypothesis that was fitted, best first."""

from collections.abc import Sequence

from tsas_cli.records.diagnosis import DiagnosisFile, NamedCause, TriedHypothesis
from tsas_cli.reporting.content import Section, Table
from tsas_cli.reporting.numbers import fixed

_TITLE = "What was tried"
_SHOWN = 10  # and what is named, and its rivals
_WHAT = (
    "Each of these was fitted together with all parameters of the nominal model. Reduction: by how "
    "much the normalised residual on held-out data falls; what is named was fitted again for it. "
    "Test statistic: how many standard deviations the reduction is above what chance gives."
)


_NONE = "Screening left no effect that could explain enough of the error to be fitted."


def part(diagnosis: DiagnosisFile) -> Section | None:
    """Return the part, None where it was undecided before anything was tried."""
    tried = diagnosis.candidates
    if not tried:
        if diagnosis.verdict == "undecided":
            return None
        return Section("diagnosis-candidates", _TITLE, (_NONE,))
    standing = {frozenset(c.effects): _standing(c, diagnosis.named) for c in tried}
    shown = [c for place, c in enumerate(tried) if place < _SHOWN or standing[frozenset(c.effects)]]
    of = f", {len(shown)} of {len(tried)}, best first" if len(shown) < len(tried) else ""
    header = (
        "effects",
        "reduction [%]",
        "test statistic",
        "convincing",
        "remark",
    )
    table = Table(
        f"Hypotheses{of}",
        header,
        tuple(_row(c, standing[frozenset(c.effects)]) for c in shown),
        numeric=frozenset({1, 2}),
    ).without_empty()
    return Section("diagnosis-candidates", _TITLE, (_WHAT,), tables=(table,))


def _standing(candidate: TriedHypothesis, named: Sequence[NamedCause]) -> str:
    """Say whether a hypothesis is what is named, or has a rival in place of a cause."""
    causes = {cause.effect for cause in named}
    if not causes:
        return ""
    if set(candidate.effects) == causes:
        return "named"
    rivals = [causes - {c.effect} | {rival} for c in named for rival in c.rivals]
    return "rival" if set(candidate.effects) in rivals else ""


def _row(candidate: TriedHypothesis, standing: str) -> tuple[str, ...]:
    gain = candidate.gain_percent
    return (
        " + ".join(candidate.effects),
        "none" if gain is not None and gain < 0.0 else fixed(gain, 1),
        fixed(candidate.test_statistic, 1),
        "yes" if candidate.convincing else "no",
        standing if candidate.converged else "did not converge",
    )
