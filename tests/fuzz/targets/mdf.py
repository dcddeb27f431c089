"""MDF files, version 4 and 3."""

from datetime import UTC, datetime
from functools import partial

import numpy as np
from asammdf import MDF, Signal

from tests.fuzz.foreign import Offering, files_of, whole_file
from tests.recordings.readers.test_mdf import F, T

MOST_BYTES = 6000
SHARE = 0.1
WORDS = (b"##DT", b"##DZ", b"##CN", b"##CG", b"##DG", b"##CC", b"##TX", b"##SD", b"##HL", b"##DL")
one = whole_file(Offering("mdf"), "a.mf4")
FORCE = [Signal(F, T, name="f", unit="N"), Signal(F.astype("i2"), T, name="x", unit="mm")]
SLOW = [Signal(F[:2], T[:2], name="slow")]
ODD = [Signal(F, T, name="p", invalidation_bits=np.array([0, 1, 0, 0, 0], dtype=bool))]
TEXT = [Signal(np.array([b"a"] * 5), T, name="w", encoding="utf-8")]


def seeds():
    for suffix, version, groups, packed in (
        ("mf4", "4.10", [FORCE], 0),
        ("mf4", "4.10", [FORCE, SLOW, ODD, TEXT], 2),
        ("mdf", "3.30", [FORCE, SLOW], 0),
    ):
        with MDF(version=version) as file:
            file.start_time = datetime(2026, 1, 1, tzinfo=UTC)
            for group in groups:
                file.append(group)
            save = partial(file.save, overwrite=True, compression=packed)
            yield from files_of(f"a.{suffix}", save)()
