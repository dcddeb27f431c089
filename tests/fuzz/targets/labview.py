"""Files of LabVIEW: the first byte chooses between TDMS and LVM."""

from functools import partial

from tests.fuzz.foreign import Offering, files_of, whole_file
from tests.fuzz.rules import Scratch, read_all
from tests.recordings.readers.test_labview import TIME, lvm, tdms
from tsas_cli.recordings.readers import labview  # noqa: F401 # instrumented

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
    groups = {"a": {"f": (TIME, {}), "x": (TIME, {})}}
    clock = {"wf_increment": 0.1, "wf_start_offset": 0.0}
    written = (partial(tdms, groups=groups), partial(tdms, groups=groups, **clock))
    yield from (b"\0" + content for content in files_of("a.tdms", *written)())
    yield from (b"\xff" + content for content in files_of("a.lvm", lvm, partial(lvm, x="No"))())
