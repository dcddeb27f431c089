"""Signs of channels: tensions are positive, and the distal end follows the drive."""

from collections.abc import Mapping

from tsas_cli.recordings.guess.columns import FileColumn
from tsas_cli.recordings.guess.looks import correlation, sign_of
from tsas_cli.recordings.ingest_map import QUESTION

_CLEAR = 0.75  # least magnitude of the correlation of two channels
Sign = tuple[int | str, str]  # 1, −1 or a question, and why


def signs(assigned: Mapping[str, FileColumn]) -> dict[str, Sign]:
    """Return the sign of each assigned displacement and tension, with the reason.

    Tensions are positive; the proximal displacement rises with a tension of known sign; the distal
    displacement follows the proximal one.
    """
    found: dict[str, Sign] = {}
    for name in ("f_in_N", "f_out_N"):
        if name in assigned:
            found[name] = _tension(assigned[name])
    if "x_in_mm" in assigned:
        found["x_in_mm"] = _drive(assigned, found)
    if "x_out_mm" in assigned:
        found["x_out_mm"] = _load(assigned, found)
    return found


def _tension(column: FileColumn) -> Sign:
    side = sign_of(column.values)
    if side < 0:
        return -1, "its values are negative, and a tendon cannot push"
    return 1, "" if side else "its values are on both sides of zero: its sign is unknown"


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
            return QUESTION, f"{why}; 1 or -1, so that it rises when the drive pulls"
    forces = [n for n in ("f_in_N", "f_out_N") if n in assigned]
    if forces:
        return (
            QUESTION,
            "no tension clearly follows it; 1 or -1, so that it rises when the drive pulls",
        )
    return 1, "no tension shows its sign; it has to rise when the drive pulls"


def _load(assigned: Mapping[str, FileColumn], found: Mapping[str, Sign]) -> Sign:
    if "x_in_mm" not in assigned:
        return 1, "no proximal displacement shows its sign; it has to rise when the drive pulls"
    drive = assigned["x_in_mm"]
    correlated = correlation(drive.values, assigned["x_out_mm"].values)
    if abs(correlated) < _CLEAR:
        return (
            QUESTION,
            f"it does not follow {drive.shown}; 1 or -1, so that it rises when the drive pulls",
        )
    sign = found["x_in_mm"][0]
    if isinstance(sign, str):
        same = "the same as" if correlated > 0.0 else "the opposite of"
        return QUESTION, f"{same} that of x_in_mm: it {_FOLLOWS[correlated > 0.0]} x_in_mm"
    return (sign if correlated > 0.0 else -sign), f"it {_FOLLOWS[correlated > 0.0]} {drive.shown}"


_FOLLOWS = {True: "moves with", False: "moves opposite to"}
