"""How to repeat what the page shows: the commands, the versions, the inputs' hashes."""

import platform
import shlex
from collections.abc import Iterator
from importlib.metadata import version

from tsas_cli import __version__
from tsas_cli.reporting.content import Section, Table
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.stage_files import Calibration, Check, Simulation

_LIBRARIES = ("numpy", "scipy", "numba", "matplotlib")


def section(inputs: Inputs) -> Section:
    """Return the section on how to repeat the page."""
    hashes = inputs.dataset.hashes()
    return Section(
        "repeat",
        "How to repeat it",
        ("These commands make the same page from the same files.",),
        tables=(
            Table("Versions", ("program", "version"), tuple(_versions(inputs))),
            Table("Files read", ("file in the dataset", "SHA-256"), tuple(hashes.items())),
        ),
        commands=tuple(shlex.join(command) for command in _commands(inputs)),
    )


def _commands(inputs: Inputs) -> Iterator[list[str]]:
    dataset = str(inputs.dataset.folder)
    folder = {kind: str(path) for kind, path in inputs.folders.items()}
    if Check in folder:
        yield ["tsas", "check", dataset, "--out", folder[Check]]
    if Calibration in folder:
        yield ["tsas", "calibrate", dataset, "--out", folder[Calibration]]
    if simulation := inputs.get(Simulation):
        model = f"{folder[Calibration]}/model.toml" if Calibration in folder else "model.toml"
        options = ["--dynamics", simulation.dynamics, "--out", folder[Simulation]]
        yield ["tsas", "simulate", dataset, "--model", model, *options]
    yield ["tsas", "report", dataset, *folder.values(), "--out", "report.html"]


def _versions(inputs: Inputs) -> Iterator[tuple[str, str]]:
    yield "tsas, this page", __version__
    if calibration := inputs.get(Calibration):
        yield "tsas, calibration", calibration.version
    if simulation := inputs.get(Simulation):
        yield "tsas, simulation", simulation.version
    yield "Python", platform.python_version()
    yield from ((name, version(name)) for name in _LIBRARIES)
