"""Slip state of an element of the tendon, or phase of the whole tendon, at a moment.

+1 where it slips in contraction, −1 in loosening, 0 where it sticks, and the two below.
"""

import numpy as np
import numpy.typing as npt

Phases = npt.NDArray[np.int8]

SLACK, UNCONVERGED = 2, 3
SLIDING_SHARE = 0.99  # of its friction limit, from which a node or element with presliding slips
