"""The splits of `sources.toml`, with their files in the clones, which SHA256SUMS holds."""

import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from tsas_cli.support.files import sha256_of

HERE = Path(__file__).parent
SUMS = dict(
    reversed(line.split("  ", 1))
    for line in (HERE / "SHA256SUMS").read_text(encoding="utf-8").splitlines()
)


@dataclass(frozen=True)
class Split:
    """Files to learn from and to predict, below the folder of all clones, and what is said of them.

    `said` holds the keys of the split in `sources.toml`, over those of its source.
    """

    name: str
    learned: tuple[str, ...]
    predicted: tuple[str, ...]
    said: dict[str, Any]

    def faults(self, data: Path) -> list[str]:
        """Return which files are not there, or are not those that the split was made for."""
        files = (*self.learned, *self.predicted)
        absent = [f"{name} is missing" for name in files if not (data / name).is_file()]
        return absent or [
            f"{name} is another file" for name in files if sha256_of(data / name) != SUMS[name]
        ]


def splits() -> Iterator[Split]:
    """Yield the splits in the order of the file."""
    for source, of in tomllib.loads((HERE / "sources.toml").read_text(encoding="utf-8")).items():
        clone = of["repository"].rsplit("/", 1)[1]
        for name, own in of.pop("split").items():
            files = (_files(clone, own.get(part, ())) for part in ("learned", "predicted"))
            yield Split(f"{source}/{name}", *files, of | own)


def _files(clone: str, patterns: list[str]) -> tuple[str, ...]:
    return tuple(n for n in SUMS if any(fnmatchcase(n, f"{clone}/{p}") for p in patterns))
