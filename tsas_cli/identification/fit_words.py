"""What is said of a joint fit: which parameters are fixed and why, and what makes it unreliable."""

import math
from collections.abc import Mapping, Sequence

from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit import Fitted
from tsas_cli.identification.fit_problem import FitProblem
from tsas_cli.identification.model import Model
from tsas_cli.identification.quantities import QUANTITIES


def fixed_sentences(problem: FitProblem, confounded: Mapping[int, list[int]]) -> list[str]:
    """Say what is fixed and why, one sentence for each parameter and reason."""
    reasons: dict[tuple[str, str], list[str]] = {}
    for j, partners in confounded.items():
        unknown = problem.unknowns[j]
        names = sorted({problem.unknowns[p].name for p in partners})
        why = f"cannot be told apart from {' and '.join(names)}" if names else "does not show"
        reasons.setdefault((unknown.name, why), []).append(problem.owner(unknown) or "")
    return [
        f"{name} {why} in these recordings"
        f"{' (runs ' + ', '.join(owners) + ')' if any(owners) else ''}; "
        f"it is kept at {_fixed_value(problem.fixed, name, owners[0])}."
        for (name, why), owners in reasons.items()
    ]


def doubts_of(estimates: Sequence[Estimate], result: Fitted) -> list[str]:
    """Say what makes the fitted values unreliable."""
    names = {e: f"{e.name} of run {e.run}" if e.run else e.name for e in estimates}
    nothing = [e for e in estimates if e.at_bound and e.interval_low == QUANTITIES[e.name].default]
    out = [
        f"{names[e]} ended where it does nothing: at most {e.interval_high:.2g} {e.unit} would go "
        "unseen."
        for e in nothing
    ]
    out += [
        f"{names[e]} ended at the bound of what is plausible, {e.value:.5g}: it is not to be "
        "relied on."
        for e in estimates
        if e.at_bound and e not in nothing
    ]
    out += [
        f"{names[e]} does not show where the fit ended: its interval is all that is plausible."
        for e in estimates
        if e.stderr is None
    ]
    if not result.converged:
        out.append(
            f"The fit did not converge ({result.message.rstrip('.')}): its values are not to be "
            "relied on."
        )
    return out


def _fixed_value(fixed: Model, name: str, owner: str) -> str:
    value = fixed.value(name, owner or None)
    value = QUANTITIES[name].default if value is None else value
    unit = QUANTITIES[name].unit.removeprefix("1")
    return "its critical value" if math.isnan(value) else f"{value:.5g} {unit}".rstrip()
