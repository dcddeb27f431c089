"""`tsas explain NAME`: what an effect is, what one sees of it, and how to isolate it."""

from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import Json, Quiet, present
from tsas_cli.commands.completion import effect_names


def explain(
    name: Annotated[
        str,
        typer.Argument(
            metavar="NAME",
            help="An effect; `tsas effects` lists.",
            autocompletion=effect_names,
        ),
    ],
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Explain an effect: what one sees of it, its equation, its parameters, its experiment."""
    present(tsas.explain(name), quiet=quiet, as_json=as_json)
