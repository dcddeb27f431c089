"""The causes that a diagnosis can name."""

import textwrap
from collections.abc import Iterator
from dataclasses import asdict, dataclass

from tsas_cli.effects import EFFECTS, LAWS, Effect
from tsas_cli.records.result import Result, Table
from tsas_cli.support.errors import InputError, nearest

WIDTH = 100  # of the explanation's text


@dataclass(frozen=True, repr=False, eq=False)
class CatalogueResult(Result):
    """Every effect that makes a real rig differ from the nominal one."""

    effects: tuple[Effect, ...]

    def tables(self) -> list[Table]:
        """Return a row for each parameter of each effect."""
        rows = [row for effect in self.effects for row in _rows(effect)]
        header = ("effect", "acts on", "parameter", "unit", "what it is")
        return [(f"{len(self.effects)} effects", header, rows)]


@dataclass(frozen=True, repr=False, eq=False)
class Explanation(Result):
    """One effect: what it is, what one sees of it, and how to isolate it."""

    effect: Effect

    def intro(self) -> list[str]:
        """Return what a person reads before the parameters."""
        effect = self.effect
        return [
            f"{effect.title} ({effect.name}, acts on the {effect.acts_on})",
            "",
            f"    {effect.equation}",
            "",
            effect.doc.strip(),
            textwrap.fill(f"Experiment: {effect.experiment}", WIDTH),
            "",
        ]

    def tables(self) -> list[Table]:
        """Return the parameters."""
        rows = [
            (p.name, p.unit, "any" if p.shape else f"{p.neutral:g}", f"{p.lower:g}", f"{p.upper:g}")
            for p in self.effect.parameters
        ]
        return [("parameters", ("parameter", "unit", "neutral", "lowest", "highest"), rows)]


def catalogue() -> CatalogueResult:
    """List every effect that makes a real rig differ from the nominal one.

    Returns
    -------
    CatalogueResult
        `.effects` holds the records: name, title, equation, text, parameters with units and
        bounds, experiment.
    """
    content = {"format": 1, "effects": [asdict(effect) for effect in EFFECTS]}
    return CatalogueResult(content, None, EFFECTS)


def explain(name: str) -> Explanation:
    """Explain an effect or a law: what one sees of it, its equation, parameters, experiment.

    Parameters
    ----------
    name
        The name of an effect, as `catalogue` lists it, or of a law of unnamed origin.

    Returns
    -------
    Explanation
        `.effect` is the record.

    Raises
    ------
    InputError
        There is no such effect.
    """
    effect = next((e for e in (*EFFECTS, *LAWS) if e.name == name), None)
    if effect is None:
        remedy = f"{nearest(name, [e.name for e in EFFECTS])}; `tsas effects` lists them all"
        raise InputError(f"there is no effect {name!r}", remedy=remedy)
    return Explanation({"format": 1, **asdict(effect)}, None, effect)


def _rows(effect: Effect) -> Iterator[tuple[str, ...]]:
    """Yield a row for each parameter; what belongs to the effect stands in the first."""
    name, acts_on, sentence = effect.name, str(effect.acts_on), effect.sentence
    for p in effect.parameters:
        yield name, acts_on, p.name, p.unit, sentence
        name = acts_on = sentence = ""
