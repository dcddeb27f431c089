"""Figs. 9 to 11: the force over time, its error, and the estimates of the adaptive controller."""

import math

import numpy as np

from tsas_cli.controllers.closed_loop import F_OUT, MEMORY_AT
from tsas_cli.paper import Paper
from tsas_cli.support.arrays import Floats
from tsas_cli.tracking.track import Tracked
from tsas_studies.reproduction.closed_loops import (
    CONDITIONS,
    NAMES,
    READINGS,
    Reading,
    followed,
    settings_for,
)
from tsas_studies.reproduction.group import Figure, Group, Line, Role, Row
from tsas_studies.reproduction.verdicts import holds

ADAPTIVE = "adaptive-sliding-mode"
ROLES: dict[str, Role] = {"pid": "muted", "sliding-mode": "before", ADAPTIVE: "after"}
RUNS: tuple[tuple[str, str, str, Role], ...] = (
    ("Fig. 9", "undisturbed", "two-frequency", "muted"),
    ("Fig. 10", "undisturbed", "sine", "after"),
    ("Fig. 11", "disturbed", "sine", "before"),
)
HALF_S = 4.0 * math.pi  # of Fig. 9: the text compares before and after
GREEK = ("φ1", "φ2", "φ3")
UNITS = ("rpm s³/mm", "rpm s/mm", "rpm s²/mm")
SETTLED = 0.02  # of an estimate's way so far
_HOW = (
    "Fig. 9 doubles the frequency of the reference for its first 2π s; Figs. 10 and 11 are the "
    "runs of Table 5. The curves of the paper have no printed numbers; what its text says of them "
    "is judged."
)


def figs_9_to_11(paper: Paper) -> Group:
    """Return the runs of the tracking experiments, and the statements about their courses."""
    del paper  # every printed number of these runs stands in Table 5's rows
    rows = [
        *(_smaller_later(reading) for reading in READINGS),
        *(_within_bounds(condition, reading) for condition in CONDITIONS for reading in READINGS),
        *(_settles(reading) for reading in READINGS),
    ]
    figures = [
        *(_errors(condition, reading) for condition in CONDITIONS for reading in READINGS),
        *(_estimate(i, reading) for reading in READINGS for i in range(3)),
    ]
    return Group(
        "figs-9-to-11",
        "Figs. 9 to 11: tracking over time",
        (_HOW,),
        tuple(rows),
        tuple(figures),
    )


def _error(run: Tracked) -> Floats:
    error: Floats = run.wanted_N - run.columns[F_OUT]
    return error


def _smaller_later(reading: Reading) -> Row:
    run = followed(ADAPTIVE, "undisturbed", reading, "two-frequency").run
    first = run.time_s < HALF_S
    early, late = (float(np.sqrt(np.mean(_error(run)[part] ** 2))) for part in (first, ~first))
    return holds(
        f"Fig. 9: RMSE after 4π s over that before, ks {reading}",
        "text, Verification of the proposed controller",
        true=late < early,
        criterion="in a ratio below 1",
        ours=late / early,
        because="it is not smaller",
        evidence=f"RMSE {early:.4f} N before and {late:.4f} N after; the reference is twice as "
        "fast in its first part.",
    )


def _estimates(run: Tracked) -> Floats:
    return run.columns[MEMORY_AT : MEMORY_AT + 3]


def _within_bounds(condition: str, reading: Reading) -> Row:
    law = settings_for(reading).controllers.adaptive_sliding_mode
    run = followed(ADAPTIVE, condition, reading).run
    at_bound = [
        100.0 * float(np.mean((phi <= low) | (phi >= high)))
        for phi, low, high in zip(_estimates(run), law.lowest, law.highest, strict=True)
    ]
    ends = ", ".join(
        f"{name} {start:.3g} → {phi[-1]:.3g}"
        for name, start, phi in zip(GREEK, law.phi, _estimates(run), strict=True)
    )
    return holds(
        f"the estimates stay inside their bounds, {condition}, ks {reading}",
        "text, Case 1 and 2",
        true=max(at_bound) == 0.0,
        criterion="without the projection at work",
        because="the projection holds "
        + ", ".join(f"{n} for {b:.0f} %" for n, b in zip(GREEK, at_bound, strict=True) if b > 0.0)
        + " of the time at a bound",
        evidence=f"{ends}.",
    )


def _settles(reading: Reading) -> Row:
    run = followed(ADAPTIVE, "undisturbed", reading, "two-frequency").run
    phi2 = _estimates(run)[1]
    last = phi2[run.time_s >= run.time_s[-1] - 2.0 * math.pi]
    way, drift = abs(phi2[-1] - phi2[0]), abs(last[-1] - last[0])
    return holds(
        f"Fig. 9: the parameters stabilise at last, ks {reading}",
        "text, Verification of the proposed controller",
        true=drift <= SETTLED * way,
        criterion=f"in φ2 changing over the last period by at most {100 * SETTLED:g} % of its way",
        because=f"φ2 still moves by {drift:.3g} rpm s/mm a period, {100.0 * drift / way:.0f} % of "
        "its way so far",
        evidence=f"φ2 goes from {phi2[0]:.4g} to {phi2[-1]:.4g} rpm s/mm in "
        f"{run.time_s[-1]:.1f} s.",
    )


def _errors(condition: str, reading: Reading) -> Figure:
    lines = []
    for name, label in NAMES.items():
        run = followed(name, condition, reading).run
        lines.append(Line(label, run.time_s, _error(run), ROLES[name]))
    number = "10" if condition == "undisturbed" else "11"
    return Figure(
        f"fig-{number}-{reading.replace(' ', '-')}",
        f"Fig. {number}, {condition}, ks {reading}: error of the force over time, one seed.",
        ("time [s]", "wanted less true f_out [N]"),
        tuple(lines),
        part=f"ks {reading}",
    )


def _estimate(i: int, reading: Reading) -> Figure:
    lines = []
    for label, condition, shape, role in RUNS:
        run = followed(ADAPTIVE, condition, reading, shape).run
        lines.append(Line(label, run.time_s, _estimates(run)[i], role))
    return Figure(
        f"phi{i + 1}-{reading.replace(' ', '-')}",
        f"Estimate of {GREEK[i]} over time, ks {reading}.",
        ("time [s]", f"{GREEK[i]} [{UNITS[i]}]"),
        tuple(lines),
        part=f"ks {reading}",
    )
