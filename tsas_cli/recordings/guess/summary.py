"""A proposal as JSON, and as printed tables."""

from collections.abc import Iterator
from typing import Any

from tsas_cli.recordings.guess.proposal import MapProposal
from tsas_cli.recordings.guess.text import map_text
from tsas_cli.support import __version__


def content(proposal: MapProposal) -> dict[str, object]:
    """Return the proposal with the text of its map (docs/ingest.md, format 1)."""
    return {
        "format": 1,
        "stage": "guess",
        "version": __version__,
        "looked_at": str(proposal.looked_at.path),
        "unlike": {str(path): reason for path, reason in proposal.different.items()},
        "columns": {
            channel.name: {
                "entry": channel.entry,
                "sure": channel.certainty,
                "why": channel.why,
                "alternatives": channel.alternatives,
            }
            for channel in proposal.channels
        },
        "not_taken": proposal.not_taken,
        "questions": proposal.questions,
        "map": map_text(proposal),
    }


def tables(proposal: MapProposal, out: object) -> Iterator[tuple[str, tuple[str, ...], list[Any]]]:
    """Yield the tables of the channels with their sources, and of the open questions."""
    rows = [
        (channel.name, str(channel.entry.get("source", "")), channel.certainty)
        for channel in proposal.channels
    ]
    yield f"map {out}", ("channel", "source", "certainty"), rows
    if proposal.questions:
        yield "open questions", ("key", "question"), list(proposal.questions.items())
