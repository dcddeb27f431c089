"""The file of a drive."""

from collections.abc import Iterable

from tests.fuzz.documents import toml_document as mutate
from tests.fuzz.rules import Scratch, answer
from tsas_cli.drive.file import UNITS, read_drive

__all__ = ["WORDS", "mutate", "one", "seeds"]
SHARE = 20
WORDS = (b"[parameters.", b"gain_mm_per_s_rpm", b'hold = "zero"', b"[structure]")
_scratch = Scratch()


def one(data: bytes) -> None:
    """Any file is a drive or is refused."""
    answer(read_drive, _scratch.file("drive.toml", data))


def seeds() -> Iterable[bytes]:
    """One with every parameter, one with the gain alone."""
    head = 'format = 1\nkind = "drive"\n[structure]\nname = "stiff"\n'
    entries = [f"[parameters.{name}]\nvalue = 1.5\nunit = {u!r}\n" for name, u in UNITS.items()]
    yield f"{head}{entries[0]}".encode()
    yield f'{head}hold = "zero"\nversion = "0"\n{"".join(entries)}'.replace(
        'hold = "zero"\nversion = "0"\n', 'hold = "zero"\n'
    ).encode()
