"""`tsas effects`: list every cause that a diagnosis can name."""

from collections.abc import Iterator
from dataclasses import asdict
from typing import TYPE_CHECKING

from tsas_cli.commands.common import Json, Quiet, show

if TYPE_CHECKING:
    from tsas_cli.effects import Effect


def effects(quiet: Quiet = False, as_json: Json = False) -> None:
    """List every effect that makes a real rig differ from the nominal one."""
    from tsas_cli.effects import EFFECTS

    content = {"format": 1, "effects": [asdict(effect) for effect in EFFECTS]}
    rows = [row for effect in EFFECTS for row in _rows(effect)]
    header = ("effect", "acts on", "parameter", "unit", "what it is")
    title = f"{len(EFFECTS)} effects; `tsas explain NAME` tells more"
    show(content, [(title, header, rows)], quiet=quiet, as_json=as_json)


def _rows(effect: "Effect") -> Iterator[tuple[str, ...]]:
    """Yield a row for each parameter; what belongs to the effect stands in the first."""
    name, acts_on, sentence = effect.name, str(effect.acts_on), effect.sentence
    for p in effect.parameters:
        yield name, acts_on, p.name, p.unit, sentence
        name = acts_on = sentence = ""
