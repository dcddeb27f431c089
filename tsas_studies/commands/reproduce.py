"""`tsas reproduce`: the source paper's tables and figures computed again, beside what it prints."""

import tsas_cli as tsas
from tsas_cli.commands.common import Force, Json, OutFolder, Quiet, present, progress


def reproduce(
    out: OutFolder, force: Force = False, quiet: Quiet = False, as_json: Json = False
) -> None:
    """Compute the tables and figures of Yang et al. 2025 again, and say what agrees."""
    with progress("reproduce", quiet=quiet) as step:
        result = tsas.reproduce(out=out, force=force, step=step)
    present(result, quiet=quiet, as_json=as_json)
