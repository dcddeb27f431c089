"""A fault of the recording in a sentence, and what to do about it."""

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import combinations

import numpy as np

from tsas_cli.diagnosis.faults.beside import Candidate
from tsas_cli.diagnosis.faults.candidates import MOST_SCATTER
from tsas_cli.diagnosis.friction_scatter import OF_A_LINE, SCATTER, on_a_line
from tsas_cli.diagnosis.remainder import Remainder
from tsas_cli.identification.against_data_sheet import SHEET
from tsas_cli.identification.model import UNKNOWN_BEND_RAD
from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.recordings.manifest import Run
from tsas_cli.records.base import number_text
from tsas_cli.records.diagnosis import RecordingFault
from tsas_cli.support.arrays import Floats
from tsas_cli.support.wording import listed

REMEDY = "Correct it{} and diagnose again"
STIFFER = "tendon-stiffness"
PULLEYS = "a part that does not grow with the bend (pulley_friction), "
LEAST_BENDS = 0.2  # range of the bends over the largest, by which a friction is judged
IN_LINE = 0.1  # of the variance of the frictions, that a line over 1/bend leaves
AS_EXCHANGED = 0.2  # of the range of the frictions, that is left where two bends are exchanged
LEFT_OUT = ", or leave the run out with --runs,"


def record_of(found: Sequence[Candidate], runs: Sequence[str]) -> RecordingFault:
    """Return the record of the best of some faults, the others named as rivals in its sentence."""
    best = found[0]
    sentence = _sentence(best, runs)
    if found[1:]:
        sentence += f"; as likely: {'; '.join(_sentence(c, runs) for c in found[1:])}"
    return RecordingFault(
        code=best.code,
        run=None if best.run is None else runs[best.run],
        column=best.channels[0] if best.channels else None,
        sentence=sentence,
        first_s=best.first_s,
    )


def reason_of_fault(fault: RecordingFault, share: float) -> str:
    """Return the verdict where a fault explains a share of what the nominal model leaves."""
    remedy = REMEDY.format("" if fault.run is None else LEFT_OUT)
    return (
        f"A fault of the recordings explains {100.0 * min(share, 1.0):.0f} % of what the nominal "
        f"model leaves beyond the noise: {fault.sentence}. {remedy}, or accept it with --despite "
        f"{fault.code}."
    )


def wandering(left: Remainder) -> RecordingFault | None:
    """Return that a channel wanders, where what is left follows no signal of the motion."""
    name = left.wanders
    if name is None:
        return None
    slow = left.slow[name]
    sentence = (
        f"{name} wanders by {slow.ratio:.2g} times its noise within {slow.time_s:.2g} s and "
        "follows no signal of the motion, as of an amplifier or a mounting that drifts"
    )
    return RecordingFault(code="wanders", column=name, sentence=sentence)


def differing(frictions: Floats, runs: Sequence[Run]) -> RecordingFault | None:
    """Return that the frictions of the runs, shares over their mean, differ by more than scatter.

    Of many runs the extremes are said.
    """
    if not frictions.size or np.abs(frictions).max() <= MOST_SCATTER * SCATTER:
        return None
    order = np.argsort(frictions)
    said = [f"{100.0 * frictions[k]:+.0f} % (run {runs[k].id})" for k in (order[0], order[-1])]
    bends_rad = np.array([run.total_bend_rad or UNKNOWN_BEND_RAD for run in runs])
    sentence = (
        f"Friction differs from run to run by {' to '.join(said)}, as by "
        + (PULLEYS if _falls_with(bends_rad, frictions) else "humidity, lubrication or wear, ")
        + (
            f"or where the stated bends are wrong{_exchanged(bends_rad, frictions, runs)}"
            if all(run.total_bend_rad for run in runs)
            else "or where the bends differ: state total_bend_rad of each run"
        )
    )
    return RecordingFault(code="run-frictions", sentence=sentence)


def _exchanged(bends_rad: Floats, frictions: Floats, runs: Sequence[Run]) -> str:
    """Return which two bends, exchanged, make the frictions the same, or nothing."""
    spread = {}
    for a, b in combinations(range(frictions.size), 2):
        exchanged = bends_rad.copy()
        exchanged[[a, b]] = bends_rad[[b, a]]
        friction = (1.0 + frictions) * bends_rad / exchanged
        spread[a, b] = float(np.ptp(friction / friction.mean()))
    best = min(spread, key=spread.__getitem__)
    if spread[best] > AS_EXCHANGED * np.ptp(frictions):
        return ""
    one, other = (runs[k].id for k in best)
    return (
        f": with those of runs {one} and {other} exchanged it is the same to within "
        f"{100.0 * spread[best]:.1g} %"
    )


def _falls_with(bends_rad: Floats, frictions: Floats) -> bool:
    """Return whether friction per bend falls as where a part of it does not grow with the bend."""
    if frictions.size <= OF_A_LINE or np.ptp(bends_rad) < LEAST_BENDS * bends_rad.max():
        return False
    fitted = on_a_line(1.0 / bends_rad, frictions)
    falls = fitted[np.argmin(bends_rad)] > fitted[np.argmax(bends_rad)]
    return bool(falls and np.var(frictions - fitted) < IN_LINE * np.var(frictions))


def stiffer_tendon(ratio: float) -> RecordingFault:
    """Return that the tendon is stiffer than its data sheet by a ratio."""
    said = f"the tendon is {number_text(ratio)} times as stiff as the manifest says, by {SHEET}"
    return RecordingFault(code=STIFFER, sentence=said)


def _sentence(c: Candidate, runs: Sequence[str]) -> str:
    where = "" if c.run is None else f"run {runs[c.run]}: "
    return f"{where}{_SAID[c.code](c)}{_when(c)}"


def _when(c: Candidate) -> str:
    if c.steps:
        return ""
    if c.first_s is not None and c.last_s is not None:
        return f" from about {c.first_s:.3g} to {c.last_s:.3g} s"
    if c.first_s is not None:
        return f" since about {c.first_s:.3g} s"
    return "" if c.last_s is None else f" until about {c.last_s:.3g} s"


def _more(amount: float) -> str:
    return "more" if amount > 0.0 else "less"


def _offset(c: Candidate) -> str:
    (name,) = c.channels
    said = (
        f"{name} reads {abs(c.amount):.2g} {BY_NAME[name].unit} {_more(c.amount)} than the other "
        "runs and channels fit"
    )
    slips = name.startswith("x_") and c.first_s is not None
    return f"{said}, as of an encoder or a clamp that slips," if slips else said


def _gain(c: Candidate) -> str:
    (name,) = c.channels
    return f"{name} reads {100.0 * abs(c.amount):.2g} % {_more(c.amount)} than in the other runs"


def _delay(c: Candidate) -> str:
    verb = ("comes", "come")[len(c.channels) > 1]
    way = "later" if c.amount > 0.0 else "earlier"
    late = f"{1e3 * abs(c.amount):.3g} ms"
    return f"{listed(c.channels)} {verb} {late} {way} than the other channels"


def _lag(c: Candidate) -> str:
    return f"{listed(c.channels)} lags, as behind a low pass of {1e3 * c.amount:.3g} ms"


def _lost(c: Candidate) -> str:
    return f"samples of {listed(c.channels)} are lost: {_delay(c)}"


def _repeated(c: Candidate) -> str:
    return f"samples of {listed(c.channels)} are repeated: {_delay(c)}"


def _clock(c: Candidate) -> str:
    way = "slower" if c.amount > 0.0 else "faster"
    return (
        f"the clock of {listed(c.channels)} runs {100.0 * abs(c.amount):.2g} % {way} than that of "
        "the other channels"
    )


def _friction(c: Candidate) -> str:
    said = (
        f"its friction is {math.exp(c.amount):.3g} times that of the other runs, as if its "
        "total_bend_rad were that many times what is stated or assumed"
    )
    if not c.alone:
        return said
    return (
        f"{said}; no other run has its bend: friction that does not grow with it, as of pulleys, "
        "fits too"
    )


def _length(c: Candidate) -> str:
    return (
        f"its tendon is {math.exp(c.amount):.3g} times as stiff as in the other runs, as if its "
        f"sheath_length_mm were {math.exp(-c.amount):.3g} times what is stated or assumed"
    )


def _coupled(c: Candidate) -> str:
    (name,) = c.channels
    return (
        f"{name} loses its constant part within about {c.amount:.2g} s, as behind an amplifier "
        "coupled to AC"
    )


def _step(c: Candidate) -> str:
    (name,) = c.channels
    unit = BY_NAME[name].unit
    steps = [f"{abs(d):.2g} {unit} {_more(d)} since about {t:.3g} s" for t, d in c.steps]
    return (
        f"{name} reads {listed(steps)}, as of an encoder that misses counts or slips, or a tendon "
        "that slips in its clamp"
    )


def _saturates(c: Candidate) -> str:
    (name,) = c.channels
    level = f"{c.amount:.3g} {BY_NAME[name].unit}"
    return f"{name} reads less than it should beyond about {level}, as a sensor that saturates"


def _hum(c: Candidate) -> str:
    (name,) = c.channels
    return f"{name} swings at {c.amount:.3g} Hz in all runs, whatever the motion"


_SAID: Mapping[str, Callable[[Candidate], str]] = {
    "run-offset": _offset,
    "run-gain": _gain,
    "run-delay": _delay,
    "run-lag": _lag,
    "lost-samples": _lost,
    "repeated-buffer": _repeated,
    "clock": _clock,
    "ac-coupled": _coupled,
    "run-friction": _friction,
    "run-length": _length,
    "hum": _hum,
    "run-step": _step,
    "saturates": _saturates,
}
CODES = (*_SAID, STIFFER)
