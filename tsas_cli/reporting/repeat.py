"""How to repeat what the page shows: the commands, the versions, the inputs' hashes."""

import platform
import shlex
from collections.abc import Iterator, Mapping
from importlib.metadata import version
from pathlib import Path

from tsas_cli.identification.model_file import IN_MEMORY
from tsas_cli.records.base import ModelFile, OfDataset, StageFile
from tsas_cli.records.calibration import CalibrationFile
from tsas_cli.records.check import CheckFile
from tsas_cli.records.closing import HIDDEN, ClosingFile
from tsas_cli.records.diagnosis import DiagnosisFile
from tsas_cli.records.drive import DriveFile
from tsas_cli.records.prediction import PredictionFile
from tsas_cli.records.simulation import SimulationFile
from tsas_cli.records.tracking import TrackingFile
from tsas_cli.reporting.content import Section, table_of
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.support import __version__
from tsas_cli.support.files import sha256_of

SETTINGS = "settings.toml"
_WROTE: dict[type[StageFile], str] = {
    CalibrationFile: "calibration",
    SimulationFile: "simulation",
    DiagnosisFile: "diagnosis",
    PredictionFile: "prediction",
    TrackingFile: "tracking",
    DriveFile: "drive",
    ClosingFile: "close-loop",
}
_LIBRARIES = ("numpy", "scipy", "numba", "matplotlib")


def section(inputs: Inputs) -> Section:
    """Return the section on how to repeat the page."""
    hashes = {} if inputs.dataset is None else inputs.dataset.hashes()
    for stage in (*(one for one, _ in inputs.simulations.values()), inputs.get(DiagnosisFile)):
        if stage and stage.model.sha256:
            hashes[stage.model.file] = stage.model.sha256
    if prediction := inputs.get(PredictionFile):
        hashes |= {one.path: one.sha256 for one in prediction.models if one.sha256}
    if tracking := inputs.get(TrackingFile):
        named = (tracking.model, tracking.plant, tracking.drive, tracking.reference)
        hashes |= {one.file: one.sha256 for one in named if one.sha256 is not None}
    wrote = ((name, inputs.get(kind)) for kind, name in _WROTE.items())
    versions = [
        ("tsas, this page", __version__),
        *((f"tsas, {name}", stage.version) for name, stage in wrote if stage),
        ("Python", platform.python_version()),
        *((name, version(name)) for name in _LIBRARIES),
    ]
    tables = [table_of("Versions", ("program", "version"), versions)]
    if hashes:
        tables.append(table_of("Files read", ("file", "SHA-256"), hashes.items()))
    return Section(
        "repeat",
        "How to repeat it",
        tuple(_intro(inputs)),
        tables=tuple(tables),
        commands=tuple(shlex.join(command) for command in _commands(inputs)),
    )


def _intro(inputs: Inputs) -> Iterator[str]:
    yield "These commands make the same page from the same files."
    stages = [stage for stage, _ in inputs.given]
    files = [getattr(s, name, None) for s in stages for name in ("model", "plant", "drive")]
    files += [s.settings for s in stages if isinstance(s, TrackingFile)]
    if any(isinstance(stage, OfDataset) and stage.conditions for stage in stages) or any(
        getattr(one, "file", None) == IN_MEMORY for one in files
    ):
        yield "They lack what was handed over without a file: a model, settings, or conditions."
    closing = inputs.get(ClosingFile)
    if closing and _own_settings(closing):
        yield (
            f"`{SETTINGS}` is a file with the settings that `{ClosingFile.FILE}` "
            "holds; they are not the defaults."
        )


def _commands(inputs: Inputs) -> Iterator[list[str]]:
    folder = {kind: str(path) for kind, path in inputs.folders.items()}
    if closing := inputs.get(ClosingFile):
        yield ["tsas", "close-loop", *closing_options(closing), "--out", folder[ClosingFile]]
    read = [str(path) for _, path in inputs.given]
    if inputs.dataset is not None:
        read.insert(0, str(inputs.dataset.folder))
        yield from _of_dataset(inputs, read[0], folder)
    read = list(dict.fromkeys(read))  # one folder may hold more than one kind
    yield ["tsas", "report", *read, "--out", "report.html"]


def _of_dataset(
    inputs: Inputs, dataset: str, folder: Mapping[type[StageFile], str]
) -> Iterator[list[str]]:
    if tracking := inputs.get(TrackingFile):
        yield ["tsas", "track", *tracking_options(tracking), "--out", folder[TrackingFile]]
    if CheckFile in folder:
        yield ["tsas", "check", dataset, "--out", folder[CheckFile]]
    if calibration := inputs.get(CalibrationFile):
        options = ["--dynamics", calibration.dynamics, "--out", folder[CalibrationFile]]
        if calibration.model.sha256 is not None:
            options += ["--model", calibration.model.file]
        yield ["tsas", "calibrate", dataset, *options, *_despite(calibration)]
    if diagnosis := inputs.get(DiagnosisFile):
        options = ["--out", folder[DiagnosisFile]]
        model = _model(diagnosis.model, inputs)
        yield ["tsas", "diagnose", dataset, *model, *options, *_despite(diagnosis)]
    for simulation, written in inputs.simulations.values():
        options = ["--dynamics", simulation.dynamics, "--out", str(written)]
        if simulation.nodes is not None:
            options += ["--nodes", str(simulation.nodes)]
        if simulation.own_values_fitted:
            options += ["--fit-own"]
        yield ["tsas", "simulate", dataset, *_model(simulation.model, inputs), *options]
    if prediction := inputs.get(PredictionFile):
        options = [] if prediction.own_values_fitted else ["--as-is"]
        if prediction.chosen is not None:
            options += ["--runs", ",".join(prediction.chosen)]
        options += ["--out", folder[PredictionFile]]
        yield ["tsas", "predict", *(one.path for one in prediction.models), dataset, *options]
    if drive := inputs.get(DriveFile):
        options = ["--speed", "measured" if drive.hold == "first" else "commanded"]
        yield ["tsas", "identify-harmonic-drive", dataset, *options, "--out", folder[DriveFile]]


def _despite(stage: OfDataset) -> Iterator[str]:
    """Yield the options that accept the same errors in the recordings."""
    for code in dict.fromkeys(error.code for error in stage.despite):
        yield from ("--despite", code)


def _model(model: ModelFile, inputs: Inputs) -> list[str]:
    """Return the option that names the model: the calibration's where it is the one read."""
    if model.sha256 is None:
        return []
    folder = inputs.folders.get(CalibrationFile)
    calibrated = folder / model.file if folder else Path(model.file)
    same = calibrated.is_file() and sha256_of(calibrated) == model.sha256
    return ["--model", str(calibrated) if same else model.file]


def closing_options(closing: ClosingFile) -> Iterator[str]:
    """Yield the options; settings that are not the defaults as if they stood in `SETTINGS`."""
    names = [case.case for case in closing.cases]
    if HIDDEN not in names:
        yield from ("--cases", ",".join(names))
    else:
        hidden = (change for case in closing.cases for change in case.hidden.items())
        for name, value in hidden:
            yield from ("--hide", f"{name}={value!r}")
    if _own_settings(closing):
        yield from ("--settings", SETTINGS)
    first, last = closing.seeds
    yield from ("--seeds", str(last - first + 1), "--seed", str(first))


def _own_settings(closing: ClosingFile) -> bool:
    from tsas_cli.tracking.settings import Settings

    return closing.settings.content() != Settings().model_dump(mode="json", by_alias=True)


def tracking_options(tracking: TrackingFile) -> Iterator[str]:
    """Yield the options, files by their names."""
    changes = [change for changes in tracking.conditions.values() for change in changes]
    if tracking.model.sha256 is not None:
        yield from ("--model", tracking.model.file)
    if tracking.plant.sha256 is not None and tracking.plant != tracking.model:
        yield from ("--plant", tracking.plant.file)
    if tracking.drive.sha256 is not None:
        yield from ("--drive", tracking.drive.file)
    if tracking.dynamics != "slip":
        yield from ("--dynamics", tracking.dynamics)
    if len(tracking.conditions) > 1:
        yield "--compare"  # which takes all controllers
    else:
        names = dict.fromkeys(result.controller for result in tracking.results)
        yield from ("--controller", ",".join(names))
    for change in changes:
        late = f"@{change.from_s!r}" if change.from_s > 0.0 else ""
        yield from ("--disturb", f"{change.quantity}={change.value!r}{late}")
    yield from ("--reference", tracking.reference.shape or tracking.reference.file)
    if tracking.gains == "as printed":
        yield "--as-printed"
    if tracking.settings.file is not None and tracking.settings.sha256 is not None:
        yield from ("--settings", tracking.settings.file)
    first, last = tracking.seeds
    yield from ("--seeds", str(last - first + 1), "--seed", str(first))
