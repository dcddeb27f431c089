from pathlib import Path

import numpy as np
import pytest

from tsas_cli.recordings.readers.timebase import on_one_clock
from tsas_cli.support.errors import InputError

FAST = np.arange(9) / 10


@pytest.mark.parametrize("which", ["fast", "slow"])
@pytest.mark.parametrize("wrong", [0.1, 0.2, np.nan, np.inf])
def test_nothing_is_interpolated_on_a_clock_that_does_not_increase(which, wrong):
    times = {"fast": FAST.copy(), "slow": FAST[::2].copy()}
    times[which][3] = times[which][2] if wrong == 0.2 else wrong
    series = {source: (clock, clock) for source, clock in times.items()}
    with pytest.raises(InputError, match=rf"a.mf4, row 4: the time of {which} does not increase"):
        on_one_clock(series, Path("a.mf4"), clock_sources=["time"], resample=True)
