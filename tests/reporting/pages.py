"""Every kind of page, made from small folders, and a browser that opens them."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from tests.drives import SPRUNG, drive_dataset
from tests.reporting.made_folders import (
    make_calibration,
    make_check,
    make_closing,
    make_dataset,
    make_diagnosis,
    make_prediction,
    make_simulation,
    make_tracking,
    off_at_the_end,
    write_predictions,
)
from tests.studies.reproduction import test_page as test_reproduction
from tsas_cli.reporting.inputs import read_inputs
from tsas_cli.reporting.page import page
from tsas_cli.reporting.pdf import browser
from tsas_cli.stages.identify_harmonic_drive import identify_harmonic_drive
from tsas_cli.support.errors import InputError
from tsas_studies.reproduction.page import reproduction_page


def pipeline(root: Path, ids=("a", "b"), wrong=off_at_the_end, **more) -> list[Path]:
    """Write what the whole pipeline would; return the folders."""
    dataset = make_dataset(root / "dataset", ids, **more)
    return [
        dataset,
        make_check(dataset, root / "check"),
        make_calibration(dataset, root / "calibrate", ["The sheath is silent."]),
        make_simulation(dataset, root / "simulate"),
        write_predictions(dataset, make_diagnosis(dataset, root / "diagnose", "named"), wrong),
    ]


def _pipeline(root: Path) -> str:
    return page(read_inputs(pipeline(root, samples=400)))


def _diagnosis(root: Path) -> str:
    dataset = make_dataset(root / "dataset", ("a",), samples=400)
    return page(read_inputs([make_diagnosis(dataset, root / "diagnose", "ambiguous")]))


def _prediction(root: Path) -> str:
    dataset = make_dataset(root / "dataset", samples=400)
    return page(read_inputs([make_prediction(dataset, root / "predict")]))


def _tracking(root: Path) -> str:
    return page(read_inputs([make_tracking(root / "tracked")]))


def _drive(root: Path) -> str:
    data = drive_dataset(root / "dataset", SPRUNG, duration_s=4.0, to_Hz=120.0)
    identify_harmonic_drive(data, out=root / "out")
    return page(read_inputs([root / "out"]))


def _closing(root: Path) -> str:
    return page(read_inputs([make_closing(root / "loop")]))


def _reproduction(root: Path) -> str:
    return reproduction_page(test_reproduction.PAPER, test_reproduction.GROUPS)


PAGES: dict[str, Callable[[Path], str]] = {
    "pipeline": _pipeline,
    "diagnosis": _diagnosis,
    "prediction": _prediction,
    "tracking": _tracking,
    "drive": _drive,
    "closing": _closing,
    "reproduction": _reproduction,
}


@contextmanager
def chromium() -> Iterator[Any]:
    """Yield the machine's Chromium; skip the test where it or playwright is missing."""
    playwright = pytest.importorskip("playwright.sync_api")
    try:
        path = browser()
    except InputError as error:
        pytest.skip(f"nothing to open pages with: {error}")
    with playwright.sync_playwright() as running:
        opened = running.chromium.launch(executable_path=path, args=["--no-sandbox"])
        yield opened
        opened.close()
