"""Unpacked size of a file, limited by its size on disk."""

from dataclasses import dataclass
from pathlib import Path

from tsas_cli.support import limits
from tsas_cli.support.errors import InputError


@dataclass
class Expanded:
    """Unpacked bytes and items (variables, cells, blocks) of one file so far."""

    path: object
    of_file: int
    most: int = limits.EXPANSION
    bytes: int = 0
    items: int = 0

    @classmethod
    def of(cls, path: Path, most: int = limits.EXPANSION) -> "Expanded":
        """Return the empty count of a file that may expand to `most` times its size."""
        return cls(path, path.stat().st_size, most)

    def add(self, more: int, *, what: str = "") -> None:
        """Count one item of so many bytes.

        InputError: the file expands to more than a recording of its size can hold.
        """
        self.items += 1
        if self.items > min(limits.ITEMS, max(1000, self.of_file // 8)):
            raise InputError(
                f"holds more than {self.items - 1} variables, or refers to one repeatedly",
                where=self.path,
                expected="a recording",
                remedy="export the channels that you need",
            )
        self.grow(more, what=what)

    def grow(self, more: int, *, what: str = "") -> None:
        """Count more bytes of the same item."""
        self.bytes += more
        if self.bytes > max(limits.HARMLESS, self.most * self.of_file):
            claimed = f"{what}, {limits.size(self.bytes)}" if what else limits.size(self.bytes)
            raise InputError(
                f"{claimed} or more from a file of {limits.size(self.of_file)}",
                where=self.path,
                expected=f"at most {self.most} times its size",
                remedy="it may be damaged; else export it without compression, or as CSV",
            )

    def fits(self) -> None:
        """Refuse a file that is loaded whole and exceeds the memory."""
        limits.fits(self.path, limits.COPIES * self.bytes)
