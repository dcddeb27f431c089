"""Notes on a joint fit: fixed parameters with the reason, and unreliable estimates."""

import math
from collections.abc import Mapping, Sequence

from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit import Fitted
from tsas_cli.identification.fit_problem import FitProblem
from tsas_cli.identification.model import Model
from tsas_cli.identification.quantities import QUANTITIES


def fixed_sentences(problem: FitProblem, confounded: Mapping[int, list[int]]) -> list[str]:
    """Return a sentence for each fixed parameter and reason."""
    reasons: dict[tuple[str, str], list[str]] = {}
    for j, partners in confounded.items():
        unknown = problem.unknowns[j]
        names = sorted({problem.unknowns[p].name for p in partners})
        together = f" together with {' and '.join(names)}" if names else ""
        reasons.setdefault((unknown.name, together), []).append(problem.owner(unknown) or "")
    return [
        f"{name} is not identifiable{together} from these recordings"
        f"{' (runs ' + ', '.join(owners) + ')' if any(owners) else ''}; "
        f"it is fixed at {_fixed_value(problem.fixed, name, owners[0])}."
        for (name, together), owners in reasons.items()
    ]


def doubts_of(estimates: Sequence[Estimate], result: Fitted) -> list[str]:
    """Return a sentence for each reason why estimates are unreliable."""
    names = {e: f"{e.name} of run {e.run}" if e.run else e.name for e in estimates}
    neutral = [e for e in estimates if e.at_bound and e.interval_low == QUANTITIES[e.name].default]
    notes = [
        f"{names[e]} converged to zero: values up to {e.interval_high:.2g} {e.unit} are not "
        "excluded."
        for e in neutral
    ]
    notes += [
        f"{names[e]} converged to its plausible bound, {e.value:.5g}: the estimate is unreliable."
        for e in estimates
        if e.at_bound and e not in neutral
    ]
    notes += [
        f"{names[e]} is not identifiable at the minimum: its interval is the plausible range."
        for e in estimates
        if e.stderr is None
    ]
    if not result.converged:
        notes.append(
            f"The fit did not converge ({result.message.rstrip('.')}): its estimates are "
            "unreliable."
        )
    return notes


def _fixed_value(fixed: Model, name: str, owner: str) -> str:
    value = fixed.value(name, owner or None)
    value = QUANTITIES[name].default if value is None else value
    unit = QUANTITIES[name].unit.removeprefix("1")
    return "its critical value" if math.isnan(value) else f"{value:.5g} {unit}".rstrip()
