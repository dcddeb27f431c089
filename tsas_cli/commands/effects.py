"""`tsas effects`: list the causes that a diagnosis can name."""

from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import Json, Quiet, hint, present
from tsas_cli.commands.completion import effect_names


def effects(quiet: Quiet = False, as_json: Json = False) -> None:
    """List the effects by which a real rig differs from the nominal model."""
    present(tsas.catalogue(), quiet=quiet, as_json=as_json)
    hint("`tsas explain NAME` describes an effect", quiet=quiet, as_json=as_json)


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
