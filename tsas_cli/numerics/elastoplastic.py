"""An elastoplastic element: it follows up to a limit and yields beyond it (Prandtl)."""

from tsas_cli.numerics.compiled import kernel


@kernel
def yielded(before: float, rise: float, limit: float) -> float:
    """Return the state after a rise of its input from a state, within ±limit."""
    return min(max(before + rise, -limit), limit)
