"""`tsas effects`: list every cause that a diagnosis can name."""

import tsas_cli as tsas
from tsas_cli.commands.common import Json, Quiet, hint, present


def effects(quiet: Quiet = False, as_json: Json = False) -> None:
    """List every effect that makes a real rig differ from the nominal one."""
    present(tsas.catalogue(), quiet=quiet, as_json=as_json)
    hint("`tsas explain NAME` tells more", quiet=quiet, as_json=as_json)
