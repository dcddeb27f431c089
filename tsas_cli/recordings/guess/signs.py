"""Which way round a channel counts: tendons pull, and what is pulled at the drive follows it."""

from collections.abc import Mapping

from tsas_cli.recordings.guess.columns import Column
from tsas_cli.recordings.guess.looks import sign_of, together
from tsas_cli.recordings.ingest_map import QUESTION

_CLEAR = 0.75  # the correlation with which a channel goes with another, or against it
Sign = tuple[int | str, str]  # 1, −1 or a question, and why


def signs(settled: Mapping[str, Column]) -> dict[str, Sign]:
    """Return the sign of each settled displacement and tension that is not 1 for sure.

    Tensions are positive; the drive's displacement grows with a tension whose sign is known; the
    load's displacement goes with the drive's.
    """
    found: dict[str, Sign] = {}
    for name in ("f_in_N", "f_out_N"):
        if name in settled:
            found[name] = _tension(settled[name])
    if "x_in_mm" in settled:
        found["x_in_mm"] = _drive(settled, found)
    if "x_out_mm" in settled:
        found["x_out_mm"] = _load(settled, found)
    return found


def _tension(column: Column) -> Sign:
    side = sign_of(column.values)
    if side < 0:
        return -1, "its values are negative, and a tendon cannot push"
    return 1, "" if side else "its values lie on both sides of zero: its sign is not told"


def _drive(settled: Mapping[str, Column], found: Mapping[str, Sign]) -> Sign:
    x = settled["x_in_mm"].values
    for name in ("f_out_N", "f_in_N"):
        if name not in settled:
            continue
        with_it = together(x, settled[name].values) * int(found[name][0])
        known = sign_of(settled[name].values) != 0
        if with_it > _CLEAR:
            return 1, f"it rises with {settled[name].shown}"
        if with_it < -_CLEAR and known:
            return -1, f"it falls where {settled[name].shown} pulls more"
        if with_it < -_CLEAR:
            why = f"it goes against {settled[name].shown}: one of the two counts the wrong way"
            return QUESTION, f"{why}; 1 or -1, so that it grows when the drive pulls"
    forces = [n for n in ("f_in_N", "f_out_N") if n in settled]
    if forces:
        return QUESTION, "no tension goes with it clearly; 1 or -1, so that it grows when pulled"
    return 1, "no tension shows its sign; it has to grow when the drive pulls"


def _load(settled: Mapping[str, Column], found: Mapping[str, Sign]) -> Sign:
    if "x_in_mm" not in settled:
        return 1, "no displacement at the drive shows its sign; it has to grow when pulled"
    drive = settled["x_in_mm"]
    with_it = together(drive.values, settled["x_out_mm"].values)
    if abs(with_it) < _CLEAR:
        return QUESTION, f"it does not go with {drive.shown}; 1 or -1, so that it grows when pulled"
    sign = found["x_in_mm"][0]
    if isinstance(sign, str):
        same = "the same as" if with_it > 0.0 else "the opposite of"
        return QUESTION, f"{same} that of x_in_mm, which it goes {_WITH[with_it > 0.0]}"
    return (sign if with_it > 0.0 else -sign), f"it goes {_WITH[with_it > 0.0]} {drive.shown}"


_WITH = {True: "with", False: "against"}
