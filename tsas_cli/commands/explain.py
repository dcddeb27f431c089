"""`tsas explain NAME`: describe an effect."""

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
            help="An effect of `tsas effects`.",
            autocompletion=effect_names,
        ),
    ],
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Describe an effect: its signature, equation, parameters and isolating experiment."""
    present(tsas.explain(name), quiet=quiet, as_json=as_json)
