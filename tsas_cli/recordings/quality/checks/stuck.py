"""A channel does not change at all while the motion goes back and forth.

The sensor, its cable or its software hangs. A channel with noise is stuck when it does not change
for 20 rows during visible motion; one without noise only when the drive goes through most of its
span and back, because in a dead band the distal end rests by itself.
"""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.quality.finding import CannotTell, Check, Remark
from tsas_cli.recordings.quality.trial import Trial, plateaus

_FEWEST_ROWS = 20
_HELD = {"force": "f_out_N", "displacement": "x_out_mm"}  # the load may hold this one constant
