"""The channels of a map and their signs, from the columns of a file."""

from collections.abc import Mapping, Sequence

from tsas_cli.recordings.columns import NAMES, has_input_and_output
from tsas_cli.recordings.guess.columns import Certainty, FileColumn, Proposed, with_unit
from tsas_cli.recordings.guess.ends import FORCES, LENGTHS, Assignment, assign
from tsas_cli.recordings.guess.looks import correlation, sign_of
from tsas_cli.recordings.guess.words import words_of
from tsas_cli.recordings.ingest_map import QUESTION

_CLEAR = 0.75  # least magnitude of the correlation of two channels
Sign = tuple[int | str, str]  # 1, −1 or a question, and why
_MECHANICAL = ("x_in_mm", "x_out_mm", "f_in_N", "f_out_N")


def channels(columns: Sequence[FileColumn], unusable: Mapping[str, str]) -> list[Proposed]:
    """Return the proposed channels of the columns besides the clock, in the order of the format.

    Channels without evidence are left out; `unusable` are further columns, and why they are.
    """
    moving = [c for c in columns if c.moves]
    others = _others(columns)
    assigned = {id(c) for found in others.values() for c in found}
    free = [c for c in moving if id(c) not in assigned and not c.words.is_reference]
    displacements = [c for c in free if c.quantity in LENGTHS]
    tensions = [c for c in free if c.quantity in FORCES]
    # A torque of the motor is before a gear of unknown friction.
    tensions = [c for c in tensions if (c.end, c.quantity) != ("motor", "torque")]
    ends = assign(displacements, tensions)
    signed = signs(ends.assigned)
    found = {n: _channel(n, c, ends, signed.get(n, (1, ""))) for n, c in ends.assigned.items()}
    motor = others.get("motor_angle_rad", [])
    found |= _open_channels(ends, motor) | {n: _one(n, c) for n, c in others.items()}
    found |= _missing(found, free, motor, ends)
    found |= _unrecorded(found, [c for c in moving if c.words.is_reference], unusable)
    return [found[name] for name in NAMES if name in found]


def _others(columns: Sequence[FileColumn]) -> dict[str, list[FileColumn]]:
    """Return the columns of channels that are neither displacement nor tension of the tendon.

    A motor's position in mm is the proximal displacement, its angle is the motor angle; a position
    without a unit is the displacement if no other column is named as that of the drive.
    """
    found: dict[str, list[FileColumn]] = {}
    of_drive = any(c.end == "in" and c.quantity in LENGTHS for c in columns)
    for column in columns:
        quantity, motor = column.quantity, column.end == "motor"
        turns = column.kind in ("angle", "label") or (
            column.kind is None and (quantity == "angle" or of_drive)
        )
        of_motor = motor and turns and quantity in ("angle", "displacement")
        if quantity == "temperature":
            found.setdefault("temperature_C", []).append(column)
        elif quantity == "speed" and (motor or column.kind == "speed"):
            found.setdefault("motor_speed_rpm", []).append(column)
        elif of_motor and not column.words.is_reference:
            found.setdefault("motor_angle_rad", []).append(column)
        elif quantity == "force" and column.words.is_reference and column.end != "in":
            found.setdefault("f_out_ref_N", []).append(column)
    return found


def _one(name: str, columns: Sequence[FileColumn]) -> Proposed:
    measured = [c for c in columns if not c.words.is_reference] or columns
    if len(measured) > 1:
        shown = ", ".join(c.shown for c in columns)
        return _open(name, ("several columns match",), f"which one: {shown}?", columns)
    column = measured[0]
    entry, questions = with_unit(column, name)
    others = tuple(c.shown for c in columns if c is not column)
    return Proposed(
        name, entry, "open" if questions else "likely", tuple(column.reasons), questions, others
    )


def _channel(name: str, column: FileColumn, ends: Assignment, sign: Sign) -> Proposed:
    entry, questions = with_unit(column, name)
    why = [*column.reasons, *_motion(column, ends)]
    if sign[0] == QUESTION:
        questions["sign"] = sign[1]
    elif sign[1]:
        why.append(sign[1])
    if sign[0] != 1:
        entry["sign"] = sign[0]
    named = column.end is not None
    certainty: Certainty = "sure" if named and _motion(column, ends) else "likely"
    return Proposed(name, entry, "open" if questions else certainty, tuple(why), questions)


def _motion(column: FileColumn, ends: Assignment) -> list[str]:
    """Return the evidence of the motion for a column's end, against the other assigned columns."""
    assigned = {id(c) for c in ends.assigned.values()}
    first = [b.shown for a, b in ends.ahead if a is column and id(b) in assigned]
    behind = [a.shown for a, b in ends.ahead if b is column and id(a) in assigned]
    evidence = []
    if first:
        evidence.append(f"it moves before {', '.join(first)} after a reversal: nearer to the drive")
    if behind:
        evidence.append(f"it moves after {', '.join(behind)} after a reversal, delayed by friction")
    return evidence


def _open_channels(ends: Assignment, motor: Sequence[FileColumn]) -> dict[str, Proposed]:
    """Return the channels whose column is open; for a single column, one of the two ends.

    Where a displacement may be that of the load, the motor's angle may be x_in.
    """
    found: dict[str, Proposed] = {}
    for name, candidates in ends.open.items():
        other = {"x_out_mm": "x_in_mm", "f_out_N": "f_in_N"}.get(name)
        if other in found and len(candidates) == 1:
            continue
        shown = ", ".join(c.shown for c in candidates)
        question = f"which column is this, if any: {shown}?"
        if len(candidates) == 1:
            at_load = name.replace("_in_", "_out_")
            question = f"is {shown} at the drive? If at the load, name this table columns.{at_load}"
            if name == "x_in_mm" and motor:
                angles = " or ".join(c.shown for c in motor)
                question += f"; then x_in_mm may be {angles}, with pulley_radius_mm beside it"
        found[name] = _open(name, (ends.reason, *_orders(candidates, ends)), question, candidates)
    return found


def _missing(
    found: Mapping[str, Proposed],
    free: Sequence[FileColumn],
    motor: Sequence[FileColumn],
    ends: Assignment,
) -> dict[str, Proposed]:
    """Return a question for each missing channel that an unassigned column may be.

    Any column may be a missing x_in or f_in, and the motor's angle may be x_in; at the distal end
    one with a word for an end or a fitting unit, or any, while ingest would refuse the map.
    """
    used = {c.source for c in ends.assigned.values()}
    used |= {source for channel in found.values() for source in channel.candidates}
    left = [c for c in free if c.source not in used and c.quantity in (None, *LENGTHS, *FORCES)]
    whole = has_input_and_output(frozenset(n for n, p in found.items() if p.certainty != "open"))
    asked = {}
    for name in (n for n in _MECHANICAL if n not in found):
        fitting = LENGTHS if name in ("x_in_mm", "x_out_mm") else FORCES
        candidates = [c for c in left if c.quantity is None or c.quantity in fitting]
        if whole and name in ("x_out_mm", "f_out_N"):
            candidates = [c for c in candidates if c.quantity or c.end]
        if name == "x_in_mm":
            candidates += [c for c in motor if c.kind != "label"]
        if not candidates:
            continue
        orders = _orders(candidates, assign((), candidates) if len(candidates) > 1 else ends)
        why = ("neither names nor units say which column this is", *orders)
        question = f"which column is this, if any: {', '.join(c.shown for c in candidates)}?"
        if name == "x_in_mm" and any(c.end == "motor" for c in candidates):
            question += " An angle needs pulley_radius_mm beside it."
        asked[name] = _open(name, why, question, candidates)
    return asked


def _unrecorded(
    found: Mapping[str, Proposed],
    references: Sequence[FileColumn],
    unusable: Mapping[str, str],
) -> dict[str, Proposed]:
    """Return a question for x_in or f_in that no column is left for; a drive alone has no f_in.

    The reference of a drive's position may stand for it.
    """
    of_drive = "f_out_N" not in found and any(name.startswith("motor_") for name in found)
    wanted = ("x_in_mm",) if of_drive else ("x_in_mm", "f_in_N")
    question = (
        "is it in another file of the same run (.join, docs/ingest.md)? If it was not recorded, "
        "delete this table."
    )
    why = ("no column is left that it could be",)
    asked = {
        name: _open(name, why, _correct(name, unusable) + question)
        for name in wanted
        if found and name not in found
    }
    lengths = [c for c in references if c.quantity in (None, *LENGTHS) and c.end != "out"]
    if "x_in_mm" in asked and lengths:
        shown = ", ".join(c.shown for c in lengths)
        follows = f"{question} Where the drive follows it closely, its reference will do: {shown}."
        asked["x_in_mm"] = _open("x_in_mm", why, follows, lengths)
    return asked


def _correct(name: str, unusable: Mapping[str, str]) -> str:
    """Return the question whether a channel is a column that cannot be used."""
    kinds = ("displacement", "angle") if name == "x_in_mm" else ("force", "torque")
    return "".join(
        f"is it {source}, which cannot be used: {reason}? Then correct the file. Or "
        for source, reason in unusable.items()
        if words_of(source).quantity in kinds
    )


def _open(
    name: str, why: tuple[str, ...], question: str, columns: Sequence[FileColumn] = ()
) -> Proposed:
    alternatives = tuple(": ".join(filter(None, (c.shown, "; ".join(c.reasons)))) for c in columns)
    asked, sources = {"source": question}, tuple(c.source for c in columns)
    return Proposed(name, {"source": QUESTION}, "open", why, asked, alternatives, sources)


def _orders(columns: Sequence[FileColumn], ends: Assignment) -> list[str]:
    return [
        f"by the motion {column.shown} is nearer to the drive than {', '.join(behind)}"
        for column in columns
        if (behind := [b.shown for a, b in ends.ahead if a is column])
    ]


def signs(assigned: Mapping[str, FileColumn]) -> dict[str, Sign]:
    """Return the sign of each assigned displacement and tension, with the reason.

    Tensions are positive; the proximal displacement rises with a tension of known sign; the distal
    displacement follows the proximal one.
    """
    found: dict[str, Sign] = {}
    for name in ("f_in_N", "f_out_N"):
        if name in assigned:
            found[name] = _SIGNS[sign_of(assigned[name].values)]
    if "x_in_mm" in assigned:
        found["x_in_mm"] = _drive(assigned, found)
    if "x_out_mm" in assigned:
        found["x_out_mm"] = _load(assigned, found)
    return found


_RISES = "1 or -1, so that it rises when the drive pulls"
_SIGNS: dict[int, Sign] = {
    -1: (-1, "its values are negative, and a tendon cannot push"),
    0: (1, "its values are on both sides of zero: its sign is unknown"),
    1: (1, ""),
}


def _drive(assigned: Mapping[str, FileColumn], found: Mapping[str, Sign]) -> Sign:
    x = assigned["x_in_mm"].values
    for name in ("f_out_N", "f_in_N"):
        if name not in assigned:
            continue
        correlated = correlation(x, assigned[name].values) * int(found[name][0])
        known = sign_of(assigned[name].values) != 0
        if correlated > _CLEAR:
            return 1, f"it rises with {assigned[name].shown}"
        if correlated < -_CLEAR and known:
            return -1, f"it falls as {assigned[name].shown} rises"
        if correlated < -_CLEAR:
            why = f"it falls as {assigned[name].shown} rises: one of the two has the wrong sign"
            return QUESTION, f"{why}; {_RISES}"
    if assigned.keys() & {"f_in_N", "f_out_N"}:
        return QUESTION, f"no tension clearly follows it; {_RISES}"
    return 1, "no tension shows its sign; it has to rise when the drive pulls"


def _load(assigned: Mapping[str, FileColumn], found: Mapping[str, Sign]) -> Sign:
    if "x_in_mm" not in assigned:
        return 1, "no proximal displacement shows its sign; it has to rise when the drive pulls"
    drive = assigned["x_in_mm"]
    correlated = correlation(drive.values, assigned["x_out_mm"].values)
    if abs(correlated) < _CLEAR:
        return QUESTION, f"it does not follow {drive.shown}; {_RISES}"
    sign = found["x_in_mm"][0]
    moves = "moves with" if correlated > 0.0 else "moves opposite to"
    if isinstance(sign, str):
        same = "the same as" if correlated > 0.0 else "the opposite of"
        return QUESTION, f"{same} that of x_in_mm: it {moves} x_in_mm"
    return (sign if correlated > 0.0 else -sign), f"it {moves} {drive.shown}"
