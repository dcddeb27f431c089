"""Colours of tensions: a map that is even to the eye, dimmed where the tendon sticks."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from tsas_cli.reporting.numbers import round_ticks

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]

MAP = "plasma"
FROM, TO = 0.18, 0.97  # of it: its dark end is lost on a dark ground
STEPS = (1.0, 2.0, 2.5, 5.0, 10.0)
TICKS = 5  # at most, on the legend


@dataclass(frozen=True)
class Scale:
    """The tensions that the colours stand for, the same for all that is shown together [N]."""

    low: float
    high: float
    ticks: tuple[float, ...]

    def colours(self, tension_N: Floats) -> Bytes:
        """Return red, green, blue of tensions of any shape, shape (..., 3)."""
        from matplotlib import colormaps

        table = (255.0 * colormaps[MAP](np.linspace(FROM, TO, 256))[:, :3]).round()
        share = (np.nan_to_num(tension_N) - self.low) / (self.high - self.low)
        return np.asarray(table[np.clip(255.0 * share, 0.0, 255.0).astype(int)], dtype=np.uint8)


def scale_of(low: float, high: float) -> Scale:
    """Return the scale from one tension to another, with round ticks inside [N]."""
    high = max(high, low + 1e-9 * max(abs(low), 1.0))
    return Scale(low, high, tuple(round_ticks(low, high, (high - low) / TICKS, STEPS)))


def packed(colours: Bytes) -> npt.NDArray[np.uint32]:
    """Return 0xRRGGBBAA, opaque, of red, green, blue, shape (..., 3)."""
    red, green, blue = (colours[..., k].astype(np.uint32) for k in range(3))
    return ((red << 24) | (green << 16) | (blue << 8) | 0xFF).astype(np.uint32)


def dimmed(colours: Bytes, share: float, ground: int) -> Bytes:
    """Return colours mixed with the ground's, 0xRRGGBBAA, by a share."""
    under = np.array([ground >> 24, ground >> 16 & 0xFF, ground >> 8 & 0xFF])
    mixed = (1.0 - share) * colours + share * under
    return np.asarray(mixed.round(), dtype=np.uint8)
