"""A copy: the stretch of a run whose samples are those of another run."""

import math
from dataclasses import dataclass

from tsas_cli.recordings.dataset import CONDITIONS
from tsas_cli.recordings.manifest import Run

WHOLE_SHARE = 0.98  # of a run's samples; the rest is its edges
CONDITION_TOLERANCE = 1e-3  # relative: 3.14 rad is π
ORDINALS = {1: "st", 2: "nd", 3: "rd"}


@dataclass(frozen=True)
class RowSpan:
    """Consecutive rows of a run, `end` excluded, and the times of the first and last [s]."""

    first: int
    end: int
    begin_s: float
    end_s: float

    @property
    def rows(self) -> int:
        """Number of rows."""
        return self.end - self.first

    @property
    def duration_s(self) -> float:
        """Duration [s]."""
        return self.end_s - self.begin_s


@dataclass(frozen=True)
class Copy:
    """A stretch of a run whose samples are those of another run."""

    run: Run  # that holds the copy
    other: Run  # the original
    span: RowSpan
    all_of_run: RowSpan
    all_of_other: RowSpan
    shift_s: float = 0.0  # of the samples to the other run's clock
    every: int = 1  # k if it holds every k-th sample of the original; 0 if it is interpolated
    contradicts: tuple[str, ...] = ()  # conditions that differ between the two in the manifest

    @property
    def whole(self) -> bool:
        """Whether the whole run is a copy."""
        return self.span.rows >= WHOLE_SHARE * self.all_of_run.rows

    @property
    def sentence(self) -> str:
        """Description of the copy, a predicate for the name of the run."""
        here = f"from {self.span.begin_s:.6g} s to {self.span.end_s:.6g} s"
        there = (self.span.begin_s + self.shift_s, self.span.end_s + self.shift_s)
        there_s = f"from {there[0]:.6g} s to {there[1]:.6g} s"
        if not self.whole:
            return f"holds, {here}, {self._samples} {there_s}{self._resampled}"
        if self.span.duration_s < WHOLE_SHARE * self.all_of_other.duration_s:
            return f"holds {self._samples} {there_s}{self._resampled}"
        shifted = abs(self.shift_s) * self.all_of_run.rows > self.all_of_run.duration_s
        by = f", its time shifted by {-self.shift_s:.6g} s" if shifted else ""
        return f"holds {self._samples}{self._resampled}{by}"

    @property
    def contradiction(self) -> str:
        """The differing conditions, as the end of a sentence; empty without any."""
        differing = [
            f"{name} = {_text(getattr(self.run, name))} here and "
            f"{_text(getattr(self.other, name))} there"
            for name in self.contradicts
        ]
        return f", but the manifest says {', '.join(differing)}" if differing else ""

    @property
    def _samples(self) -> str:
        other = f"run {self.other.id}"
        if self.every < 2:
            return f"the samples of {other}"
        tens = self.every % 100 in (11, 12, 13)
        ordinal = "th" if tens else ORDINALS.get(self.every % 10, "th")
        return f"every {self.every}{ordinal} sample of {other}"

    @property
    def _resampled(self) -> str:
        if self.every > 0:
            return ""
        return f", resampled at {(self.all_of_run.rows - 1) / self.all_of_run.duration_s:.5g} Hz"


def _text(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:.6g}"


def contradictions(run: Run, other: Run) -> tuple[str, ...]:
    """Return the conditions that differ between two runs by more than rounding."""
    stated = [(name, getattr(run, name), getattr(other, name)) for name in CONDITIONS]
    different = [
        name
        for name, a, b in stated
        if not (a is None or b is None or math.isclose(a, b, rel_tol=CONDITION_TOLERANCE))
    ]
    return (*different, "load") if run.load != other.load else tuple(different)
