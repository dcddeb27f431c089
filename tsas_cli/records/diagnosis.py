"""What `diagnosis.json` holds (docs/formats.md)."""

from collections.abc import Mapping
from typing import ClassVar, Literal, Self

from pydantic import Field, model_validator

from tsas_cli.effects import EFFECTS
from tsas_cli.records.base import (
    Evidence,
    ModelFile,
    NotNegative,
    Number,
    OfDataset,
    PhaseSegment,
    Record,
    Value,
    number_text,
)
from tsas_cli.records.result import Table

EXTENDED_MODEL, NOMINAL_MODEL = "model-extended.toml", "model-nominal.toml"
STAND_IN_MODEL = "model-stand-in.toml"
Verdict = Literal[
    "named",
    "ambiguous",
    "partly",
    "described",
    "stand_in",
    "unexplained",
    "sufficient",
    "undecided",
]
VERDICTS: dict[Verdict, str] = {
    "named": "Cause found",
    "ambiguous": "Cause found, but these recordings leave open which",
    "partly": "Cause found, but not everything agrees with it",
    "described": "Something without a name is missing, and described",
    "stand_in": "Something unknown is missing",
    "sufficient": "Nothing is missing",
    "unexplained": "Something unknown is missing",
    "undecided": "Cannot tell",
}
INCOMPLETE = frozenset[Verdict]({"partly", "described", "stand_in", "unexplained"})
# Loads whose tension comes before their displacement, and how the check `delay` says that.
TENSION_LEADS = {"load_damping", "load_hysteresis", "load_inertia", "load_relaxation"}
EARLY = "before x_out_mm (`delay`)"
UNITS = {effect.name: {p.name: p.unit for p in effect.parameters} for effect in EFFECTS}


class NamedCause(Record):
    """An effect that is named; `rivals` are those that may be it just as well.

    `gain_percent` is what it takes off the RMS of the residual on held-out data. A stand-in has
    `failed`: what it does not prove; a named one may have `law_differs`: over which signal.
    """

    SPARSE = frozenset({"failed", "law_differs"})
    effect: str
    title: str = ""
    equation: str = ""
    rivals: tuple[str, ...] = ()
    parameters: dict[str, Value] = {}
    gain_percent: Number = None
    gain_interval_percent: tuple[Number, Number] | None = None
    failed: tuple[str, ...] = ()
    law_differs: str = ""

    @model_validator(mode="after")
    def _units_are_the_catalogues(self) -> Self:
        for name, unit in UNITS.get(self.effect, {}).items():
            value = self.parameters.get(name)
            if value is not None and value.unit != unit:
                raise ValueError(f"{name} is in {value.unit}, expected {unit}")
        return self


class DescribedLaw(Record):
    """A law of unnamed origin; the errors are its channel's on held-out data.

    `rivals` are other laws that describe it as well, `beside` effects that gain without being
    proven and that it acts beside. `after_reversal` is the change of `what` over the travel since a
    reversal, from full slip and at the mean tension; `along_stroke` its curve at the places; their
    margins are half of the 95 % intervals.
    """

    law: str
    title: str
    equation: str
    sentence: str
    parameters: dict[str, Value]
    rivals: tuple[str, ...] = ()
    beside: tuple[str, ...] = ()
    channel: str
    unit: str
    rmse_before: NotNegative
    rmse_after: NotNegative
    what: str = ""
    travel_mm: tuple[float, ...] = ()
    after_reversal: tuple[float, ...] = ()
    after_reversal_margin: tuple[float, ...] = ()
    place_mm: tuple[float, ...] = ()
    along_stroke: tuple[float, ...] = ()
    along_stroke_margin: tuple[float, ...] = ()


class HeldOut(Record):
    """One channel's RMS of the residual on held-out data, in its unit."""

    unit: str = ""
    rmse_before: NotNegative = None
    rmse_after: NotNegative = None
    noise_floor: NotNegative = None
    attainable: NotNegative = None

    @property
    def less_attainable(self) -> bool:
        """Whether another model could reach less, to three digits; older files may say more."""
        least, reached = self.attainable, self.rmse_after
        if least is None or reached is None:
            return False
        return least < reached and number_text(least) != number_text(reached)


def errors_table(channels: Mapping[str, HeldOut]) -> Table:
    """Return the errors on held-out data; attainable where it is less than what is reached."""
    header = ["channel", "before", "after", "noise floor", "unit", "attainable"]
    rows = []
    for name, c in channels.items():
        sizes = map(number_text, (c.rmse_before, c.rmse_after, c.noise_floor))
        least = number_text(c.attainable) if c.less_attainable else ""
        rows.append([name, *sizes, c.unit, least])
    title = "error on held-out data"
    if any(row[-1] for row in rows):
        return title, header, rows
    no_less = f"{title}; a regression on these signals reaches no less"
    return no_less, header[:-1], [row[:-1] for row in rows]


class SlowNoise(Record):
    """Coloured noise of a channel: standard deviation, and time of its autocorrelation [s]."""

    sd: NotNegative
    unit: str
    time_s: NotNegative

    def text(self, channel: str) -> str:
        """Return it in a sentence."""
        return (
            f"{channel} has slow noise of {number_text(self.sd, '.2g')} {self.unit}, correlated "
            f"over {number_text(self.time_s, '.2g')} s, which follows no recorded signal."
        )


class RemainingResidual(Record):
    """The remaining residual; `mean_square` is the reduced chi-square."""

    unexplained: bool
    depends_on: tuple[str, ...] = ()
    share_percent: Number = None
    mean_square: Number = None
    slow_noise: dict[str, SlowNoise] = {}


class TriedHypothesis(Record):
    """One hypothesis that was fitted, and by how much it lowers the residual on held-out data."""

    effects: tuple[str, ...]
    gain_percent: Number = None
    test_statistic: Number = None
    convincing: bool = False
    mean_square: Number = None
    converged: bool = True
    parameters: dict[str, Number] = {}


class Signatures(Record):
    """How visible each effect is in these inputs, and how similar each two are, 0 to 1."""

    effects: tuple[str, ...] = ()
    visible: tuple[float, ...] = ()
    similarity: tuple[tuple[float, ...], ...] = ()

    @model_validator(mode="after")
    def _is_square(self) -> Self:
        count = len(self.effects)
        if any(len(row) != count for row in (self.visible, self.similarity, *self.similarity)):
            raise ValueError(
                "visible and similarity need a value for each effect, and for each two"
            )
        return self


class Bin(Record):
    """The residual where a signal lies between two values, in units of noise."""

    low: Number = Field(default=None, alias="from")
    high: Number = Field(default=None, alias="to")
    label: str = ""
    mean: float
    sd: float
    samples: int


Maps = dict[str, dict[str, tuple[Bin, ...]]]  # by channel and signal


class ResidualMaps(Record):
    """The residual of each channel over each signal, before and after."""

    before: Maps = {}
    after: Maps = {}


class RecordingFault(Record):
    """What is wrong with the recordings: the code of a check, or of a fault of single runs."""

    SPARSE = frozenset({"run", "column", "first_s"})
    code: str
    run: str | None = None
    column: str | None = None
    sentence: str = ""
    first_s: Number = None


class Findings(Record):
    """The part of a diagnosis that any tool can write, and that the blind benchmark scores."""

    format: Literal[1] = 1
    verdict: Verdict
    named: tuple[NamedCause, ...]
    stand_ins: tuple[NamedCause, ...] = ()
    laws: tuple[DescribedLaw, ...] = ()
    faults: tuple[RecordingFault, ...] = ()
    channels: dict[str, HeldOut] = {}
    remainder: RemainingResidual
    next_experiment: str = ""

    @model_validator(mode="after")
    def _named_once(self) -> Self:
        names = [named.effect for named in self.named]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise ValueError(f"{twice[0]} is named twice")
        return self

    @property
    def effects(self) -> frozenset[str]:
        """The names of the named effects."""
        return frozenset(named.effect for named in self.named)

    @property
    def extended(self) -> bool:
        """Whether the extended model differs from the nominal one."""
        return bool(self.named or self.laws)

    @property
    def warns(self) -> bool:
        """Whether it reports something for which it has no name."""
        return self.verdict in INCOMPLETE or self.remainder.unexplained


class DiagnosisFile(OfDataset, Findings):
    """The content of `diagnosis.json`."""

    FILE: ClassVar[str] = "diagnosis.json"
    stage: Literal["diagnose"] = "diagnose"
    model: ModelFile = ModelFile(file="data sheet")
    reason: str
    named: tuple[NamedCause, ...] = ()
    remainder: RemainingResidual = RemainingResidual(unexplained=False)
    candidates: tuple[TriedHypothesis, ...] = ()
    signatures: Signatures = Signatures()
    residual_map: ResidualMaps = ResidualMaps()
    evidence: Evidence = Evidence()
    cannot_tell: tuple[str, ...] = ()
    not_sought: tuple[str, ...] = ()  # codes of faults of the recordings
    solver: str = ""
    segments: dict[str, tuple[PhaseSegment, ...]] = {}

    def warned(self) -> list[str]:
        """Return a sentence for each kind of warning, with the cause of one that is named."""
        leads = sorted(self.effects & TENSION_LEADS)
        return [
            f"{said} {leads[0]} does this too." if leads and EARLY in said else said
            for said in super().warned()
        ]
