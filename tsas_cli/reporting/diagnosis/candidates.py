"""Every hypothesis that was fitted, best first."""

from tsas_cli.reporting.content import Section, Table
from tsas_cli.reporting.numbers import fixed, plain
from tsas_cli.reporting.stage_files import Candidate, Diagnosis

_SHOWN = 10
_WHAT = (
    "Each of these was fitted together with all parameters of the nominal model. Gain: by how "
    "much the root mean square error on held-out data falls. Sureness: how many standard "
    "deviations the gain is above what chance gives, over all blocks."
)


def part(diagnosis: Diagnosis) -> Section | None:
    """Return the part, None where nothing was fitted."""
    tried = diagnosis.candidates
    if not tried:
        return None
    of = f", the best {_SHOWN} of {len(tried)}" if len(tried) > _SHOWN else ""
    header = ("effects", "gain [%]", "sureness", "convincing", "mean square / noise", "fit")
    table = Table(
        f"Hypotheses{of}",
        header,
        tuple(_row(candidate) for candidate in tried[:_SHOWN]),
        numeric=frozenset({1, 2, 4}),
    ).without_empty()
    return Section("diagnosis-candidates", "What was tried", (_WHAT,), tables=(table,))


def _row(candidate: Candidate) -> tuple[str, ...]:
    return (
        " + ".join(candidate.effects),
        fixed(candidate.gain_percent, 1),
        fixed(candidate.sureness, 1),
        "yes" if candidate.convincing else "no",
        plain(candidate.mean_square, 3),
        "" if candidate.converged else "did not converge",
    )
