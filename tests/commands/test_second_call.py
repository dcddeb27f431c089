import os
import subprocess
import sys
from pathlib import Path

import pytest

from tsas_studies.challenge.rig.recordings import Run, conditions, record, write_dataset
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


@pytest.mark.parametrize("stage", ["check", pytest.param("calibrate", marks=pytest.mark.large)])
def test_the_second_call_compiles_nothing(stage: str, tmp_path: Path) -> None:
    rig = Rig(proximal_length_mm=150.0, distal_length_mm=60.0, cells=30)
    dataset = write_dataset(tmp_path / "dataset", [Run("a", record(rig), conditions(rig))])
    call = [sys.executable, "-c", COUNT_COMPILATIONS, stage, dataset, "--quiet", "--out"]
    counts = []
    for number in ("first", "second"):
        result = subprocess.run(
            [*call, tmp_path / number],
            env=os.environ | {"TSAS_CACHE_DIR": str(tmp_path / "cache")},
            capture_output=True,
            text=True,
            check=False,
        )
        assert result.returncode == 0, result.stderr
        counts.append(int(result.stdout))
    assert counts[0] > 0
    assert counts[1] == 0
