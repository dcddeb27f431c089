"""The manifest holds a key that format 1 does not define.

Such a key is kept but has no effect; a misspelt key loses its value. A run may have keys of its
own, conditions that `tsas runs` finds it by.
"""

from collections.abc import Iterator

from tsas_cli.recordings.manifest import Manifest
from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.support.errors import printable


def find(manifest: Manifest) -> Iterator[Remark | CannotTell]:
    """Yield the unknown keys of the manifest's tables; a likely misspelling is a warning."""
    places: dict[tuple[str, str], list[str]] = {}
    tables = [("the top", manifest), ("[rig]", manifest.rig)]
    for place, table in [*tables, *((f"run {run.id}", run) for run in manifest.run)]:
        for key, hint in table.unknown_keys().items():
            places.setdefault((key, hint), []).append(place)
    for (key, hint), where in places.items():
        misspelt = hint.startswith("did you mean")
        if not misspelt and all(place.startswith("run ") for place in where):
            continue
        yield Remark(
            "warning" if misspelt else "note",
            f"dataset.toml holds the unknown key {printable(key)} in {_listed(where)}",
            hint if misspelt else "none, if it is a note for readers",
        )


def _listed(places: list[str]) -> str:
    more = f" and {len(places) - 1} more" if len(places) > 1 else ""
    return places[0] + more


CHECK = QualityCheck("unknown-key", find)
