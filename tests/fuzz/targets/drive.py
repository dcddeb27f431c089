"""The file of a drive."""

from tests.fuzz.documents import toml_document as mutate
from tests.fuzz.rules import Scratch, answer
from tsas_cli.drive.file import UNITS, read_drive

__all__ = ["WORDS", "mutate", "one", "seeds"]
SHARE = 20
WORDS = (b"[parameters.", b"gain_mm_per_s_rpm", b'hold = "zero"', b"[structure]")
_scratch = Scratch()


def one(data):
    """Any file is a drive or is refused."""
    answer(read_drive, _scratch.file("drive.toml", data))


def seeds():
    head = 'format = 1\nkind = "drive"\n[structure]\nname = "stiff"\n'
    entries = [f"[parameters.{name}]\nvalue = 1.5\nunit = {u!r}\n" for name, u in UNITS.items()]
    yield f"{head}{entries[0]}".encode()
    yield f'{head}hold = "zero"\n{"".join(entries)}'.encode()
