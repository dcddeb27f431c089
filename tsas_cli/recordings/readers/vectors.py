"""The columns in an array of any shape."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from tsas_cli.recordings.readers.offered import Column


def columns_in(
    name: str, array: Any, unit: str = "", load: Callable[[Any], npt.NDArray[Any]] | None = None
) -> list[Column]:
    """Return the columns of numbers or of times in an array.

    A vector is a column, the field of records `name.field`, the j-th column of a matrix
    `name(:,j)`; samples lie along its longer side. Other arrays hold none.

    Parameters
    ----------
    array
        With `shape`, `ndim` and `dtype`, such as one in a file.
    load
        Loads the values of `array`; without it they are there.
    """
    whole = partial(load, array) if load else partial(np.asarray, array)
    if array.ndim not in {1, 2} or (array.size < 2 and array.ndim == 2):
        return []
    if array.dtype.names:
        return [
            Column(f"{name}.{field}" if name else field, partial(_field, whole, field), unit)
            for field in array.dtype.names
            if array.dtype[field].kind in "fiubmM" and array.ndim == 1
        ]
    if array.dtype.kind not in "fiubmM":
        return []
    if 1 in array.shape or array.ndim == 1:
        return [Column(name, lambda: whole().ravel(), unit)]
    across = array.shape[0] < array.shape[1]
    named = [f"{name}(:,{j + 1})" if name else "" for j in range(min(array.shape))]
    return [Column(n, partial(_column, whole, j, across), unit) for j, n in enumerate(named)]


def _field(whole: Callable[[], npt.NDArray[Any]], field: str) -> npt.NDArray[Any]:
    return whole()[field]


def _column(
    whole: Callable[[], npt.NDArray[Any]],
    j: int,
    across: bool,
) -> npt.NDArray[Any]:
    values = whole()
    return values[j] if across else values[:, j]
