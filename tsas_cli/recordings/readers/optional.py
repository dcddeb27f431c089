"""Packages that only some file formats need."""

from importlib import import_module
from types import ModuleType

from tsas_cli.support.errors import InputError


def optional(module: str, *, extra: str) -> ModuleType:
    """Import a package that comes with an extra of tsas.

    Raises
    ------
    InputError
        It is not installed.
    """
    try:
        return import_module(module)
    except ImportError as error:
        raise InputError(
            f"this file format needs the package {module}", remedy=f"install tsas[{extra}]"
        ) from error
