"""How the dynamic chain fares on 2,000 rigs at random (tests/physics/lugre/random_rigs.py)."""

from collections.abc import Iterator
from multiprocessing import Pool

import numpy as np

from benchmarks.row import Row
from tests.physics.lugre.random_rigs import (
    TIGHT,
    USUAL,
    followed,
    is_unstable,
    largest_difference,
    random_case,
)

SETS = 2000
FIRST_SEED = 1000  # apart from those of the tests
COARSER = 2.5 * TIGHT  # a solution whose difference from the tight one says whether that is a limit
CONVERGED = 0.0025  # of a range


def measure() -> Iterator[Row]:
    """Follow each with the usual and a tight tolerance; count what went wrong."""
    with Pool() as pool:
        found = pool.map(fare, range(FIRST_SEED, FIRST_SEED + SETS), chunksize=20)
    finite, unstable, ended, known, off, rings = (
        np.array(column) for column in zip(*found, strict=True)
    )
    stable = ~unstable.astype(bool)
    known = known.astype(bool) & stable
    yield Row("rigs", SETS, "")
    yield Row("not finite", np.sum(~finite), "", at_most=0)
    yield Row("said to be unstable", np.sum(unstable), "")
    yield Row("of these, given up", np.sum(unstable & ~ended), "")
    yield Row("of the others, given up", np.sum(stable & ~ended), "")
    yield Row("with a limit to compare with", np.sum(known), "")
    yield Row(
        "of these, off by more than 1 % of a range", np.sum(known & (off > 0.01)), "", at_most=0
    )
    yield Row("the same without a mass at the load", np.sum(known & ~rings & (off > 0.01)), "")
    yield Row("largest difference of these", 100.0 * np.max(off[known & ~rings]), "%")
    yield Row("off by more than half", np.sum(known & (off > 0.5)), "", at_most=0)


def fare(seed: int) -> tuple[bool, bool, bool, bool, float, bool]:
    """Return whether finite, said to be unstable, ended, with a limit; how far off; if it rings."""
    case = random_case(seed)
    usual = followed(case, USUAL)
    finite, rings = (
        bool(np.all(np.isfinite(usual.columns))),
        case.rig.effects.load_inertia.mass_kg > 0.0,
    )
    if is_unstable(case):
        return finite, True, usual.finished, False, 0.0, rings
    tight, coarser = followed(case, TIGHT), followed(case, COARSER)
    known = tight.finished and coarser.finished
    known = known and largest_difference(coarser, tight) < CONVERGED
    return finite, False, usual.finished, known, largest_difference(usual, tight), rings
