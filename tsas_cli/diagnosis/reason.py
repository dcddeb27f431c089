"""The verdict of a diagnosis in a few plain sentences."""

import math
from collections.abc import Sequence

from tsas_cli.diagnosis.law import Law
from tsas_cli.diagnosis.proof import BY_NAME, FoundCause
from tsas_cli.diagnosis.remainder import LEAST_SLOW, Remainder
from tsas_cli.diagnosis.signals import signal_in_words
from tsas_cli.recordings.columns import BY_NAME as BY_COLUMN
from tsas_cli.records.base import number_text
from tsas_cli.records.diagnosis import Verdict
from tsas_cli.support.wording import listed


def reason_of(
    verdict: Verdict,
    causes: Sequence[FoundCause],
    stand_ins: Sequence[FoundCause],
    start: Remainder,
    after: Remainder,
    law: Law | None = None,
) -> str:
    """Return the verdict in sentences: what is lacking, what it gains, what remains.

    `start` and `after` are the remaining residuals without and with the causes, `law` describes
    what remains.
    """
    sentences = []
    if causes:
        both = _distinct(math.sqrt(start.mean_square), math.sqrt(after.mean_square))
        names = listed([_title(cause.effect) for cause in causes])
        sentences += [
            f"The nominal model lacks: {names}.",
            f"With it the residual RMS falls from {both[0]} to {both[1]} × the noise level.",
        ]
        rivals = sorted({_title(r) for c in causes for r in c.rivals})
        sentences += [
            f"The law of {_title(c.effect)} differs from the catalogue's {c.law_differs}."
            for c in causes
            if c.law_differs
        ]
        if rivals:
            sentences.append(f"Indistinguishable from it in these recordings: {', '.join(rivals)}.")
    elif verdict == "sufficient" and after.mean_square > 1.0 + LEAST_SLOW:
        return (
            f"The nominal model leaves {_two_digits(math.sqrt(after.mean_square))} × the noise "
            "level: no more than slow noise and the tolerances of load cells, bend and friction "
            "do. These runs show no missing effect."
        )
    elif verdict == "sufficient":
        return "The nominal model is at the noise level: these runs show no missing effect."
    else:
        rms = _two_digits(math.sqrt(after.mean_square))
        sentences.append(
            f"The residual RMS is {rms} × the noise level, and no catalogued effect explains it."
        )
    for cause in stand_ins:
        gain = f"{_title(cause.effect)} takes {cause.gain_percent:.0f} % off it"
        sentences.append(f"{gain}, but is not proven: it {cause.failed[0]}.")
    if not after.complete:
        if causes:
            sentences.append("No catalogued effect explains the remaining residual.")
        sentences += _dependence(after)
    if law is not None:
        falls = [
            f"{name} from {number_text(law.before.rmse[name])} to "
            f"{number_text(law.after.rmse[name])} {BY_COLUMN[name].unit}"
            for name in law.after.rmse
        ]
        sentences.append(
            "A law of unnamed origin describes it: with it the RMS on held-out data falls in "
            f"{listed(falls)}."
        )
    return " ".join(text[0].upper() + text[1:] for text in sentences)


def _dependence(after: Remainder) -> list[str]:
    out = []
    if after.depends_on:
        out.append(f"It depends on {', '.join(signal_in_words(s) for s in after.depends_on)}.")
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


def _title(effect: str) -> str:
    return BY_NAME[effect].title.lower()


def _distinct(before: float, after: float) -> tuple[str, str]:
    """Return two values to two digits, or to as many as show that they differ, four at most."""
    both = _two_digits(before), _two_digits(after)
    if both[0] != both[1] or before >= 9.95:
        return both
    for digits in (3, 4):
        both = f"{before:#.{digits}g}", f"{after:#.{digits}g}"
        if both[0] != both[1]:
            break
    return both


def _two_digits(value: float) -> str:
    return f"{value:#.2g}" if value < 9.95 else f"{float(f'{value:.2g}'):.0f}"
