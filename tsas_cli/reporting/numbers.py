"""How numbers are printed: with the digits that their interval justifies."""

import math

import numpy as np

from tsas_cli.records.base import Value
from tsas_cli.records.tracking import Spread
from tsas_cli.support.arrays import Floats

MINUS = "\N{MINUS SIGN}"
ABSENT = "\N{EN DASH}"
_MOST_DECIMALS = 9
_DIGITS = 5  # of what others print
_SMALL = 4  # zeros after the point, beyond which a power of ten reads better
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def plain(value: float | None, digits: int = 4) -> str:
    """Return a number with so many significant digits; an en dash where there is none.

    >>> plain(67858.4), plain(0.125), plain(None)
    ('67860', '0.1250', '–')
    """
    if value is None or not math.isfinite(value):
        return ABSENT
    return _fixed(value, digits - 1 - _exponent(value))


def over(value: float | None, noise: float | None) -> str:
    """Return a residual over the noise level; an en dash where one of them is not known.

    >>> over(0.91, 0.1), over(None, 0.1), over(0.91, None)
    ('9.10', '–', '–')
    """
    return ABSENT if value is None or not noise else plain(value / noise, 3)


def over_seeds(first: int, last: int) -> str:
    """Return the end of a table's title that explains the spreads; empty for a single seed."""
    many = last - first + 1
    return f", mean ± standard deviation over {many} seeds of noise" if many > 1 else ""


def as_printed(value: float | None) -> str:
    """Return a number without trailing zeros, to five digits; an en dash where there is none.

    >>> as_printed(101.96), as_printed(25.0), as_printed(-8644.38)
    ('101.96', '25', '−8644.4')
    """
    if value is None or not math.isfinite(value):
        return ABSENT
    fixed = _fixed(value, _DIGITS - 1 - _exponent(value))
    return fixed.rstrip("0").rstrip(".") if "." in fixed else fixed


def with_interval(value: float | None, low: float | None, high: float | None) -> tuple[str, str]:
    """Return a value and its interval, rounded to the second digit of the interval's half width.

    Where the half width exceeds the value and the interval excludes zero, each number is rounded to
    its own digits.

    >>> with_interval(2.33812, 2.3262, 2.3501), with_interval(14242.0, 10.0, 1e8)
    (('2.338', '2.326 to 2.350'), ('14200', '10 to 100000000'))
    """
    if value is None or low is None or high is None or not math.isfinite(high - low):
        return plain(value), ABSENT
    width = (high - low) / 2
    if width <= 0:
        return plain(value), ABSENT
    if width > abs(value) and low * high > 0.0:
        return plain(value, 3), f"{plain(low, 2)} to {plain(high, 2)}"
    decimals = 1 - _exponent(width)
    return _fixed(value, decimals), f"{_fixed(low, decimals)} to {_fixed(high, decimals)}"


def value_and_interval(shown: Value | None) -> tuple[str, str]:
    """Return a value and its interval, as `with_interval` does; en dashes where there is none."""
    if shown is None:
        return ABSENT, ABSENT
    return with_interval(shown.value, shown.interval_low, shown.interval_high)


def with_spread(score: Spread) -> str:
    """Return a mean and its standard deviation: four digits, or up to the deviation's first.

    >>> with_spread(Spread(mean=0.867303, sd=0.000108)), with_spread(Spread(mean=0.867303, sd=0.12))
    ('0.8673 ± 0.0001', '0.9 ± 0.1')
    """
    mean, sd = score.mean, score.sd
    if mean is None:
        return ABSENT
    if not sd:
        return plain(mean) if mean else "0"
    decimals = min(-_exponent(sd), 3 - _exponent(mean))
    return f"{_fixed(mean, decimals)} ± {plain(sd, 1)}"


def spanned(values: Floats) -> str:
    """Return the lowest and the highest of some numbers, gaps left out.

    >>> import numpy as np
    >>> spanned(np.array([2.0, np.nan, -0.5]))
    '−0.500 to 2.00'
    """
    finite = values[np.isfinite(values)]
    if not finite.size:
        return ABSENT
    return f"{plain(float(finite.min()), 3)} to {plain(float(finite.max()), 3)}"


def fixed(value: float | None, decimals: int) -> str:
    """Return a number with so many decimals; an en dash where there is none.

    >>> fixed(48.24, 1), fixed(-0.01, 1), fixed(None, 1)
    ('48.2', '0.0', '–')
    """
    return ABSENT if value is None or not math.isfinite(value) else _fixed(value, decimals)


def _exponent(value: float) -> int:
    return math.floor(math.log10(abs(value))) if value else 0


def _fixed(value: float, decimals: int) -> str:
    """Round to a number of decimals, or of tens where it is negative; powers of ten if needed."""
    exponent = _exponent(value)
    if decimals > _MOST_DECIMALS and value and exponent < -_SMALL:
        power = str(exponent).translate(RAISED)
        return (
            f"{_fixed(value / 10.0**exponent, min(decimals + exponent, _MOST_DECIMALS))}·10{power}"
        )
    decimals = min(decimals, _MOST_DECIMALS)
    rounded = round(value, decimals) + 0.0  # minus zero becomes zero
    return f"{rounded:.{max(decimals, 0)}f}".replace("-", MINUS)
