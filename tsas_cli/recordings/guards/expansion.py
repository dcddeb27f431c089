"""What a file takes when it is unpacked, against its size."""

from dataclasses import dataclass
from pathlib import Path

from tsas_cli.support import limits, memory
from tsas_cli.support.errors import InputError


@dataclass
class Expanded:
    """What one file has asked for so far: bytes, and items (variables, cells, blocks)."""

    path: object
    of_file: int
    most: int = limits.EXPANSION
    bytes: int = 0
    items: int = 0

    @classmethod
    def of(cls, path: Path, most: int = limits.EXPANSION) -> "Expanded":
        """Begin with a file that may expand to `most` times its size."""
        return cls(path, path.stat().st_size, most)

    def add(self, more: int, *, what: str = "") -> None:
        """Count one item of so many bytes.

        Raises
        ------
        InputError
            The file asks for more than a recording of its size can hold.
        """
        self.items += 1
        if self.items > min(limits.ITEMS, max(1000, self.of_file // 8)):
            raise InputError(
                f"holds more than {self.items - 1} variables, or the same again and again",
                where=self.path,
                expected="a recording",
                remedy="export the channels that you need",
            )
        self.grow(more, what=what)

    def grow(self, more: int, *, what: str = "") -> None:
        """Count so many bytes more of the same item.

        Raises
        ------
        InputError
            As from `add`.
        """
        self.bytes += more
        if self.bytes > max(limits.HARMLESS, self.most * self.of_file):
            asked = f"{what}, {limits.size(self.bytes)}" if what else limits.size(self.bytes)
            raise InputError(
                f"{asked} or more from a file of {limits.size(self.of_file)}",
                where=self.path,
                expected=f"at most {self.most} times its size",
                remedy="is it damaged? if not, export it again without compression, or as CSV",
            )

    def fits(self) -> None:
        """Refuse what has to be loaded whole and is larger than the memory.

        Raises
        ------
        InputError
            It is.
        """
        memory.fits(self.path, limits.COPIES * self.bytes)
