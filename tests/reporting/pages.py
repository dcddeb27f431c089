"""Every kind of page, made from small folders, and a browser that opens them."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from tests.drives import SPRUNG, drive_dataset
from tests.reporting import made_diagnoses, made_loops
from tests.reporting import made_folders as by_hand
from tests.studies.reproduction import test_page as test_reproduction
from tsas_cli.reporting.pdf import browser
from tsas_cli.stages.identify_harmonic_drive import identify_harmonic_drive
from tsas_cli.support.errors import InputError
from tsas_studies.reproduction.page import reproduction_page


def pipeline(root: Path, ids=("a", "b"), wrong=made_diagnoses.off_at_the_end, **more) -> list[Path]:
    """Write what the whole pipeline would; return the folders."""
    dataset = by_hand.make_dataset(root / "dataset", ids, **more)
    return [
        dataset,
        by_hand.make_check(dataset, root / "check"),
        by_hand.make_calibration(dataset, root / "calibrate", ["The sheath is silent."]),
        by_hand.make_simulation(dataset, root / "simulate"),
        made_diagnoses.write_predictions(
            dataset, made_diagnoses.make_diagnosis(dataset, root / "diagnose", "named"), wrong
        ),
    ]


def _drive(root: Path) -> Path:
    data = drive_dataset(root / "dataset", SPRUNG, duration_s=4.0, to_Hz=120.0)
    identify_harmonic_drive(data, out=root / "out")
    return root / "out"


def _dataset(root: Path, *ids: str) -> Path:
    return by_hand.make_dataset(root / "dataset", ids, samples=400)


FOLDERS: dict[str, Callable[[Path], list[Path]]] = {
    "pipeline": lambda root: pipeline(root, samples=400),
    "diagnosis": lambda root: [
        made_diagnoses.make_diagnosis(_dataset(root, "a"), root / "diagnose", "ambiguous")
    ],
    "prediction": lambda root: [by_hand.make_prediction(_dataset(root, "a", "b"), root / "out")],
    "tracking": lambda root: [made_loops.make_tracking(root / "tracked")],
    "drive": lambda root: [_drive(root)],
    "closing": lambda root: [made_loops.make_closing(root / "loop")],
}
KINDS = (*FOLDERS, "reproduction")


def page_of(kind: str, root: Path) -> str:
    """Return a page of a kind, made in a folder."""
    if kind == "reproduction":
        return reproduction_page(test_reproduction.PAPER, test_reproduction.GROUPS)
    return by_hand.page_from(*FOLDERS[kind](root))


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
