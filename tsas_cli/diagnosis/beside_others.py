"""What refuses a cause because of the others that gain, or of what they all leave."""

from collections.abc import Iterable, Sequence

from tsas_cli.diagnosis.proof import BY_NAME, FoundCause
from tsas_cli.diagnosis.remainder import Remainder, share_left
from tsas_cli.effects.channel_delay import CHANNEL_DELAY
from tsas_cli.effects.sensor_lag import SENSOR_LAG
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.support.wording import listed

SENSORS = ("f_in", "f_out", "x_out")
MOST_OF_A_SENSOR = 2  # errors of one sensor; more are a law of it that the catalogue lacks
HARMONIC = 0.1  # relative, of the ratio of two periods
PARTS = 4  # of a rig that effects act at: drive, tendon, load, sensors
SOME_PARTS = 3  # of them, where more than noise is left
MOST_LEFT = 0.1  # of what could be explained, by all causes together
TIMES = (CHANNEL_DELAY.name, SENSOR_LAG.name)
OPPOSITE = 0.3  # of a lag, that a lead differs from it by at most


def beside_each_other(
    causes: tuple[FoundCause, ...], stand_ins: tuple[FoundCause, ...]
) -> tuple[FoundCause, ...]:
    """Return causes, refused where another one, or a stand-in, does what they do."""
    for beside in (beside_another_law, beside_a_wave, beside_its_opposite):
        causes = tuple(beside(cause, causes) for cause in causes)
    gaining = (*causes, *stand_ins)
    return tuple(beside_others_of_its_sensor(cause, gaining) for cause in causes)


def beside_another_law(cause: FoundCause, causes: Sequence[FoundCause]) -> FoundCause:
    """Return a cause, refused where one that gains more acts at its place by a law of its own.

    What that law lacks, a curve of another kind of a sensor or a wave, is no cause of its own.
    """
    for other in causes:
        alike = may_be_of_the_law_of(cause.effect, other.effect)
        if other.law_differs and alike and other.gain_percent > cause.gain_percent:
            title = BY_NAME[other.effect].title.lower()
            said = f"acts where {title} does, whose law differs from the catalogue's"
            return cause.refused(said)
    return cause


def beside_its_opposite(cause: FoundCause, causes: Sequence[FoundCause]) -> FoundCause:
    """Return a delay or a low pass, refused where a channel leads by as much as it lags.

    Together they round its corners alone, which is another effect's.
    """
    if cause.effect not in TIMES:
        return cause
    times = {e.name.partition(".")[2]: e.value for one in causes for e in one.parameters}
    for sensor in sorted(sensors_of(cause)):
        delay_s, lag_s = (times.get(f"{sensor}_{kind}_s", 0.0) for kind in ("delay", "lag"))
        if lag_s > 0.0 and abs(delay_s + lag_s) < OPPOSITE * lag_s:
            said = (
                f"is undone in {sensor}, which leads by {-delay_s:.2g} s and lags by {lag_s:.2g} s"
            )
            return cause.refused(said)
    return cause


def beside_others_of_its_sensor(cause: FoundCause, gaining: Sequence[FoundCause]) -> FoundCause:
    """Return a cause, refused where many effects that gain are errors of the same sensor."""
    for sensor in sorted(sensors_of(cause)):
        errors = sum(sensor in sensors_of(other) for other in gaining)
        if errors > MOST_OF_A_SENSOR:
            said = f"is one of {errors} errors of the {sensor} sensor, which may be one law of it"
            return cause.refused(said)
    return cause


def beside_a_wave(cause: FoundCause, causes: Sequence[FoundCause]) -> FoundCause:
    """Return a cause, refused where it may be a harmonic of a wave that gains more."""
    for other in causes:
        periods = [
            estimate.value
            for one in (cause, other)
            for estimate in one.parameters
            if estimate.name == BY_NAME[one.effect].period
        ]
        waves = len(periods) == 2 and other.gain_percent > cause.gain_percent
        if waves and is_harmonic(*periods):
            said = f"may be a harmonic of {BY_NAME[other.effect].title.lower()}"
            return cause.refused(said)
    return cause


def beside_what_is_left(
    cause: FoundCause, start: Remainder, after: Remainder, interval_s: float
) -> FoundCause:
    """Return a cause, refused where much is left: an effect that is alike may take the rest too.

    So may what effects of three parts of a rig do as well. A delay by less than half a sample
    interval is where anything is left: what is wrong at each reversal looks so.
    """
    if after.complete:
        return cause
    left = share_left(start, after)
    if left > MOST_LEFT:
        cause = cause.refused(f"leaves {100.0 * left:.0f} % of what could be explained")
    parts = parts_of((cause.effect, *cause.rivals))
    if len(parts) >= SOME_PARTS and len(after.explained) > 1:  # one channel never tells the place
        said = f"does what effects of the {listed(sorted(parts))} do as well, and more is wrong"
        cause = cause.refused(said)
    if cause.effect == CHANNEL_DELAY.name and all(
        abs(e.value) < 0.5 * interval_s for e in cause.parameters
    ):
        cause = cause.refused("is less than half a sample interval, and more is wrong")
    return cause


def may_be_anywhere(names: Iterable[str]) -> bool:
    """Return whether effects that are indistinguishable act at every part of a rig."""
    return len(parts_of(names)) == PARTS


def parts_of(names: Iterable[str]) -> set[str]:
    """Return the parts of a rig that effects act at."""
    return {BY_NAME[name].acts_on for name in names}


def may_be_of_the_law_of(effect: str, other: str) -> bool:
    """Return whether an effect may be what another one's law lacks: its sensor's, or a wave."""
    places = [
        e.name.partition("_sensor_")[0] if e.acts_on == "sensor" else e.acts_on
        for e in (BY_NAME[effect], BY_NAME[other])
    ]
    wave = BY_NAME[effect].period is not None
    return places[0] == places[1] and (wave or BY_NAME[effect].acts_on == "sensor")


def is_harmonic(period: float, of: float) -> bool:
    """Return whether a wave's period is a half or a third of another one's, whose place may differ.

    The load moves a little less than the drive, so that a period there is shorter.
    """
    return any(abs(of / period - n) < HARMONIC * n for n in (2, 3))


def sensors_of(cause: FoundCause) -> set[str]:
    """Return the sensors that a cause is an error of, by its parameters that differ from none."""
    if BY_NAME[cause.effect].acts_on != "sensor":
        return set()
    there = [e for e in cause.parameters if not e.holds(QUANTITIES[e.name].default)]
    names = [e.name.partition(".")[2] for e in there]
    return {sensor for sensor in SENSORS if any(n.startswith(f"{sensor}_") for n in names)}
