"""How to repeat what the page shows: the commands, the versions, the inputs' hashes."""

import platform
import shlex
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path

from tsas_cli.identification.model_file import IN_MEMORY
from tsas_cli.records.base import OfDataset, StageFile
from tsas_cli.records.calibration import CalibrationFile
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
from tsas_cli.support.wording import quoted

SETTINGS = "settings.toml"
_LIBRARIES = ("numpy", "scipy", "numba", "matplotlib")
_FILE_OPTIONS = ("model", "plant", "drive", "settings", "reference")


def section(inputs: Inputs) -> Section:
    """Return the section on how to repeat the page."""
    hashes = {} if inputs.dataset is None else inputs.dataset.hashes()
    for stage, _ in inputs.given:
        hashes |= {file: digest for _, file, digest in _files_read(stage) if digest}
    if prediction := inputs.get(PredictionFile):
        hashes |= {one.path: one.sha256 for one in prediction.models if one.sha256}
    versions = {
        "tsas, this page": __version__,
        **{f"tsas {stage.stage}": stage.version for stage, _ in inputs.given},
        "Python": platform.python_version(),
        **{name: version(name) for name in _LIBRARIES},
    }
    tables = [table_of("Versions", ("program", "version"), versions.items())]
    if hashes:
        tables.append(table_of("Files read", ("file", "SHA-256"), hashes.items()))
    return Section(
        "repeat",
        "How to repeat it",
        tuple(_intro(inputs)),
        tables=tuple(tables),
        commands=tuple(shlex.join(command) for command in _commands(inputs)),
    )


def _files_read(stage: StageFile) -> Iterator[tuple[str, str, str | None]]:
    """Yield option, name and checksum of each file that a stage has read beside recordings."""
    for option in _FILE_OPTIONS:
        read = getattr(stage, option, None)
        if name := getattr(read, "file", None):
            yield option, name, getattr(read, "sha256", None)


def _intro(inputs: Inputs) -> Iterator[str]:
    yield "These commands make the same page from the same files."
    stages = [stage for stage, _ in inputs.given]
    files = [name for stage in stages for _, name, _ in _files_read(stage)]
    conditions = any(isinstance(stage, OfDataset) and stage.conditions for stage in stages)
    if conditions or IN_MEMORY in files:
        yield "They lack what was handed over without a file: a model, settings, or conditions."
    closing = inputs.get(ClosingFile)
    if closing and _own_settings(closing):
        yield (
            f"`{SETTINGS}` is a file with the settings that `{ClosingFile.FILE}` "
            "holds; they are not the defaults."
        )


def _commands(inputs: Inputs) -> Iterator[list[str]]:
    dataset = [] if inputs.dataset is None else [str(inputs.dataset.folder)]
    for stage, folder in inputs.given:
        read = dataset if isinstance(stage, OfDataset) else []
        if isinstance(stage, PredictionFile):
            read = [*(model.path for model in stage.models), *read]
        yield ["tsas", stage.stage, *read, *_options(stage, inputs), "--out", str(folder)]
    # One folder may hold more than one kind.
    folders = dict.fromkeys([*dataset, *(str(folder) for _, folder in inputs.given)])
    yield ["tsas", "report", *folders, "--out", "report.html"]


def _options(stage: StageFile, inputs: Inputs) -> Iterator[str]:
    for option, name, digest in _files_read(stage):
        if digest is not None:
            yield from (f"--{option}", _path(name, digest, inputs))
    for name in ("dynamics", "nodes"):
        if (value := getattr(stage, name, None)) is not None:
            yield from (f"--{name}", str(value))
    if isinstance(stage, OfDataset):
        if stage.chosen is not None:
            yield from ("--runs", ",".join(map(quoted, stage.chosen)))
        not_sought = stage.not_sought if isinstance(stage, DiagnosisFile) else ()
        for code in dict.fromkeys((*(error.code for error in stage.despite), *not_sought)):
            yield from ("--despite", code)
    if isinstance(stage, SimulationFile) and stage.own_values_fitted:
        yield "--fit-own"
    if isinstance(stage, PredictionFile) and not stage.own_values_fitted:
        yield "--as-is"
    if isinstance(stage, DriveFile):
        yield from ("--speed", "measured" if stage.hold == "first" else "commanded")
    if isinstance(stage, ClosingFile):
        yield from _closing_options(stage)
    if isinstance(stage, TrackingFile):
        yield from _tracking_options(stage)
    if isinstance(stage, ClosingFile | TrackingFile):
        first, last = stage.seeds
        yield from ("--seeds", str(last - first + 1), "--seed", str(first))


def _path(name: str, digest: str, inputs: Inputs) -> str:
    """Return where a file is: in the calibration's folder where that is the one read."""
    folder = inputs.folders.get(CalibrationFile)
    calibrated = Path(name) if folder is None else folder / name
    same = calibrated.is_file() and sha256_of(calibrated) == digest
    return str(calibrated) if same else name


def _closing_options(closing: ClosingFile) -> Iterator[str]:
    """Yield the cases; settings that are not the defaults as if they stood in `SETTINGS`."""
    names = [case.case for case in closing.cases]
    if HIDDEN not in names:
        yield from ("--cases", ",".join(names))
    else:
        hidden = (change for case in closing.cases for change in case.hidden.items())
        for name, value in hidden:
            yield from ("--hide", f"{name}={value!r}")
    if _own_settings(closing):
        yield from ("--settings", SETTINGS)


def _own_settings(closing: ClosingFile) -> bool:
    from tsas_cli.tracking.settings import Settings

    return closing.settings.content() != Settings().model_dump(mode="json", by_alias=True)


def _tracking_options(tracking: TrackingFile) -> Iterator[str]:
    """Yield the controllers, the changes of the plant, and the wanted force."""
    if len(tracking.conditions) > 1:
        yield "--compare"  # which takes all controllers
    else:
        names = dict.fromkeys(result.controller for result in tracking.results)
        yield from ("--controller", ",".join(names))
    for change in (change for changes in tracking.conditions.values() for change in changes):
        late = f"@{change.from_s!r}" if change.from_s > 0.0 else ""
        yield from ("--disturb", f"{change.quantity}={change.value!r}{late}")
    if tracking.reference.shape:
        yield from ("--reference", tracking.reference.shape)
    if tracking.gains == "as printed":
        yield "--as-printed"
