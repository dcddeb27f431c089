"""Which effects these inputs can and cannot tell apart, before any is fitted."""

from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from tsas_cli.records.diagnosis import DiagnosisFile
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.content import Section
from tsas_cli.reporting.drawing import WIDTH_IN, legend, picture
from tsas_cli.reporting.numbers import fixed
from tsas_cli.support.arrays import Floats
from tsas_cli.support.wording import listed

_ALIKE = 0.95  # less than a third of one is then left that the other cannot imitate
_RESEMBLES = 0.5
_VISIBLE = 5.0  # standard deviations of noise
_WHAT = (
    "What an effect would do to the channels, less what the nominal parameters can do, is its "
    f"signature. Two signatures are alike by 0 to 1; at {_ALIKE} and above less than a third of "
    "one is left that the other cannot imitate, and the effects are hard to tell apart."
)
_FAINT = 0.2  # below it a square is too small to see
_ROW_IN = 0.21
_NAMES_IN = 2.0  # of the longest name
_CORNERS = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5)])


def part(diagnosis: DiagnosisFile) -> Section | None:
    """Return the part, None where no signatures were compared."""
    from scipy.cluster.hierarchy import leaves_list, linkage

    names = np.array(diagnosis.signatures.effects, dtype=object)
    if names.size < 2:
        return None
    similarity = np.array(diagnosis.signatures.similarity, dtype=float)
    visible = np.array(diagnosis.signatures.visible, dtype=float) >= _VISIBLE
    hidden = listed([f"`{name}`" for name in names[~visible]])
    others = np.where(np.eye(names.size) > 0.0, 0.0, similarity)
    points = (
        *_alike(names[visible], similarity[np.ix_(visible, visible)]),
        *([f"These inputs hardly show {hidden} at a size that is plausible."] if hidden else []),
    )
    shown = visible & (others[:, visible] >= _RESEMBLES).any(axis=1)
    title = "Which effects these inputs can tell apart"
    if shown.sum() < 2:
        alone = "No two effects that these inputs show resemble each other."
        return Section("diagnosis-similarity", title, (_WHAT, alone), points=points)
    # Effects that look alike stand together.
    near = linkage(_apart(similarity[np.ix_(shown, shown)]), "average")
    order = np.flatnonzero(shown)[leaves_list(near)]
    matrix = picture(
        partial(
            draw_similarity,
            effects=tuple(names[order]),
            similarity=similarity[np.ix_(order, order)],
            alike=_ALIKE,
        ),
        key="diagnosis-similarity",
        alt=f"Similarity of the signatures of {', '.join(names[order])}. "
        + (" ".join(points) or "No two are alike."),
        caption="Similarity of each two signatures, as the size of the block. Effects that "
        f"resemble no other by {_RESEMBLES} are left out.",
        height_in=0.5 + _ROW_IN * int(shown.sum()),
    )
    return Section("diagnosis-similarity", title, (_WHAT,), points=points, pictures=(matrix,))


def _alike(names: npt.NDArray[np.object_], similarity: Floats) -> Iterator[str]:
    """Yield a sentence for each group in which all look alike."""
    from scipy.cluster.hierarchy import fcluster, linkage

    if names.size < 2:
        return
    groups = fcluster(linkage(_apart(similarity), "complete"), 1.0 - _ALIKE, "distance")
    for number in dict.fromkeys(groups):
        inside = np.flatnonzero(groups == number)
        if inside.size > 1:
            pairs = similarity[np.ix_(inside, inside)][np.triu_indices(inside.size, 1)]
            group = listed([f"`{name}`" for name in names[inside]])
            lowest = fixed(float(pairs.min()), 2)
            least = "at least " if inside.size > 2 and lowest != fixed(1.0, 2) else ""
            yield f"{group} are hard to tell apart here (similarity {least}{lowest})."


def _apart(similarity: Floats) -> Floats:
    """Return the distances above the diagonal, row by row, as scipy's clustering takes them."""
    return 1.0 - similarity[np.triu_indices(len(similarity), 1)]


def draw_similarity(
    figure: Any, effects: Sequence[str], similarity: Floats, *, alike: float
) -> None:
    """Draw a square for each two effects, its side the similarity.

    Of `similarity`, from 0 to 1, shape (n, n), only what is below the diagonal is read; from
    `alike` on a square is in the loud colour.
    """
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    axes = figure.add_subplot()
    n = len(effects)
    for role, low, high, label in (
        ("alike", alike, np.inf, f"alike, {alike} or more"),
        ("muted", _FAINT, alike, f"less than {alike}"),
    ):
        squares = [
            Path(_CORNERS * 0.94 * similarity[i, j] + (j, i), closed=True)
            for i in range(n)
            for j in range(i)
            if low <= similarity[i, j] < high
        ]
        if squares:  # all of one colour as one path
            patch = PathPatch(Path.make_compound_path(*squares), linewidth=0, label=label)
            patch.set_facecolor(STAND_IN[role])
            axes.add_patch(patch)
    for place, name in enumerate(effects):
        axes.text(place - 0.4, place, name, va="center", fontsize=9)
        axes.plot([-0.5, place - 0.5], [place + 0.5] * 2, color=STAND_IN["line"], linewidth=0.6)
        axes.plot([place - 0.5] * 2, [place + 0.5, n - 0.5], color=STAND_IN["line"], linewidth=0.6)
    cell_in = min(_ROW_IN, (WIDTH_IN - _NAMES_IN) / n)
    axes.set(xlim=(-0.6, WIDTH_IN / cell_in), ylim=(n - 0.4, -0.6))
    axes.set_axis_off()
    legend(figure, handlelength=1.0)
