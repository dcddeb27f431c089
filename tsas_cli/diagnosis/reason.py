"""The verdict of a diagnosis in a few plain sentences."""

import math
from collections.abc import Iterator, Mapping, Sequence

from tsas_cli.diagnosis.channel_errors import HeldOutErrors
from tsas_cli.diagnosis.evidence import Reduction
from tsas_cli.diagnosis.law import Law
from tsas_cli.diagnosis.proof import BY_NAME, FoundCause
from tsas_cli.diagnosis.remainder import LEAST_SLOW, Remainder
from tsas_cli.diagnosis.signals import signal_in_words
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.recordings.columns import BY_NAME as BY_COLUMN
from tsas_cli.records.base import number_text
from tsas_cli.records.diagnosis import Verdict
from tsas_cli.support.wording import listed

WITHIN_TOLERANCES = "no more than slow noise and the tolerances of load cells, bend and friction do"
NEAR = 0.1  # least reduction of the squares by an effect that comes near


def reason_of(
    verdict: Verdict,
    causes: Sequence[FoundCause],
    stand_ins: Sequence[FoundCause],
    channels: Mapping[str, HeldOutErrors],
    after: Remainder,
    law: Law | None = None,
    nearest: tuple[str, Reduction] | None = None,
) -> str:
    """Return the verdict in sentences: what is lacking, what it gains, what remains.

    `channels` are the residuals on held-out data with the causes, `after` is what remains with
    them, and `law` describes it. `nearest` is the effect that gains most alone.
    """
    if verdict == "sufficient":
        return _sufficient(after)
    if causes:
        sentences = [*_gain(causes, channels), *_of_each(causes)]
    else:
        sentences = [_residual(channels, stand_ins), *([] if stand_ins else _nearest(nearest))]
    sentences += _stand_ins(stand_ins)
    if not after.complete:
        if causes:
            sentences.append("No catalogued effect explains the remaining residual.")
        sentences += _dependence(after)
    elif causes and _exceeds_noise(after):
        without = f" without {'them' if stand_ins[1:] else 'it'}" if stand_ins else ""
        sentences.append(f"What is left{without}, {_over_noise(after)}, is {WITHIN_TOLERANCES}.")
    if law is not None:
        sentences.append(_law(law))
    return " ".join(text[0].upper() + text[1:] for text in sentences)


def _sufficient(after: Remainder) -> str:
    if _exceeds_noise(after):
        return (
            f"The nominal model leaves {_over_noise(after)}: {WITHIN_TOLERANCES}. "
            "These runs show no missing effect."
        )
    return "The nominal model is at the noise level: these runs show no missing effect."


def _exceeds_noise(after: Remainder) -> bool:
    return after.mean_square > 1.0 + LEAST_SLOW


def _over_noise(after: Remainder) -> str:
    return f"{_digits(math.sqrt(after.mean_square), 2)} × the noise level"


def _gain(causes: Sequence[FoundCause], channels: Mapping[str, HeldOutErrors]) -> Iterator[str]:
    names = listed([_title(cause.effect) for cause in causes])
    name, most = max(channels.items(), key=lambda it: _fall(it[1]))
    before, now = _distinct(most.rmse_before, most.rmse_after)
    yield f"The nominal model lacks: {names}."
    yield (
        f"With {'them' if causes[1:] else 'it'} the RMS of the residual of {name} on held-out "
        f"data falls from {before} to {now} {BY_COLUMN[name].unit}."
    )


def _of_each(causes: Sequence[FoundCause]) -> Iterator[str]:
    for cause in causes:
        if _only_together(cause):
            yield f"No parameter of {_title(cause.effect)} is significant alone; together they are."
    for cause in causes:
        if cause.law_differs:
            yield (
                f"The law of {_title(cause.effect)} differs from the catalogue's "
                f"{cause.law_differs}."
            )
    for cause in causes:
        if cause.rivals:
            rivals = listed([_title(rival) for rival in cause.rivals], " or ")
            yield f"These recordings do not distinguish {_title(cause.effect)} from {rivals}."


def _residual(channels: Mapping[str, HeldOutErrors], stand_ins: Sequence[FoundCause]) -> str:
    name, most = max(channels.items(), key=lambda it: it[1].rmse_before / it[1].noise_floor)
    which = "is proven" if stand_ins else "explains it"
    return (
        f"The RMS of the residual of {name} on held-out data is {_digits(most.rmse_before, 3)} "
        f"{BY_COLUMN[name].unit}, and no catalogued effect {which}."
    )


def _nearest(nearest: tuple[str, Reduction] | None) -> list[str]:
    """Return the effect that gains most, where it gains much."""
    if nearest is None or nearest[1].part < NEAR:
        return []
    effect, found = nearest
    takes = 100.0 * (1.0 - math.sqrt(1.0 - found.part))
    return [
        f"{_title(effect)} comes nearest: alone it takes {takes:.0f} % off it, which is not proven."
    ]


def _stand_ins(stand_ins: Sequence[FoundCause]) -> Iterator[str]:
    """Yield what the effects that are not proven take away, each beside those after it."""
    for failed in dict.fromkeys(cause.failed[0] for cause in stand_ins):
        alike = [cause for cause in stand_ins if cause.failed[0] == failed]
        names = listed([_title(cause.effect) for cause in alike])
        gains = listed([f"{cause.gain_percent:.0f}" for cause in alike])
        take, are, each = ("take", "are", "each") if alike[1:] else ("takes", "is", "it")
        later = [_title(cause.effect) for cause in stand_ins[stand_ins.index(alike[-1]) + 1 :]]
        beside = f" beside {listed(later)}" if later else ""
        yield f"{names} {take} {gains} % off it{beside}, but {are} not proven: {each} {failed}."


def _law(law: Law) -> str:
    falls = [
        f"{name} from {number_text(law.before.rmse[name])} to {number_text(now)} "
        f"{BY_COLUMN[name].unit}"
        for name, now in law.after.rmse.items()
        if now < law.before.rmse[name] and number_text(now) != number_text(law.before.rmse[name])
    ]
    beside = f", beside {listed([_title(e) for e in law.beside])}," if law.beside else ""
    return (
        f"A law of unnamed origin{beside} describes it: with it the RMS on held-out data falls "
        f"in {listed(falls)}."
    )


def _dependence(after: Remainder) -> list[str]:
    out = []
    if after.depends_on:
        out.append(f"It depends on {listed([signal_in_words(s) for s in after.depends_on])}.")
    if after.late:
        one = len(after.late) == 1
        verbs = ("lags", "leads") if one else ("lag", "lead")
        names = listed(after.late)
        out.append(f"At each reversal {names} {verbs[0]} behind the model, or {verbs[1]} it.")
    if after.brief:
        one = len(after.brief) == 1
        which, verb = ("channel", "deviates") if one else ("channels", "deviate")
        names = listed(after.brief)
        out.append(f"The {which} {names} {verb} from the model at a few moments of a run.")
    return out


def _only_together(cause: FoundCause) -> bool:
    """Return whether the interval of each of several parameters holds the neutral value."""
    sizes = [e for e in cause.parameters if not QUANTITIES[e.name].shape]
    return len(sizes) > 1 and all(e.holds(QUANTITIES[e.name].default) for e in sizes)


def _title(effect: str) -> str:
    return BY_NAME[effect].title.lower()


def _fall(channel: HeldOutErrors) -> float:
    """Return by how much the normalised residual of a channel falls."""
    return (channel.rmse_before - channel.rmse_after) / channel.noise_floor


def _distinct(before: float, after: float) -> tuple[str, str]:
    """Return two values to three digits, or to as many as show that they differ, five at most."""
    both = "", ""
    for digits in (3, 4, 5):
        both = _digits(before, digits), _digits(after, digits)
        if both[0] != both[1]:
            break
    return both


def _digits(value: float, digits: int) -> str:
    rounded = float(f"{value:.{digits}g}")
    return f"{rounded:#.{digits}g}" if rounded < 10.0 ** (digits - 1) else f"{rounded:.0f}"
