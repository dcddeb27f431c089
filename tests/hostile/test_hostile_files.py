"""Files made to harm: each costs one line, little memory and little time, and nothing is written.

Every call is a process of its own with little memory and time (tests/warm.py).
"""

import sys

import pytest

pytest.importorskip("h5py")
pytest.importorskip("asammdf")

from tests.hostile import hdf5, manifests, matlab5, mdfs, parquets, stages, text
from tests.warm import Warm

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="memory is limited on Linux only")

KINDS = (hdf5, manifests, matlab5, mdfs, parquets, stages, text)
CASES = [(kind.__name__.rpartition(".")[2], case) for kind in KINDS for case in kind.CASES]
OUTPUTS = {"out", "o", "page.html", "o.html"}  # what the calls are told to write
MOST = 400 << 20  # bytes that any of them may take


@pytest.fixture(scope="module")
def limited():
    """A process that has the libraries for formats of others imported too."""
    warm = Warm("asammdf", "h5py", "scipy.io", OPENBLAS_NUM_THREADS="1", TSAS_THREADS="1")
    yield warm
    warm.close()


@pytest.mark.parametrize("case", [pytest.param(c, id=f"{kind}: {c.name}") for kind, c in CASES])
def test_it_costs_one_line(case, limited, tmp_path):
    call = case.make(tmp_path)
    before = everything(tmp_path)
    ended, taken = limited.run(call, tmp_path, limited=True)
    assert ended.returncode == (2 if case.says else 0), ended
    new = everything(tmp_path) - before
    if case.says:
        assert ended.stderr.startswith("tsas: ")
        assert ended.stderr.count("\n") == 1
        assert case.says in ended.stderr
        assert len(ended.stderr) < 2000
        assert ended.stdout == ""
        assert not new
    assert {path.split("/")[0] for path in new} <= OUTPUTS
    assert (ended.stderr + ended.stdout).replace("\n", "").isprintable()
    assert taken < MOST


def everything(folder):
    """Return all that is in a folder, and in no link."""
    return {str(path.relative_to(folder)) for path in folder.rglob("*")}
