"""How to repeat what the page shows: the commands, the versions, the inputs' hashes."""

import platform
import shlex
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path

from tsas_cli import __version__
from tsas_cli.files import sha256_of
from tsas_cli.reporting.content import Section, Table
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.stage_files import Calibration, Check, Diagnosis, Simulation

_LIBRARIES = ("numpy", "scipy", "numba", "matplotlib")


def section(inputs: Inputs) -> Section:
    """Return the section on how to repeat the page."""
    hashes = inputs.dataset.hashes()
    simulation = inputs.get(Simulation)
    if simulation and simulation.model.sha256:
        hashes[simulation.model.file] = simulation.model.sha256
    return Section(
        "repeat",
        "How to repeat it",
        ("These commands make the same page from the same files.",),
        tables=(
            Table("Versions", ("program", "version"), tuple(_versions(inputs))),
            Table("Files read", ("file", "SHA-256"), tuple(hashes.items())),
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
    if Diagnosis in folder:
        yield ["tsas", "diagnose", dataset, "--out", folder[Diagnosis]]
    if simulation := inputs.get(Simulation):
        options = ["--dynamics", simulation.dynamics, "--out", folder[Simulation]]
        yield ["tsas", "simulate", dataset, *_model(simulation, inputs), *options]
    yield ["tsas", "report", dataset, *folder.values(), "--out", "report.html"]


def _model(simulation: Simulation, inputs: Inputs) -> list[str]:
    """Return the option that names the model: the calibration's where it is the one simulated."""
    if simulation.model.sha256 is None:
        return []
    folder = inputs.folders.get(Calibration)
    calibrated = folder / simulation.model.file if folder else Path(simulation.model.file)
    same = calibrated.is_file() and sha256_of(calibrated) == simulation.model.sha256
    return ["--model", str(calibrated) if same else simulation.model.file]


def _versions(inputs: Inputs) -> Iterator[tuple[str, str]]:
    yield "tsas, this page", __version__
    if calibration := inputs.get(Calibration):
        yield "tsas, calibration", calibration.version
    if simulation := inputs.get(Simulation):
        yield "tsas, simulation", simulation.version
    if diagnosis := inputs.get(Diagnosis):
        yield "tsas, diagnosis", diagnosis.version
    yield "Python", platform.python_version()
    yield from ((name, version(name)) for name in _LIBRARIES)
