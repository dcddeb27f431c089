"""Conversion between Arrow columns and NumPy arrays.

pyarrow's own conversion loads pandas, which takes a third of a second that few commands need.
"""

import numpy as np
import pyarrow as pa

from tsas_cli.support.arrays import Floats


def floats_from(column: pa.ChunkedArray) -> Floats:
    """Return a column of numbers as float64, shape (n,), null as NaN.

    ArrowInvalid, ArrowNotImplementedError: the column is not numeric.
    """
    whole = column.cast(pa.float64(), safe=False).combine_chunks()
    if not len(whole):
        return np.empty(0)
    validity, numbers = whole.buffers()
    values: Floats = np.frombuffer(numbers, np.float64, len(whole), whole.offset * 8)
    if not whole.null_count:
        return values
    bits = np.unpackbits(np.frombuffer(validity, np.uint8), bitorder="little")
    valid = bits[whole.offset : whole.offset + len(whole)].astype(np.bool_)
    return np.where(valid, values, np.nan)


def column_of(values: Floats) -> pa.Array:
    """Return an array, shape (n,), as a column of float64, NaN as null."""
    numbers = np.ascontiguousarray(values, dtype=np.float64)
    missing = np.isnan(numbers)
    validity = pa.py_buffer(np.packbits(~missing, bitorder="little")) if missing.any() else None
    return pa.Array.from_buffers(
        pa.float64(), numbers.size, [validity, pa.py_buffer(numbers)], int(missing.sum())
    )
