"""The whole reproduction: how many rows have which verdict, and what is written of it."""

from collections.abc import Sequence
from typing import Any

from tsas_cli.paper import Paper
from tsas_cli.support import __version__
from tsas_studies.reproduction.group import VERDICTS, Group, Verdict


def counted(groups: Sequence[Group]) -> dict[Verdict, int]:
    """Return how many rows of all groups have each verdict."""
    each = [group.counts() for group in groups]
    return {verdict: sum(counts[verdict] for counts in each) for verdict in VERDICTS}


def sentence(groups: Sequence[Group]) -> str:
    """Return the outcome in one sentence."""
    total = counted(groups)
    return (
        f"Of {sum(total.values())} numbers and statements of the paper {total['agrees']} agree "
        f"with ours, {total['differs']} differ, and {total['cannot tell']} cannot be determined."
    )


def verdict_table(groups: Sequence[Group]) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Return header and rows of a table of verdicts, one row for each group and one for all."""
    rows = [(group.title, group.counts()) for group in groups] + [("all", counted(groups))]
    header = ("part", *VERDICTS)
    return header, [(title, *(str(counts[v]) for v in VERDICTS)) for title, counts in rows]


def summary_of(paper: Paper, groups: Sequence[Group]) -> dict[str, Any]:
    """Return what `reproduction.json` holds."""
    return {
        "format": 1,
        "stage": "reproduce",
        "version": __version__,
        "citation": dict(paper.citation),
        "counts": counted(groups),
        "groups": [group.as_json() for group in groups],
    }
