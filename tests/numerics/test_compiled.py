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
    from tsas_cli.numerics.turning_points import last_beyond
    found = last_beyond(np.arange(5000.0), 4000, 3.5)
import numba
print(json.dumps([len(compilations.buffer), numba.config.CACHE_DIR, found]))
"""


def use_a_kernel(folder, cache, *, changes=""):
    """Return how often numba compiled, the folder of the machine code, the result, messages."""
    done = subprocess.run(
        [sys.executable, "-c", changes + USE_A_KERNEL],
        cwd=folder,
        env=os.environ | {"TSAS_CACHE_DIR": str(cache)},
        capture_output=True,
        text=True,
        check=True,
    )
    return (*json.loads(done.stdout), done.stderr)


@pytest.fixture(scope="module")
def first(tmp_path_factory):
    """Return a cache that was empty, and the first use of a kernel with it."""
    cache = tmp_path_factory.mktemp("first") / "cache"
    return cache, use_a_kernel(cache.parent, cache)


def test_the_second_process_compiles_nothing(first, tmp_path):
    cache, (compilations, *found) = first
    assert compilations > 0
    assert use_a_kernel(tmp_path, cache) == (0, *found)
    assert Path(found[0]).is_relative_to(cache)


def test_an_edit_of_any_kernel_file_is_compiled_anew_and_no_other(tmp_path):
    shutil.copytree(PACKAGE, tmp_path / "tsas_cli")  # which the process imports
    _, before, *_ = use_a_kernel(tmp_path, tmp_path / "cache")
    for edited, anew in (("commands/common.py", False), ("physics/__init__.py", True)):
        with (tmp_path / "tsas_cli" / edited).open("a") as source:
            source.write("# edited\n")
        compilations, after, *_ = use_a_kernel(tmp_path, tmp_path / "cache")
        assert (after != before, compilations > 0) == (anew, anew)


def test_kernels_live_only_where_edits_are_seen():
    users = {p for p in PACKAGE.rglob("*.py") if "compiled import kernel" in p.read_text()}
    assert users
    assert {path.relative_to(PACKAGE).parts[0] for path in users} <= set(PARTS)


def test_without_a_cache_kernels_still_run(first, tmp_path):
    (tmp_path / "file").write_text("")
    compilations, none, found, _ = use_a_kernel(tmp_path, tmp_path / "file")
    assert (first[1][1] != "", none) == (True, "")
    assert compilations > 0
    assert found == first[1][2]


NO_ROOM = """
import errno
from numba.core import caching
def full(*_):
    raise OSError(errno.ENOSPC, "No space left on device")
caching.IndexDataCacheFile.save = full
"""


def test_a_full_disk_of_the_cache_is_no_error_of_the_call(tmp_path):
    """Before, it was told as a full disk of the output."""
    compilations, _, found, _ = use_a_kernel(tmp_path, tmp_path / "cache", changes=NO_ROOM)
    assert compilations > 0
    assert found == 3996


@pytest.mark.parametrize(("files", "bytes_left"), [("*.nbi", 0), ("*.nbc", 400)])
def test_damaged_machine_code_is_compiled_again(first, tmp_path, files, bytes_left):
    """Before, it ended the process."""
    cache = tmp_path / "cache"
    shutil.copytree(first[0], cache)
    for file in cache.rglob(files):
        file.write_bytes(file.read_bytes()[:bytes_left])
    compilations, _, found, told = use_a_kernel(tmp_path, cache)
    assert (compilations > 0, found) == (True, first[1][2])
    assert "is damaged; the kernel is compiled again" in told
    assert use_a_kernel(tmp_path, cache)[0] == 0
