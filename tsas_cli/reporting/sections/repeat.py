"""How to repeat what the page shows: the commands, the versions, the inputs' hashes."""

import platform
import shlex
from collections.abc import Iterator
from importlib.metadata import version

from tsas_cli import __version__
from tsas_cli.reporting.content import Section, Table
from tsas_cli.reporting.inputs import Inputs

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
    folder = {kind: str(path) for kind, path in inputs.folders.items()}
    dataset = folder["dataset"]
    if "check" in folder:
        yield ["tsas", "check", dataset, "--out", folder["check"]]
    if "calibration" in folder:
        yield ["tsas", "calibrate", dataset, "--out", folder["calibration"]]
    if inputs.simulation is not None:
        model = f"{folder['calibration']}/model.toml" if "calibration" in folder else "model.toml"
        options = ["--dynamics", inputs.simulation.dynamics, "--out", folder["simulation"]]
        yield ["tsas", "simulate", dataset, "--model", model, *options]
    yield ["tsas", "report", *folder.values(), "--out", "report.html"]


def _versions(inputs: Inputs) -> Iterator[tuple[str, str]]:
    yield "tsas, this page", __version__
    if inputs.calibration is not None:
        yield "tsas, calibration", inputs.calibration.version
    if inputs.simulation is not None:
        yield "tsas, simulation", inputs.simulation.version
    yield "Python", platform.python_version()
    yield from ((name, version(name)) for name in _LIBRARIES)
