import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import tsas_cli
from tsas_cli.numerics.compiled import PARTS

PACKAGE = Path(tsas_cli.__file__).parent
USE_A_KERNEL = """
import json, sys
import numpy as np
from numba.core import event
with event.install_recorder("numba:compile") as compilations:
    from tsas_cli.numerics.turning_points import turning_points
    turns = turning_points(np.cumsum(np.random.default_rng(1).standard_normal(5000)), 3.0)
import numba
print(json.dumps([len(compilations.buffer), numba.config.CACHE_DIR, turns.tolist()]))
"""


def run(program: str, folder: Path, **environment: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", program],
        cwd=folder,
        env=os.environ | {name: str(value) for name, value in environment.items()},
        capture_output=True,
        text=True,
        check=True,
    )


def use_a_kernel(folder: Path, cache: Path) -> tuple[int, str, list[int]]:
    """Return how often numba compiled, the folder of the machine code, and the result."""
    compilations, place, turns = json.loads(run(USE_A_KERNEL, folder, TSAS_CACHE_DIR=cache).stdout)
    return compilations, place, turns


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """Copy the package, so that a test may edit it; imported from this folder."""
    shutil.copytree(PACKAGE, tmp_path / "copy" / "tsas_cli")
    return tmp_path / "copy"


def test_the_second_process_compiles_nothing(tmp_path: Path) -> None:
    first, place, turns = use_a_kernel(tmp_path, tmp_path / "cache")
    second, same_place, same_turns = use_a_kernel(tmp_path, tmp_path / "cache")
    assert first > 0
    assert second == 0
    assert (same_place, same_turns) == (place, turns)
    assert Path(place).is_relative_to(tmp_path / "cache")


def test_an_edit_in_any_kernel_file_is_compiled_anew(copy: Path, tmp_path: Path) -> None:
    _, before, _ = use_a_kernel(copy, tmp_path / "cache")
    with (copy / "tsas_cli" / "physics" / "__init__.py").open("a") as source:
        source.write("# edited\n")
    compilations, after, _ = use_a_kernel(copy, tmp_path / "cache")
    assert after != before
    assert compilations > 0


def test_an_edit_elsewhere_compiles_nothing(copy: Path, tmp_path: Path) -> None:
    use_a_kernel(copy, tmp_path / "cache")
    with (copy / "tsas_cli" / "commands" / "common.py").open("a") as source:
        source.write("# edited\n")
    assert use_a_kernel(copy, tmp_path / "cache")[0] == 0


def test_kernels_live_only_where_edits_are_seen() -> None:
    users = {p for p in PACKAGE.rglob("*.py") if "compiled import kernel" in p.read_text()}
    assert users
    assert {path.relative_to(PACKAGE).parts[0] for path in users} <= set(PARTS)


def test_without_a_cache_kernels_still_run(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    _, with_cache, turns = use_a_kernel(tmp_path, tmp_path / "cache")
    compilations, none, same_turns = use_a_kernel(tmp_path, tmp_path / "file")
    assert (with_cache != "", none) == (True, "")
    assert compilations > 0
    assert same_turns == turns


def test_plain_python_gives_the_same_and_loads_no_compiler(tmp_path: Path) -> None:
    program = """
import json, sys
import numpy as np
from tsas_cli.numerics.turning_points import turning_points
turns = turning_points(np.cumsum(np.random.default_rng(1).standard_normal(5000)), 3.0)
print(json.dumps(["numba" in sys.modules, turns.tolist()]))
"""
    compiled_loaded, compiled = json.loads(run(program, tmp_path).stdout)
    plain_loaded, plain = json.loads(run(program, tmp_path, TSAS_PLAIN_PYTHON=1).stdout)
    assert (compiled_loaded, plain_loaded) == (True, False)
    assert plain == compiled
    assert len(plain) > 20


NO_ROOM = """
import errno
from numba.core import caching
def full(*_):
    raise OSError(errno.ENOSPC, "No space left on device")
caching.IndexDataCacheFile.save = full
"""


def test_a_full_disk_of_the_cache_is_no_error_of_the_call(tmp_path):
    """Before, it was told as a full disk of the output."""
    done = run(NO_ROOM + USE_A_KERNEL, tmp_path, TSAS_CACHE_DIR=tmp_path / "cache")
    compilations, _, turns = json.loads(done.stdout)
    assert compilations > 0
    assert len(turns) > 2
