"""What a table or figure of the paper becomes: rows, each with a verdict, and curves to draw."""

from dataclasses import dataclass
from typing import Any, Literal

from tsas_cli.support.arrays import Floats

Verdict = Literal["agrees", "differs", "cannot tell"]
Role = Literal["measured", "ink", "muted", "simulated", "before", "after", "alike", "dead-band-up"]

VERDICTS: tuple[Verdict, ...] = ("agrees", "differs", "cannot tell")


@dataclass(frozen=True)
class Row:
    """One number or statement of the paper beside ours; made by the functions of `verdicts`.

    `paper` and `ours` have the unit `unit`; either is None where there is no number. `criterion`
    is what "agrees" means here, `because` why it does not agree or cannot be determined, and
    `evidence` the numbers behind that.
    """

    what: str
    source: str
    unit: str
    paper: float | None
    ours: float | None
    verdict: Verdict
    criterion: str
    because: str
    evidence: str

    @property
    def ratio(self) -> float | None:
        """Ours over the paper's, None where one of them is missing or the paper's is zero."""
        return self.ours / self.paper if self.ours is not None and self.paper else None

    @property
    def words(self) -> str:
        """The verdict as a person reads it."""
        if self.verdict == "agrees":
            return f"agrees {self.criterion}"
        if self.verdict == "differs":
            return f"differs (not {self.criterion}), because {self.because}"
        return f"cannot be determined, because {self.because}"

    def as_json(self) -> dict[str, Any]:
        """Return the row as it is written."""
        numbers = ("what", "source", "paper", "ours", "unit", "ratio")
        judged = ("verdict", "criterion", "because", "evidence")
        return {name: getattr(self, name) for name in numbers + judged}


@dataclass(frozen=True)
class Line:
    """One curve, shape (n,) each; `dashed` for what is no model, a `mark` for single points."""

    label: str
    x: Floats
    y: Floats
    role: Role
    dashed: bool = False
    mark: str = ""


@dataclass(frozen=True)
class Figure:
    """Curves over one pair of axes; `part` names the fold that it stands in, empty for none."""

    key: str
    caption: str
    axes: tuple[str, str]
    lines: tuple[Line, ...]
    part: str = ""


@dataclass(frozen=True)
class Group:
    """A table or figure of the paper: how it is done again, rows, figures, what follows."""

    anchor: str
    title: str
    intro: tuple[str, ...] = ()
    rows: tuple[Row, ...] = ()
    figures: tuple[Figure, ...] = ()
    closing: tuple[str, ...] = ()

    def counts(self) -> dict[Verdict, int]:
        """Return how many rows have each verdict."""
        return {verdict: sum(r.verdict == verdict for r in self.rows) for verdict in VERDICTS}

    def as_json(self) -> dict[str, Any]:
        """Return the group as it is written, without its figures."""
        return {
            "anchor": self.anchor,
            "title": self.title,
            "intro": self.intro,
            "counts": self.counts(),
            "rows": [row.as_json() for row in self.rows],
            "closing": self.closing,
        }
