"""The wanted force over time: shapes by name, or a trajectory that was recorded."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from tsas_cli.recordings.run_files import read_columns
from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError, nearest
from tsas_cli.tracking import SHAPE_NAMES
from tsas_cli.tracking.settings import LONGEST_S, ReferenceSettings

WANTED, MEASURED = "f_out_ref_N", "f_out_N"
FEWEST_SAMPLES = 10  # of a period; far fewer are another wave
MOST_SAMPLES = 10_000_000  # of a loop, which then takes minutes and 1 GB


def sine(t: Floats, form: ReferenceSettings) -> Floats:
    """Return mean + amplitude sin(ω t − π/2), as in Figs. 10 and 11 of Yang 2025."""
    return form.mean_N - form.amplitude_N * np.cos(form.angular_frequency_rad_per_s * t)


def two_frequency(t: Floats, form: ReferenceSettings) -> Floats:
    """Begin with two periods at twice the frequency, as in Fig. 9, then go on with the sine."""
    w = form.angular_frequency_rad_per_s
    switch = 2.0 * np.pi / w
    return form.mean_N - form.amplitude_N * np.cos(np.where(t < switch, 2.0 * w * t, w * t))


def steps(t: Floats, form: ReferenceSettings) -> Floats:
    """Return four levels a period, each held: low, middle, high, middle."""
    part = np.floor(4.0 * t * form.angular_frequency_rad_per_s / (2.0 * np.pi)).astype(int) % 4
    levels: Floats = form.mean_N + form.amplitude_N * np.array([-1.0, 0.0, 1.0, 0.0])
    wanted: Floats = levels[part]
    return wanted


def ramps(t: Floats, form: ReferenceSettings) -> Floats:
    """Return a triangle of the sine's period and range."""
    part = (t * form.angular_frequency_rad_per_s / (2.0 * np.pi)) % 1.0
    return form.mean_N + form.amplitude_N * (1.0 - 4.0 * np.abs(part - 0.5))


SHAPES: dict[str, Callable[[Floats, ReferenceSettings], Floats]] = dict(
    zip(SHAPE_NAMES, (sine, two_frequency, steps, ramps), strict=True)
)


def reference(name: str, form: ReferenceSettings, step_s: float) -> Floats:
    """Return the wanted force at each sample, shape (m,) [N].

    `name` is a shape, or a Parquet file with `time_s` and `f_out_ref_N` (or else `f_out_N`),
    linear between its samples.

    InputError: there is no such shape or file, the file lacks a column or has gaps, or the force is
    not positive somewhere, or there are too many samples, or too few of a period.
    """
    if name in SHAPES:
        where = f"reference {name}"
        fastest = (2.0 if name == "two-frequency" else 1.0) * form.angular_frequency_rad_per_s
        if step_s * fastest * FEWEST_SAMPLES > 2.0 * np.pi:
            raise InputError(
                f"{fastest:g} rad/s have {2.0 * np.pi / (step_s * fastest):.3g} samples a period",
                where=where,
                expected=f"at least {FEWEST_SAMPLES}",
                remedy="lower reference.angular_frequency_rad_per_s, or raise sensor.rate_Hz",
            )
        time_s = _grid(round(form.duration_s / step_s) + 1, step_s, where)
        wanted = SHAPES[name](time_s, form)
    elif Path(name).suffix == ".parquet" or Path(name).exists():
        time_s, wanted = _recorded(Path(name), step_s)
        where = name
    else:
        raise InputError(
            f"unknown reference {name}", remedy=f"{nearest(name, SHAPES)} or name a Parquet file"
        )
    low = np.flatnonzero(wanted <= 0.0)
    if low.size:
        raise InputError(
            f"asks for {wanted[low[0]]:.4g} N at {time_s[low[0]]:.4g} s",
            where=where,
            expected="a tension above zero: a tendon cannot push",
        )
    return wanted


def _grid(samples: int, step_s: float, where: object) -> Floats:
    """Return the times of so many samples, shape (samples,) [s]."""
    if samples > MOST_SAMPLES:
        raise InputError(
            f"has {samples} samples at {1.0 / step_s:g} Hz",
            where=where,
            expected=f"at most {MOST_SAMPLES}",
            remedy="shorten it (reference.duration_s), or lower sensor.rate_Hz",
        )
    return np.arange(samples, dtype=np.float64) * step_s


def _recorded(path: Path, step_s: float) -> tuple[Floats, Floats]:
    columns = read_columns(path)
    name = WANTED if WANTED in columns else MEASURED
    if name not in columns:
        raise InputError(
            f"column {WANTED} is missing", where=path, expected=f"{WANTED} or {MEASURED}"
        )
    values, time_s = columns[name], columns["time_s"]
    if not np.isfinite(values).all():
        row = int(np.flatnonzero(~np.isfinite(values))[0])
        raise InputError(f"{name} has a gap", where=f"{path}, row {row}", expected="a force")
    duration_s = time_s[-1] - time_s[0]
    if duration_s > LONGEST_S:
        raise InputError(
            f"lasts {duration_s:.6g} s", where=path, expected=f"at most {LONGEST_S:.0f} s to track"
        )
    at = _grid(int(duration_s / step_s + 1e-9) + 1, step_s, path)
    return at, np.interp(at, time_s - time_s[0], values)
