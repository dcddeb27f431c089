"""MDF files, version 4 and 3."""

from datetime import UTC, datetime
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from asammdf import MDF, Signal

from tests.fuzz.foreign import Offering, whole_file
from tsas_cli.recordings.readers import mdf as _reader  # noqa: F401 # instrumented

MOST_BYTES = 6000
SHARE = 0.1
WORDS = (b"##DT", b"##DZ", b"##CN", b"##CG", b"##DG", b"##CC", b"##TX", b"##SD", b"##HL", b"##DL")
one = whole_file(Offering("mdf"), "a.mf4")


def seeds():
    time_s = np.arange(4) / 10
    one = [
        Signal(time_s, time_s, name="f", unit="N"),
        Signal(np.arange(4, dtype=np.int16), time_s, name="x", unit="mm"),
    ]
    invalid = np.array([0, 1, 0, 0], dtype=bool)
    more = [Signal(time_s[:2], time_s[:2], name="slow")]
    odd = [Signal(time_s, time_s, name="p", invalidation_bits=invalid)]
    words = [Signal(np.array([b"a"] * 4), time_s, name="w", encoding="utf-8")]
    with TemporaryDirectory() as name:
        path = Path(name) / "a.mf4"
        for version, groups, packed in (
            ("4.10", [one], 0),
            ("4.10", [one, more, odd, words], 2),
            ("3.30", [one, more], 0),
        ):
            with MDF(version=version) as file:
                file.start_time = datetime(2026, 1, 1, tzinfo=UTC)
                for group in groups:
                    file.append(group)
                saved = file.save(path.with_suffix(".mf4"), overwrite=True, compression=packed)
            yield Path(saved).read_bytes()
