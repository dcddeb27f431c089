"""The points of a sweep: the values of each task, from the axes and the table of a plan."""

import itertools
import math
from pathlib import Path

import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet

from tsas_cli.support.errors import InputError
from tsas_cli.sweeping.outcome import Row
from tsas_cli.sweeping.plan import SweepPlan

MOST_TASKS = 1_000_000


def points_of(plan: SweepPlan, base: Path) -> list[Row]:
    """Return the values of every task by name; one empty point without variation.

    The last axis varies fastest. Each row of the table is combined with every point of the axes.

    Raises
    ------
    InputError
        The table cannot be read, shares a name with an axis or option, or the points are too many.
    """
    axes = plan.axes()
    sets = [Row()] if plan.sets is None else _sets(base / plan.sets)
    for name in {name for row in sets for name in row}:
        if name in axes or name in plan.options:
            raise InputError(f"{name} is in the plan and in {plan.sets}", where="the plan")
    lengths = [len(values) for values in axes.values()]
    count = (min(lengths, default=1) if plan.combine == "zip" else math.prod(lengths)) * len(sets)
    if count > MOST_TASKS:
        raise InputError(f"{count} points", where="the plan", expected=f"at most {MOST_TASKS}")
    together = zip(*axes.values(), strict=True) if axes and plan.combine == "zip" else None
    rows = list(together or itertools.product(*axes.values()))
    return [row | dict(zip(axes, values, strict=True)) for row in sets for values in rows]


def _sets(path: Path) -> list[Row]:
    """Return the rows of a table of parameter sets; empty cells are left out."""
    try:
        if path.suffix.lower() == ".csv":
            table = pa.csv.read_csv(path)
        else:
            table = pa.parquet.ParquetFile(path).read()
    except (pa.ArrowException, OSError) as error:
        reason = str(error).splitlines()[0]
        raise InputError(
            f"cannot be read ({reason})", where=path, expected="a table as CSV or Parquet"
        ) from error
    if len(set(table.column_names)) < len(table.column_names):
        raise InputError("duplicate column", where=path)
    if not 0 < table.num_rows <= MOST_TASKS:
        raise InputError(f"{table.num_rows} rows", where=path, expected=f"1 to {MOST_TASKS}")
    return [{k: v for k, v in row.items() if v is not None} for row in table.to_pylist()]
