"""Propose a map for files of a rig."""

from collections.abc import Iterable
from dataclasses import dataclass

from tsas_cli.recordings.guess.proposal import MapProposal, propose
from tsas_cli.recordings.guess.text import MAP_MARK, content, map_text, tables
from tsas_cli.recordings.ingest import find_files
from tsas_cli.records.result import Result, Table
from tsas_cli.stages.given import Named, path_of, paths_of
from tsas_cli.support.files import new_file


@dataclass(frozen=True, repr=False, eq=False)
class GuessResult(Result):
    """A proposed map; its text is `map`, which is what is printed where nothing was written."""

    proposal: MapProposal  # which column each channel takes, how sure that is, what is open

    @property
    def map(self) -> str:
        """The map as commented TOML, to be edited."""
        return map_text(self.proposal)

    def intro(self) -> list[str]:
        """Return the map where it was not written."""
        return [] if self.out is not None else self.map.splitlines()

    def tables(self) -> list[Table]:
        """Return what the map that was written says, and what is open."""
        return [] if self.out is None else list(tables(self.proposal, self.out))


def guess(
    sources: Named | Iterable[Named], *, out: Named | None = None, force: bool = False
) -> GuessResult:
    """Propose a map for files from names, units and the look of the signals.

    Parameters
    ----------
    sources
        Files, or folders to search; one or several.
    out
        The map to write; None writes nothing.
    force
        Replace the file if it is there.

    Returns
    -------
    GuessResult
        `.map` is commented TOML to edit; nothing in it is sure before a person has read it.

    Raises
    ------
    InputError
        None of the files can be read, or `out` exists and `force` is not set.
    """
    files, path = find_files(paths_of(sources), "*"), path_of(out)
    proposal = propose(files)
    summary = content(proposal)
    if path is not None:
        with new_file(path, mark=MAP_MARK, inputs=files, force=force) as written:
            written.write_text(map_text(proposal), encoding="utf-8")
    return GuessResult(summary, path, proposal)
