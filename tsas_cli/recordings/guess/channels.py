"""From the columns of a file to the channels of a map."""

from collections.abc import Sequence

from tsas_cli.recordings.columns import NAMES, has_input_and_output
from tsas_cli.recordings.guess.columns import Column
from tsas_cli.recordings.guess.ends import Ends, settle
from tsas_cli.recordings.guess.proposed import Proposed, Sureness, with_unit
from tsas_cli.recordings.guess.signs import Sign, signs
from tsas_cli.recordings.ingest_map import QUESTION

_MECHANICAL = ("x_in_mm", "x_out_mm", "f_in_N", "f_out_N")


def channels(columns: Sequence[Column]) -> list[Proposed]:
    """Return what the columns besides the clock can be, in the order of the format.

    Channels that nothing speaks for are not there.
    """
    moving = [c for c in columns if c.moves]
    others = _others(columns)
    taken = {id(c) for found in others.values() for c in found}
    free = [c for c in moving if id(c) not in taken and not c.words.wish]
    displacements = [c for c in free if c.quantity in ("displacement", "angle")]
    tensions = [c for c in free if c.quantity in ("force", "torque") and not _of_motor(c)]
    ends = settle(displacements, tensions)
    found = _settled(ends) | _asked(ends) | {n: _one(n, c) for n, c in others.items()}
    if not has_input_and_output(frozenset(n for n, p in found.items() if p.sure != "open")):
        unknown = [c for c in free if c.quantity is None]
        missing = [n for n in _MECHANICAL if n not in found]
        found |= _unknown(unknown, missing, ends) if unknown else {}
    return [found[name] for name in NAMES if name in found]


def _others(columns: Sequence[Column]) -> dict[str, list[Column]]:
    """Return the columns of the channels that are neither displacement nor tension of the tendon.

    A motor's position in mm is the tendon's at the drive, its angle is the motor's own.
    """
    found: dict[str, list[Column]] = {}
    for column in columns:
        quantity, motor = column.quantity, column.place == "motor"
        turns = column.kind in ("angle", "label", None)
        if quantity == "temperature":
            found.setdefault("temperature_C", []).append(column)
        elif quantity == "speed" and (motor or column.kind == "rotation"):
            found.setdefault("motor_speed_rpm", []).append(column)
        elif motor and quantity in ("angle", "displacement") and turns and not column.words.wish:
            found.setdefault("motor_angle_rad", []).append(column)
        elif quantity == "force" and column.words.wish and column.place != "in":
            found.setdefault("f_out_ref_N", []).append(column)
    return found


def _of_motor(column: Column) -> bool:
    """Say whether a torque is the motor's, before a gear of unknown friction."""
    return column.place == "motor" and column.quantity == "torque"


def _one(name: str, columns: Sequence[Column]) -> Proposed:
    measured = [c for c in columns if not c.words.wish] or columns
    if len(measured) > 1:
        shown = ", ".join(c.shown for c in columns)
        asked = {"source": f"which one: {shown}?"}
        return Proposed(name, {"source": QUESTION}, "open", ("several speak of it",), asked)
    column = measured[0]
    entry, asked = with_unit(column, name)
    others = tuple(c.shown for c in columns if c is not column)
    return Proposed(
        name, entry, "open" if asked else "likely", tuple(column.reasons), asked, others
    )


def _settled(ends: Ends) -> dict[str, Proposed]:
    turned = signs(ends.settled)
    return {
        name: _channel(name, column, ends, turned.get(name, (1, "")))
        for name, column in ends.settled.items()
    }


def _channel(name: str, column: Column, ends: Ends, sign: Sign) -> Proposed:
    entry, asked = with_unit(column, name)
    why = [*column.reasons, *_motion(column, ends)]
    if sign[0] == QUESTION:
        asked["sign"] = sign[1]
    elif sign[1]:
        why.append(sign[1])
    if sign[0] != 1:
        entry["sign"] = sign[0]
    named = column.place is not None
    sure: Sureness = "sure" if named and _motion(column, ends) else "likely"
    return Proposed(name, entry, "open" if asked else sure, tuple(why), asked)


def _motion(column: Column, ends: Ends) -> list[str]:
    """Return what the motion says of a column's place, against the other settled ones."""
    settled = {id(c) for c in ends.settled.values()}
    first = [b.shown for a, b in ends.ahead if a is column and id(b) in settled]
    behind = [a.shown for a, b in ends.ahead if b is column and id(a) in settled]
    said = []
    if first:
        said.append(f"after a turn it moves before {', '.join(first)}: it is nearer to the drive")
    if behind:
        said.append(f"after a turn it comes behind {', '.join(behind)}, held back by friction")
    return said


def _asked(ends: Ends) -> dict[str, Proposed]:
    """Return the channels whose column is in question; for a column alone, one of the two."""
    found: dict[str, Proposed] = {}
    for name, candidates in ends.asked.items():
        other = {"x_out_mm": "x_in_mm", "f_out_N": "f_in_N"}.get(name)
        if other in found and len(candidates) == 1:
            continue
        shown = ", ".join(c.shown for c in candidates)
        asked = {"source": f"which column is this, if any: {shown}?"}
        if len(candidates) == 1:
            asked = {"source": f"is {shown} this? If it is at the load, rename the table."}
        why = (ends.reason, *_orders(candidates, ends))
        found[name] = Proposed(
            name, {"source": QUESTION}, "open", why, asked, tuple(_told(c) for c in candidates)
        )
    return found


def _unknown(columns: Sequence[Column], names: Sequence[str], ends: Ends) -> dict[str, Proposed]:
    """Return a question for each channel that is missing while columns are left unexplained."""
    shown = ", ".join(c.shown for c in columns)
    free = settle((), columns) if len(columns) > 1 else ends
    why = (
        "neither names nor units say what these columns are",
        *_orders(columns, free),
    )
    asked = {"source": f"which column is this, if any: {shown}?"}
    told = tuple(_told(c) for c in columns)
    return {name: Proposed(name, {"source": QUESTION}, "open", why, asked, told) for name in names}


def _orders(columns: Sequence[Column], ends: Ends) -> list[str]:
    return [
        f"by the motion {column.shown} is nearer to the drive than {', '.join(behind)}"
        for column in columns
        if (behind := [b.shown for a, b in ends.ahead if a is column])
    ]


def _told(column: Column) -> str:
    return f"{column.shown}: {'; '.join(column.reasons)}" if column.reasons else column.shown
