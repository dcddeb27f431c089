"""Which effects look alike with these inputs, before any is fitted."""

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from tsas_cli.records.diagnosis import DiagnosisFile
from tsas_cli.reporting.content import Section
from tsas_cli.reporting.numbers import fixed
from tsas_cli.support.arrays import Floats
from tsas_cli.support.wording import listed

_ALIKE = 0.95  # less than a third of one is then left that the other cannot imitate
_VISIBLE = 5.0  # standard deviations of noise
_WHAT = (
    "What an effect would do to the channels, less what the nominal parameters can do, is its "
    f"signature. In each group any two have a similarity of {_ALIKE} or more, of at most 1, at "
    "small sizes and for some values of their parameters:"
)


def part(diagnosis: DiagnosisFile) -> Section | None:
    """Return the part, None where no signatures were compared."""
    names = np.array(diagnosis.signatures.effects, dtype=object)
    if names.size < 2:
        return None
    similarity = np.array(diagnosis.signatures.similarity, dtype=float)
    visible = np.array(diagnosis.signatures.visible, dtype=float) >= _VISIBLE
    hidden = listed([f"`{name}`" for name in names[~visible]])
    groups = tuple(_alike(names[visible], similarity[np.ix_(visible, visible)])) or ("none",)
    shown = (f"These inputs hardly show {hidden} at a size that is plausible.",) if hidden else ()
    title = "Which effects look alike with these inputs"
    return Section("diagnosis-similarity", title, (_WHAT,), points=groups, closing=shown)


def _alike(names: npt.NDArray[np.object_], similarity: Floats) -> Iterator[str]:
    """Yield each group in which all look alike, with its similarity."""
    from scipy.cluster.hierarchy import fcluster, linkage

    if names.size < 2:
        return
    apart = 1.0 - similarity[np.triu_indices(names.size, 1)]
    groups = fcluster(linkage(apart, "complete"), 1.0 - _ALIKE, "distance")
    for number in dict.fromkeys(groups):
        inside = np.flatnonzero(groups == number)
        if inside.size > 1:
            pairs = similarity[np.ix_(inside, inside)][np.triu_indices(inside.size, 1)]
            group = listed([f"`{name}`" for name in names[inside]])
            lowest = fixed(float(pairs.min()), 2)
            least = "at least " if inside.size > 2 and lowest != fixed(1.0, 2) else ""
            yield f"{group} (similarity {least}{lowest})"
