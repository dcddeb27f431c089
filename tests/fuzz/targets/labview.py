"""Files of LabVIEW: the first byte chooses between TDMS and LVM."""

import io

import numpy as np
from nptdms import ChannelObject, TdmsWriter

from tests.fuzz.foreign import Offering, whole_file
from tests.fuzz.rules import Scratch, read_all
from tsas_cli.recordings.readers import labview, tdms  # noqa: F401 # instrumented

SHARE = 0.3
MOST_BYTES = 4000
WORDS = (b"TDSm", b"wf_increment", b"***End_of_Header***", b"X_Value", b"Delta_X", b"Channels\t")
_scratch = Scratch()
_tdms = whole_file(Offering("tdms"), "a.tdms")


def one(data):
    if data[:1] < b"\x80":
        _tdms(data[1:])
    else:
        read_all(_scratch.file("a.lvm", data[1:]))


def seeds():
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
