"""What many tests need: the command line in a process of its own, and a small dataset."""

import gc
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Generator, Iterator
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import HealthCheck, settings

from tests.warm import Warm, environment
from tsas_cli.__main__ import main
from tsas_cli.recordings.manifest import Manifest
from tsas_cli.recordings.writing import write_dataset

# The same examples in every run; `make properties` looks at others, and at many. How long one may
# take is no matter: the machine may be busy.
PATIENT = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("same", PATIENT, derandomize=True)
settings.register_profile("many", PATIENT, max_examples=5000)
settings.load_profile("same")

# A shell has those that it starts in the background ignore Ctrl-C, `nohup` a terminal that closes,
# and their children do too.
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGHUP, signal.SIG_DFL)

# Begun first: at the end a module of minutes would keep one process busy and the others waiting.
LONGEST = (
    *("studies/commands/test_close_loop", "whole_job/test_whole_job"),
    *("hostile/test_hostile_files", "commands/test_streams", "commands/test_live"),
    *("studies/challenge/test_found", "sweeping/test_cluster", "diagnosis/test_faults"),
    *("reporting/test_in_browser", "commands/test_calibrate"),
    *("identification/test_odd_recordings", "metamorphic/test_relations"),
    *("identification/test_long_runs", "diagnosis/test_counted_once", "studies/challenge/test_run"),
    *("diagnosis/test_plan", "fuzz/test_replay", "studies/commands/test_challenge"),
    *("commands/test_view", "reporting/stream/test_tendon", "stages/test_identify_harmonic_drive"),
    *("stages/test_python_page", "project/test_names", "studies/challenge/test_same_numbers"),
    *("stages/test_api", "commands/test_sweep", "studies/challenge/rig/test_hidden"),
    *("numerics/test_compiled", "identification/test_calibration", "studies/challenge/test_make"),
    *("docs/test_examples", "reporting/test_prediction", "numerics/test_conditioning_pieces"),
    *("fuzz/test_search", "pipelines/test_pipelines", "storage/test_wrong"),
)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the longest modules first, in their order, in each process alike."""
    place = {f"tests/{name}.py": k for k, name in enumerate(LONGEST)}
    items.sort(key=lambda item: place.get(item.nodeid.partition("::")[0], len(place)))


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Collect tests without searching the thousands that are kept for garbage, then or later."""
    gc.disable()
    found = yield
    gc.freeze()
    gc.enable()
    return found


@pytest.fixture(scope="session")
def warm() -> Iterator[Warm | None]:
    """A process that forks for each call of the command line, where processes can."""
    started = Warm() if hasattr(os, "fork") else None
    yield started
    if started is not None:
        started.close()


@pytest.fixture
def tsas(warm: Warm | None) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Run the command line in a process of its own; keywords are passed to `subprocess.run`."""

    def run(*arguments: object, **keywords: object) -> subprocess.CompletedProcess[str]:
        words = [str(argument) for argument in arguments]
        heeded = os.environ.get("PYTHONWARNINGS", "")
        simple = keywords.keys() <= {"cwd"} and heeded in ("", "error")
        if warm is not None and simple and warm.environment == environment():
            cwd = Path(str(keywords.get("cwd", Path.cwd())))
            return warm.run(words, cwd, strict=heeded == "error")[0]
        call = [sys.executable, "-m", "tsas_cli", *words]
        return subprocess.run(call, capture_output=True, text=True, check=False, **keywords)  # type: ignore[call-overload]

    return run


@pytest.fixture
def strict(
    tsas: Callable[..., subprocess.CompletedProcess[str]], monkeypatch: pytest.MonkeyPatch
) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Run the command line in a process of its own with every warning an error."""
    monkeypatch.setenv("PYTHONWARNINGS", "error")
    return tsas


@pytest.fixture
def done(strict: Callable[..., subprocess.CompletedProcess[str]]) -> Callable[..., str]:
    """Run the command line, which succeeds without a word beside what it prints; return that."""

    def run(*words: object, **keywords: object) -> str:
        ended = strict(*words, **keywords)
        assert (ended.returncode, ended.stderr) == (0, "")
        return ended.stdout

    return run


@pytest.fixture
def refused(strict: Callable[..., subprocess.CompletedProcess[str]]) -> Callable[..., str]:
    """Run the command line, which refuses the call in one line and prints nothing; return that."""

    def run(*words: object, **keywords: object) -> str:
        ended = strict(*words, **keywords)
        assert (ended.returncode, ended.stdout, ended.stderr.count("\n")) == (2, "", 1)
        return ended.stderr

    return run


@pytest.fixture
def here(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[..., tuple[object, str, str]]:
    """Run the command line in this process: its exit code, its output, and its messages."""

    def run(*words: object) -> tuple[object, str, str]:
        monkeypatch.setattr("sys.argv", ["tsas", *map(str, words)])
        with pytest.raises(SystemExit) as end:
            main()
        return end.value.code or 0, *capsys.readouterr()

    return run


@pytest.fixture
def refused_here(here: Callable[..., tuple[object, str, str]]) -> Callable[..., str]:
    """Run the command line in this process, which refuses the call as in `refused`."""

    def run(*words: object) -> str:
        code, out, err = here(*words)
        assert (code, out, err.count("\n")) == (2, "", 1)
        return err

    return run


@pytest.fixture
def columns() -> dict[str, np.ndarray]:
    """Half a second of a pull and its release, exact to the last bit."""
    time_s = np.arange(500) / 1000
    x_in_mm = 10 - 10 * np.cos(4 * np.pi * time_s)
    return {"time_s": time_s, "x_in_mm": x_in_mm, "f_in_N": 25 + 2.5 * x_in_mm}


@pytest.fixture
def manifest() -> Manifest:
    """One run `a`; its checksum is a placeholder until the dataset is written."""
    run = {"id": "a", "file": "runs/a.parquet", "sha256": "0" * 64, "preload_N": 25.0}
    return Manifest.model_validate(
        {"format": 1, "name": "bench-42", "kind": "measured", "run": [run]}
    )


@pytest.fixture
def dataset(tmp_path: Path, manifest: Manifest, columns: dict[str, np.ndarray]) -> Path:
    """Return the folder of a dataset with one run."""
    folder = tmp_path / "dataset"
    folder.mkdir()
    write_dataset(folder, manifest, {"a": pa.table(columns)})
    return folder


@pytest.fixture(scope="session")
def calibrations(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two datasets with calibrations: 1 of the nominal rig, 2 of one with friction 0.15.

    Beside them `again`, other recordings of the nominal rig. No test changes any of it.
    """
    from tests.comparing.made import NOMINAL, ROUGH, calibrated, recorded

    root = tmp_path_factory.mktemp("calibrations")
    calibrated(root, NOMINAL, seed=1)
    calibrated(root, ROUGH, seed=2)
    recorded(root / "again", NOMINAL, seed=3)
    return root
