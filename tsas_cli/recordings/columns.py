"""The canonical columns of a recording, with their units (format 1)."""

import math
from dataclasses import dataclass

from tsas_cli.support import limits


@dataclass(frozen=True)
class ColumnSpec:
    """One canonical column: its name with the unit, the unit as text, and its meaning."""

    name: str
    unit: str
    meaning: str


COLUMNS = (
    ColumnSpec("time_s", "s", "time since the run began"),
    ColumnSpec("x_in_mm", "mm", "displacement of the tendon at the drive, positive when pulled"),
    ColumnSpec("x_out_mm", "mm", "displacement of the tendon at the load, positive when pulled"),
    ColumnSpec("f_in_N", "N", "tension at the drive"),
    ColumnSpec("f_out_N", "N", "tension at the load"),
    ColumnSpec("motor_speed_rpm", "rpm", "motor speed, commanded or measured"),
    ColumnSpec("motor_angle_rad", "rad", "motor angle"),
    ColumnSpec("f_out_ref_N", "N", "reference tension at the load"),
    ColumnSpec("temperature_C", "°C", "temperature"),
)
BY_NAME = {column.name: column for column in COLUMNS}
NAMES = tuple(BY_NAME)
TIME = "time_s"

# x_in is the input of the tendon and the output of the drive; f_in alone can drive the tendon too.
INPUTS = ("x_in_mm", "f_in_N", "motor_speed_rpm", "motor_angle_rad")
OUTPUTS = ("x_in_mm", "x_out_mm", "f_in_N", "f_out_N")


def has_input_and_output(names: frozenset[str]) -> bool:
    """Return whether the columns include an input and another column that is an output."""
    return any(i != o for i in names.intersection(INPUTS) for o in names.intersection(OUTPUTS))


def largest(name: str) -> float:
    """Return the largest plausible magnitude of a column's values, in the column's unit.

    Infinite for the time, whose steps are limited instead, and for non-canonical columns.
    """
    column = BY_NAME.get(name)
    return limits.LARGEST.get(column.unit, math.inf) if column else math.inf


def nominal_name(name: str) -> str:
    """Return the name of the column with the nominal model's prediction, beside the extended one's.

    >>> nominal_name("x_in_mm")
    'x_in_nominal_mm'
    """
    return name_by(name, "nominal")


def name_by(name: str, model: str) -> str:
    """Return the name of the column with the prediction of a column by a model.

    >>> name_by("f_in_N", "A")
    'f_in_A_N'
    """
    quantity, unit = name.rsplit("_", 1)
    return f"{quantity}_{model}_{unit}"
