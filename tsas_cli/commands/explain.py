"""`tsas explain NAME`: what an effect is, what one sees of it, and how to isolate it."""

import textwrap
from dataclasses import asdict
from typing import Annotated

import typer

from tsas_cli.commands.common import Json, Quiet, show


def explain(
    name: Annotated[str, typer.Argument(metavar="NAME", help="An effect; `tsas effects` lists.")],
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Explain an effect: what one sees of it, its equation, its parameters, its experiment."""
    from tsas_cli.effects import EFFECTS
    from tsas_cli.errors import InputError, nearest

    effect = next((e for e in EFFECTS if e.name == name), None)
    if effect is None:
        remedy = f"{nearest(name, [e.name for e in EFFECTS])}; `tsas effects` lists them all"
        raise InputError(f"there is no effect {name!r}", remedy=remedy)
    if not (quiet or as_json):
        print(f"{effect.title} ({effect.name}, acts on the {effect.acts_on})\n")
        print(f"    {effect.equation}\n\n{effect.doc.strip()}")
        print(textwrap.fill(f"Experiment: {effect.experiment}", 100) + "\n")
    rows = [
        (p.name, p.unit, "any" if p.shape else f"{p.neutral:g}", f"{p.lower:g}", f"{p.upper:g}")
        for p in effect.parameters
    ]
    header = ("parameter", "unit", "neutral", "lowest", "highest")
    show(
        {"format": 1, **asdict(effect)},
        [("parameters", header, rows)],
        quiet=quiet,
        as_json=as_json,
    )
