"""What a fit does not say of its parameters, in sentences."""

import math
from collections.abc import Iterator, Mapping, Sequence

from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit import Fitted
from tsas_cli.identification.fit_problem import FitProblem
from tsas_cli.identification.model import Model
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.support.wording import listed

FEW = 3  # runs that a sentence names


def fixed_sentences(problem: FitProblem, confounded: Mapping[int, list[int]]) -> list[str]:
    """Return a sentence for each parameter that is fixed, alone or because of others."""
    owners: dict[tuple[str, bool], list[str]] = {}
    others: dict[str, set[str]] = {}
    for j, partners in confounded.items():
        unknown = problem.unknowns[j]
        owners.setdefault((unknown.name, bool(partners)), []).append(problem.owner(unknown) or "")
        names = {problem.unknowns[p].name for p in partners}
        others.setdefault(unknown.name, set()).update(
            f"{n} of other runs" if n == unknown.name else n for n in names
        )
    out = []
    for (name, confounds), of in owners.items():
        together = f" together with {listed(sorted(others[name]))}" if confounds else ""
        out.append(
            f"{name} is not identifiable{together} from these recordings"
            f"{_where(of, len(problem.runs))}; "
            f"it is fixed at {_fixed_value(problem.fixed, name, of[0])}."
        )
    return out


def _where(owners: Sequence[str], runs: int) -> str:
    """Return which of the runs something is said of, nothing where it is all of them."""
    if not any(owners) or len(owners) == runs:
        return ""
    few = len(owners) <= FEW
    return f" (runs {', '.join(owners)})" if few else f" ({len(owners)} of {runs} runs)"


def doubts_of(estimates: Sequence[Estimate], result: Fitted) -> list[str]:
    """Return a sentence for each reason why estimates are unreliable."""
    neutral = [e for e in estimates if e.at_bound and e.interval_low == QUANTITIES[e.name].default]
    bound = [e for e in estimates if e.at_bound and e not in neutral]
    wide = [e for e in estimates if e.stderr is None or _is_whole_range(e)]
    notes = [
        f"{name} converged to zero: values up to {max(e.interval_high or 0.0 for e in of):.2g} "
        f"{of[0].unit} are not excluded."
        for name, of in _named(neutral)
    ]
    notes += [
        f"{name} converged to its plausible bound, "
        f"{' or '.join(dict.fromkeys(f'{e.value:.5g}' for e in of))}: the estimate is unreliable."
        for name, of in _named(bound)
    ]
    notes += [
        f"{name} is not identifiable at the minimum: its interval is the plausible range."
        for name, _ in _named(wide)
    ]
    if not result.converged:
        notes.append(
            f"The fit did not converge ({result.message.rstrip('.')}): its estimates are "
            "unreliable."
        )
    return notes


def _named(estimates: Sequence[Estimate]) -> Iterator[tuple[str, list[Estimate]]]:
    """Yield estimates with their name and run; together where a parameter has many runs."""
    of_names: dict[str, list[Estimate]] = {}
    for e in estimates:
        of_names.setdefault(e.name, []).append(e)
    for name, of in of_names.items():
        if len(of) > FEW:
            yield f"{name} of {len(of)} runs", of
        else:
            yield from ((f"{name} of run {e.run}" if e.run else name, [e]) for e in of)


def _is_whole_range(estimate: Estimate) -> bool:
    """Return whether an interval goes from one plausible bound to the other."""
    quantity, low, high = QUANTITIES[estimate.name], estimate.interval_low, estimate.interval_high
    if low is None or high is None:
        return False
    return math.isclose(low, quantity.lower) and math.isclose(high, quantity.upper)


def _fixed_value(fixed: Model, name: str, owner: str) -> str:
    value = fixed.value(name, owner or None)
    value = QUANTITIES[name].default if value is None else value
    unit = QUANTITIES[name].unit.removeprefix("1")
    return "its critical value" if math.isnan(value) else f"{value:.5g} {unit}".rstrip()
