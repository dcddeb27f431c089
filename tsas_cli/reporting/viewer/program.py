"""Where the viewer's program is: inside the package `rerun_cli`.

The script `rerun` beside Python only calls it: who ends the script leaves the program running.
"""

import sys
from importlib.util import find_spec
from pathlib import Path

from tsas_cli.support.errors import InputError

NAMES = {"win32": "rerun.exe", "darwin": "Rerun.app/Contents/MacOS/Rerun"}


def program() -> Path:
    """Return the program's path.

    Raises
    ------
    InputError
        The package or its program is not installed.
    """
    spec = find_spec("rerun_cli")
    folders = [] if spec is None else list(spec.submodule_search_locations or ())
    names = dict.fromkeys((NAMES.get(sys.platform, "rerun"), "rerun"))  # older wheels have no app
    found = [path for f in folders for name in names if (path := Path(f) / name).is_file()]
    if not found:
        raise InputError(
            "the viewer's program is not installed",
            where="package rerun-sdk",
            remedy="install it anew: `pip install --force-reinstall rerun-sdk`",
        )
    return found[0]
