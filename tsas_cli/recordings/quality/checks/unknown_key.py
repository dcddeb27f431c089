"""The manifest holds a key that format 1 does not know.

Such a key travels along unused. A misspelt one is a value that nobody reads.
"""

from collections.abc import Iterator

from tsas_cli.errors import printable
from tsas_cli.recordings.manifest import Manifest
from tsas_cli.recordings.quality.finding import CannotTell, Check, Remark


def find(manifest: Manifest) -> Iterator[Remark | CannotTell]:
    """Look at the manifest's three kinds of tables; a likely misspelling is a warning."""
    tables = [("", manifest), ("rig.", manifest.rig)]
    tables += [(f"run {run.id}: ", run) for run in manifest.run]
    for place, table in tables:
        for key, hint in table.unknown_keys().items():
            misspelt = hint.startswith("did you mean")
            yield Remark(
                "warning" if misspelt else "note",
                f"dataset.toml holds the unknown key {printable(place + key)}",
                hint if misspelt else "nothing, if it is meant for the reader",
            )


CHECK = Check("unknown-key", find)
