"""What the nominal drive equation lacks: the verdict, its causes and their gains.

Nominal is Yang 2025, Eqs. (23)-(25):

    (J/r1²) d²x/dt² + B dx/dt + k_p x = k_d x_m,  dx_m/dt = K u

Where the data sheet gives J, r1 and k_p, its natural frequency is known, and k_d and B are fitted.
Where it does not, any frequency could be its own; then nominal is what the equation says of slow
motion, x = g ∫u dt, and a spring with inertia behind it is what the drive was not said to have. So
it is where the drive shows neither that frequency nor another one: it is stiff.
"""

import math

import numpy as np

from tsas_cli.diagnosis.diagnose import FEW_BLOCKS
from tsas_cli.diagnosis.evidence import gain, gain_percent
from tsas_cli.diagnosis.proven import SEED
from tsas_cli.diagnosis.regression import hats, regressed
from tsas_cli.diagnosis.remainder import DEPENDS
from tsas_cli.diagnosis.search import EXCESS_OF_COMPLETE_MODEL
from tsas_cli.drive.fit import Terms
from tsas_cli.drive.search import EFFECT_OF, NOTHING, DriveSearch, rivals
from tsas_cli.drive.sentences import EQUATION_NAME, STIFF_NAME, next_run
from tsas_cli.effects import EFFECTS
from tsas_cli.identification.estimate import Estimate
from tsas_cli.records.base import Value, number_text
from tsas_cli.records.diagnosis import HeldOut, RemainingResidual, Verdict
from tsas_cli.records.drive import DriveCause, DriveDiagnosis, DriveEvidence
from tsas_cli.support.arrays import Floats, Indices
from tsas_cli.support.wording import listed

EQUATION = frozenset({"stated"})
MOST_SHARE_LEFT = 0.02  # of the initial excess over the noise, that named causes may leave
MOST_LEFT = 4.0  # mean square of the residual, twice the noise level, that causes may leave
UNEXPLAINED_SHARE = 0.5  # of the excess, beyond which the verdict is `unexplained`
NEEDS_CAUSE = 2.0 * EXCESS_OF_COMPLETE_MODEL  # excess of the mean square that needs an explanation
LOOKED_AT = 12000  # residuals, for what is left
PARAMETERS = {
    "drive_compliance": (
        "compliance_mm_per_N", "drive_stiffness_N_per_mm", "natural_frequency_Hz", "damping_ratio",
    ),
    "channel_delay": ("motor_lag_s", "delay_s"),
    "drive_ripple": ("sine_mm", "cosine_mm"),
    "backlash": ("play_mm",),
}  # fmt: skip
KIND = {"lag": "first-order lag", "delay": "pure delay"}
TITLES = {effect.name: effect.title for effect in EFFECTS}


def diagnose_drive(
    search: DriveSearch, final: Terms, estimates: dict[str, Estimate]
) -> tuple[Terms, DriveDiagnosis]:
    """Return the nominal terms, and what was found compared with them."""
    nominal = _nominal(search, final)
    better = search.gain(nominal, final).convincing
    causes = tuple(
        cause
        for effect in PARAMETERS
        if better and (cause := _cause(search, nominal, final, effect, estimates)) is not None
    )
    explained = final if causes else nominal
    start, left = search.mean_square(nominal), search.mean_square(explained)
    share = max(left - 1.0 - EXCESS_OF_COMPLETE_MODEL, 0.0) / (start - 1.0) if start > 1.0 else 0.0
    depends, could = _left(search, explained)
    before, after = (_rmse(search, terms) for terms in (nominal, explained))
    floor = min(_noise(search), after)  # so that what is attainable is no more than what is reached
    attainable = max(floor, after * math.sqrt(1.0 - could))
    gained, low, high = _gain_percent(search, nominal, explained)
    verdict = _verdict(search, causes, left, share)
    leaves_much = left > MOST_LEFT or (
        left > 1.0 + EXCESS_OF_COMPLETE_MODEL and share > MOST_SHARE_LEFT
    )
    how = "Stretches are predicted by a fit to the rest"
    if search.folds.by_run:
        how = "Each run is predicted by a fit to the others"
    found = DriveDiagnosis(
        verdict=verdict,
        reason="",
        nominal=EQUATION_NAME if nominal else STIFF_NAME,
        named=causes,
        gain_percent=gained,
        gain_interval_percent=(low, high),
        channels={
            "x_in_mm": HeldOut(
                unit="mm",
                rmse_before=before,
                rmse_after=after,
                noise_floor=floor,
                attainable=attainable,
            )
        },
        remainder=RemainingResidual(
            unexplained=verdict == "unexplained" or (bool(causes) and leaves_much),
            depends_on=depends if left > 1.0 + EXCESS_OF_COMPLETE_MODEL else (),
            share_percent=100.0 * share if causes else 100.0,
            mean_square=left,
        ),
        evidence=DriveEvidence(
            held_out="runs" if search.folds.by_run else "stretches",
            blocks=search.folds.blocks,
            sentence=f"{how}; {search.folds.blocks} blocks longer than the error's memory count.",
        ),
    )
    said = {"reason": reason_of(found, start, left), "next_experiment": next_run(found)}
    return nominal, found.model_copy(update=said)


def _nominal(search: DriveSearch, final: Terms) -> Terms:
    """Return the nominal equation: of a drive that shows no resonance, that of a stiff one."""
    if search.bench.stated_Hz is None:
        return NOTHING
    if "spring" in final or not search.gain(EQUATION, final).convincing:
        return EQUATION
    return NOTHING


def _verdict(
    search: DriveSearch, causes: tuple[DriveCause, ...], left: float, share: float
) -> Verdict:
    if search.folds.blocks < FEW_BLOCKS:
        return "undecided"
    if not causes:
        return "unexplained" if left > 1.0 + NEEDS_CAUSE else "sufficient"
    if share > UNEXPLAINED_SHARE:
        return "unexplained"
    return "ambiguous" if any(cause.rivals for cause in causes) else "named"


def _cause(
    search: DriveSearch, nominal: Terms, final: Terms, effect: str, estimates: dict[str, Estimate]
) -> DriveCause | None:
    """Return an effect as a cause, or None where the nominal equation does as well without it."""
    own = frozenset(term for term in final if EFFECT_OF.get(term) == effect)
    fewer = final - own
    if effect == "drive_compliance":
        fewer = fewer | nominal  # the equation has a spring of its own, only no reaction
    if not own or not search.gain(fewer, final).convincing:
        return None
    if number_text(_rmse(search, fewer)) == number_text(_rmse(search, final)):
        return None  # the tables would show no gain
    present = {EFFECT_OF.get(term) for term in final}
    instead = dict.fromkeys(
        f"channel_delay ({KIND[other]})" if EFFECT_OF[other] in present else EFFECT_OF[other]
        for term in sorted(own)
        if len(own) == 1
        for other in rivals(search, final, term)
    )
    gained, low, high = _gain_percent(search, fewer, final)
    kind = " and ".join(KIND[term] for term in sorted(own) if term in KIND)
    return DriveCause(
        effect=effect,
        title=f"{kind.capitalize()} of the motor" if kind else TITLES[effect],
        kind=kind,
        rivals=tuple(instead),
        parameters={
            name: Value.model_validate(estimates[name], from_attributes=True)
            for name in PARAMETERS[effect]
            if name in estimates
        },
        gain_percent=gained,
        gain_interval_percent=(low, high),
    )


def _gain_percent(search: DriveSearch, before: Terms, after: Terms) -> tuple[float, float, float]:
    rng = np.random.default_rng(SEED)
    return gain_percent(search.held_out(before), search.held_out(after), rng)


def _noises(search: DriveSearch) -> Floats:
    """Return the noise of the run that each block lies in, shape (blocks,)."""
    noise = np.array([run.noise_mm for run in search.bench.runs])
    first = np.unique(search.folds.block, return_index=True)[1]
    return np.asarray(noise[search.folds.run[first]])


def _rmse(search: DriveSearch, terms: Terms) -> float:
    squares = float(np.sum(search.held_out(terms) * _noises(search) ** 2))
    return math.sqrt(squares / search.folds.block.size)


def _noise(search: DriveSearch) -> float:
    samples = np.bincount(search.folds.block)
    return math.sqrt(float(samples @ _noises(search) ** 2) / search.folds.block.size)


def _left(search: DriveSearch, terms: Terms) -> tuple[tuple[str, ...], float]:
    """Return the signals that the rest depends on, and the part of it that they explain."""
    residual, folds = search.trial(terms).solution.residual, search.folds
    chosen = np.arange(0, residual.size, max(1, residual.size // LOOKED_AT))
    runs = search.bench.runs
    signals = {
        "x_in_mm": np.concatenate([run.x_in[run.counts] for run in runs]),
        "motor_speed_rpm": np.concatenate([run.u.values[run.counts] for run in runs]),
        "motor_angle_rad": np.concatenate(
            [run.u.integral[run.counts] * math.pi / 30.0 for run in runs]
        )
        % (2.0 * math.pi),
        "time_s": np.concatenate([run.time_s[run.counts] for run in runs]),
    }
    direction = np.sign(signals["motor_speed_rpm"])[chosen]
    here, block, fold = residual[chosen], folds.block[chosen], folds.fold[chosen]
    columns = {name: hats(values[chosen], direction) for name, values in signals.items()}
    total = float(here @ here)
    alone = {name: _part(c, here, fold) for name, c in columns.items()}
    depends = sorted((n for n, part in alone.items() if part > DEPENDS), key=lambda n: -alone[n])
    whole = here - regressed(np.hstack(list(columns.values())), here, fold)
    before, after = (np.bincount(block, v**2, minlength=folds.blocks) for v in (here, whole))
    used = before > 0.0
    best = gain(before[used].astype(np.float64), after[used].astype(np.float64))
    return tuple(depends), max(best.part, 0.0) if best.convincing and total > 0.0 else 0.0


def _part(columns: Floats, residual: Floats, fold: Indices) -> float:
    own = residual - regressed(columns, residual, fold)
    return 1.0 - float(own @ own) / float(residual @ residual)


def reason_of(found: DriveDiagnosis, start: float, left: float) -> str:
    """Return what the verdict rests on; mean squares of the residual at the start and left."""
    equation = (
        "The nominal drive equation (Yang 2025, Eq. 25, without reaction)"
        if found.nominal == EQUATION_NAME
        else "A drive without lag and stiffness, x_in = g ∫u dt,"
    )
    times = [f"{math.sqrt(v):.3g}" for v in (start, left)]
    if found.verdict == "undecided":
        return "too few stretches of these runs are independent of each other."
    if found.verdict == "sufficient":
        return f"{equation} is at the noise level: these runs show no missing effect."
    residual = f"{equation} leaves a residual RMS of x_in of {times[0]} × the noise level"
    on = found.remainder.depends_on
    depends = f" It depends on {', '.join(on)}." if on else ""
    if not found.named:
        return f"{residual}, and no catalogued effect of a drive explains it.{depends}"
    causes = " and ".join(_spoken(cause) for cause in found.named)
    text = (
        f"{residual}. It lacks: {causes}. With it the residual RMS is {times[1]} × the noise level."
    )
    for cause in found.named:
        if cause.rivals:
            others = listed(cause.rivals, " or ")
            text += f" These recordings do not distinguish {_spoken(cause)} from {others}."
    rest = f" No catalogued effect explains the remaining residual.{depends}"
    return text + rest if found.remainder.unexplained else text


def _spoken(cause: DriveCause) -> str:
    if cause.effect == "drive_compliance":
        return "the compliance of the drive, whose stiffness reacts on the position"
    return f"a {cause.kind} of the motor" if cause.kind else f"the {cause.title.lower()}"
