import json
import os
import subprocess
import sys

import pytest

USE_THE_RIG = """
import json
from numba.core import event
with event.install_recorder("numba:compile") as compilations:
    from tsas_studies.challenge.rig.motions import through
    from tsas_studies.challenge.rig.tendon import Rig, simulate
    columns = simulate(Rig(cells=10), through([1.0], rate_Hz=50.0)).columns
print(json.dumps([len(compilations.buffer), float(columns["f_in_N"][-1])]))
"""


def use_the_rig(**environment):
    """Return how often numba compiled, and a result, in a new process."""
    answer = subprocess.run(
        [sys.executable, "-c", USE_THE_RIG],
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(answer.stdout)


def test_the_second_process_compiles_nothing():
    compilations, tension = use_the_rig()  # some where no test has used the rig before
    assert compilations == 0 or use_the_rig() == [0, tension]


@pytest.mark.large
def test_no_cache_is_no_obstacle(tmp_path):
    (tmp_path / "file").write_text("")
    compiled, tension = use_the_rig(TSAS_CACHE_DIR=str(tmp_path / "file"))
    assert compiled > 0
    assert tension == use_the_rig()[1]
