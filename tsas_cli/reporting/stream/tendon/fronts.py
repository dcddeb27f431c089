"""When slip fronts came through, among the run's events."""

from collections.abc import Mapping

from tsas_cli.physics.passages import ends_of
from tsas_cli.reporting.stream.events import Event, record_events
from tsas_cli.reporting.stream.recorder import Recorder
from tsas_cli.reporting.stream.seen import SeenRun
from tsas_cli.reporting.stream.sources import Which
from tsas_cli.reporting.stream.tendon.followed import Followed

FRONTS = "fronts"
_WORDS = {1: "pulled", -1: "let go"}


def record_passages(recorder: Recorder, run: SeenRun, tendons: Mapping[Which, Followed]) -> None:
    """Record when the front of each stroke has reached the load, or that it never did."""
    for which, one in tendons.items():
        events = sorted(_events(run.id, which, one), key=lambda event: event.at_s)
        record_events(recorder, run, f"{FRONTS}-{which.key}", events)


def _events(run: str, which: Which, one: Followed) -> list[Event]:
    time_s, found = one.sample_time_s, []
    for passage, end in zip(one.passages, ends_of(one.passages, time_s.size - 1), strict=True):
        way = _WORDS[passage.direction]
        if passage.arrived is None:
            text = f"the slip front has not reached the load since the drive {way}"
            found.append(Event(float(time_s[end]), f"{run}: {which.label}: {text}"))
            continue
        took = float(time_s[passage.arrived] - time_s[passage.start])
        text = f"the slip front reaches the load, {took:.3g} s after the drive {way}"
        found.append(Event(float(time_s[passage.arrived]), f"{run}: {which.label}: {text}"))
    return found
