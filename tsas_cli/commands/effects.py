"""`tsas effects`: list the causes that a diagnosis can name."""

import tsas_cli as tsas
from tsas_cli.commands.common import Json, Quiet, hint, present


def effects(quiet: Quiet = False, as_json: Json = False) -> None:
    """List the effects by which a real rig differs from the nominal model."""
    present(tsas.catalogue(), quiet=quiet, as_json=as_json)
    hint("`tsas explain NAME` describes an effect", quiet=quiet, as_json=as_json)
