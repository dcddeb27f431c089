"""Confidence intervals for coloured residuals.

A residual of a physical model is autocorrelated; the plain formula counts each sample as
independent, and its intervals are far too narrow. Here the unit of evidence is a block longer than
the autocorrelation time: the jackknife that leaves out one block at a time (CR3 of Bell and
McCaffrey 2002), valid also where few blocks carry most of the information, and Student's t with
the degrees of freedom of the blocks.
"""

import math
from collections.abc import Sequence

import numpy as np

from tsas_cli.support.arrays import Floats, Indices

FEWEST_BLOCKS = 8
MEMORIES_PER_BLOCK = 4.0
DETERMINED = 1e-4  # least singular value of columns of length one: their differences' accuracy


def autocovariance(values: Floats) -> Floats:
    """Return the sums of the products of values, less their mean, at lags 0 to n − 1."""
    power = np.abs(np.fft.rfft(values - values.mean(), 2 * values.size)) ** 2
    return np.asarray(np.fft.irfft(power)[: values.size])


def memory(residual: Floats) -> float:
    """Return the integrated autocorrelation time of a residual in samples, at least 1.

    The sum of the autocorrelation is truncated where it is first lost in its own scatter (Geyer's
    initial positive sequence).
    """
    n, covariance = residual.size, autocovariance(residual)
    if n < 4 or covariance[0] <= 0.0:
        return 1.0
    pairs = (covariance[0 : n - 1 : 2] + covariance[1:n:2]) / covariance[0]
    negative = np.flatnonzero(pairs <= 0.0)
    end = int(negative[0]) if negative.size else pairs.size
    return max(1.0, float(2.0 * pairs[:end].sum() - 1.0))


def block_length(residuals: list[Floats]) -> int:
    """Return a block length in samples for residuals that share one clock.

    It is some autocorrelation times long, but leaves a minimum number of blocks.
    """
    longest = max(memory(r) for r in residuals)
    samples = sum(r.size for r in residuals)
    return max(1, min(math.ceil(MEMORIES_PER_BLOCK * longest), samples // FEWEST_BLOCKS))


def block_numbers(sizes: list[int], length: int) -> Indices:
    """Return block numbers, counted on from piece to piece; a block lies within one piece."""
    out: list[Indices] = []
    start = 0
    for size in sizes:
        count = max(1, round(size / length))
        out.append(start + np.arange(size) * count // size)
        start += count
    return np.concatenate(out)


def numbered_on(blocks: Sequence[Indices]) -> Indices:
    """Return the block numbers of all runs, each counted from 0, counted on from run to run."""
    offsets = np.cumsum([0, *(block.max() + 1 for block in blocks[:-1])])
    return np.concatenate([block + k for block, k in zip(blocks, offsets, strict=True)])


def inverse_gram(jacobian: Floats) -> Floats:
    """Return (J'J)⁻¹ of a Jacobian J, shape (p, p), without directions that it does not determine.

    In two parameters whose sum alone shows, all but the sum is an error of finite differences.
    """
    lengths = np.linalg.norm(jacobian, axis=0)
    lengths[lengths == 0.0] = 1.0
    scaled = jacobian / lengths
    inverse = np.linalg.pinv(scaled.T @ scaled, rcond=DETERMINED**2, hermitian=True)
    return np.asarray(inverse / np.outer(lengths, lengths))


def jackknife(jacobian: Floats, residual: Floats, block: Indices) -> tuple[Floats, Floats]:
    """Return the covariance of least-squares parameters and Student's t for 95 % intervals.

    Each parameter has its own t, shape (p,): the fewer blocks determine it, the larger. Jacobian
    and residual are weighted, shapes (n, p) and (n,); `block` is the number of each row's block,
    shape (n,), counted from 0.
    """
    from scipy.special import stdtrit  # a fifth of the time that scipy.stats takes to load

    p = jacobian.shape[1]
    bread = inverse_gram(jacobian)
    order = np.argsort(block, kind="stable")
    starts = np.flatnonzero(np.diff(block[order], prepend=-1))
    scores = np.add.reduceat((jacobian * residual[:, None])[order], starts)
    grams = np.array([part.T @ part for part in np.split(jacobian[order], starts[1:])])
    # Shift of the estimates when the block is left out: its score, magnified by its leverage.
    own = np.eye(p) - grams @ bread
    magnified = (np.linalg.pinv(own, rcond=1e-9) @ scores[:, :, None])[:, :, 0]
    moves = magnified @ bread
    moves -= moves.mean(axis=0)
    blocks = starts.size
    covariance: Floats = (blocks - 1) / blocks * moves.T @ moves
    # Satterthwaite's degrees of freedom from the blocks' shifts; a normal shift has a fourth moment
    # of 3. They are fewer than the blocks that shift the parameter at all.
    squares = np.maximum(moves**2, 1e-150)
    freedom = 3.0 * squares.sum(axis=0) ** 2 / np.sum(squares**2, axis=0)
    moving = np.sum(squares > 1e-6 * squares.max(axis=0), axis=0)
    return covariance, stdtrit(np.clip(freedom, 1.0, np.maximum(moving - 1, 1)), 0.975)
