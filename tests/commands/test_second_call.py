import subprocess
import sys
from pathlib import Path

from tsas_studies.challenge.rig.motions import sine
from tsas_studies.challenge.rig.recordings import Run, conditions, record, write_dataset
from tsas_studies.challenge.rig.sensors import Sensors
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
    """The first need not either: other tests may have made its machine code."""
    rig = Rig(proximal_length_mm=150.0, distal_length_mm=60.0, cells=30)
    columns = record(rig, sine(rate_Hz=200.0), sensors=Sensors(rate_Hz=50.0))
    dataset = write_dataset(tmp_path / "dataset", [Run("a", columns, conditions(rig))])
    call = [sys.executable, "-c", COUNT_COMPILATIONS, "calibrate", dataset, "--quiet", "--out"]
    for number in ("first", "second"):
        result = subprocess.run(
            [*call, tmp_path / number], capture_output=True, text=True, check=False
        )
        assert result.returncode == 0, result.stderr
    assert int(result.stdout) == 0
