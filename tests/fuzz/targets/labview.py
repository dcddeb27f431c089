"""Files of LabVIEW: the first byte chooses between TDMS and LVM."""

import io
from collections.abc import Iterable

import numpy as np
from nptdms import ChannelObject, TdmsWriter

from tests.fuzz.foreign import Offering, ask
from tests.fuzz.rules import Scratch, answer
from tsas_cli.recordings.readers import labview, names, read, tdms  # noqa: F401 # instrumented
from tsas_cli.recordings.readers.table import ReadOptions

SHARE = 0.3
MOST_BYTES = 4000
WORDS = (b"TDSm", b"wf_increment", b"***End_of_Header***", b"X_Value", b"Delta_X", b"Channels\t")
_scratch = Scratch()


def one(data: bytes) -> None:
    """The rest is the file."""
    if data[:1] < b"\x80":
        ask(Offering("tdms"), _scratch.file("a.tdms", data[1:]), ReadOptions())
        return
    path = _scratch.file("a.lvm", data[1:])
    listed = answer(names, path, ReadOptions())
    if listed is not None:
        answer(read, path, ReadOptions(), list(range(1, len(listed) + 1))[:20])


def seeds() -> Iterable[bytes]:
    """Channels with and without a clock; samples with a comment, and without times."""
    for said in ({}, {"wf_increment": 0.1, "wf_start_offset": 0.0}):
        stream = io.BytesIO()
        with TdmsWriter(stream) as file:
            file.write_segment([ChannelObject("a", n, np.arange(4.0), said) for n in ("f", "x")])
        yield b"\0" + stream.getvalue()
    for kind, first in (("One", "0.5"), ("No", "")):
        end = "***End_of_Header***\t\n"
        head = f"LabVIEW Measurement\nX_Columns\t{kind}\n{end}\nChannels\t1\nDelta_X\t0.1\n{end}"
        text = f"{head}X_Value\tf\tComment\n{first}\t1\tgo\n{first}\t2\n"
        yield b"\xff" + text.encode()
