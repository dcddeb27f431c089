import subprocess
import sys
from pathlib import Path

from tests.rigs import dataset_of, recorded
from tsas_studies.challenge.rig.tendon import Rig

COUNT_COMPILATIONS = """
import sys
from numba.core import event
from tsas_cli.__main__ import main
with event.install_recorder("numba:compile") as compilations:
    try:
        main()
    except SystemExit as stopped:
        assert not stopped.code
print(len(compilations.buffer))
"""


def test_the_second_call_compiles_nothing(tmp_path: Path) -> None:
    """Nor does the first where other tests have made its machine code."""
    rig = Rig(proximal_length_mm=150.0, distal_length_mm=60.0, cells=30)
    dataset = dataset_of(rig, tmp_path / "dataset", a=recorded(rig, 50.0))
    call = [sys.executable, "-c", COUNT_COMPILATIONS, "calibrate", dataset, "--quiet", "--out"]
    for number in ("first", "second"):
        out = tmp_path / number
        result = subprocess.run([*call, out], stdout=subprocess.PIPE, text=True, check=True)
        if int(result.stdout) == 0:
            return
    raise AssertionError(f"{result.stdout.strip()} compilations")
