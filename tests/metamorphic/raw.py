"""Recordings as a person has them, CSV files and a map, and what may be done to them."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from datetime import datetime, timedelta

import numpy as np

from tsas_studies.challenge.bench import RUNS, SENSORS, clean_run, data_sheet, drawn_bench
from tsas_studies.challenge.cases import FULL, Hidden
from tsas_studies.challenge.rig.sensors import measure, quantised

RATE_HZ = 40.0
TAKEN = ("b", "d")  # of the runs of the benchmark: two speeds, two bends and two lengths
UNITS = {"time_s": "s", "x_in_mm": "mm", "x_out_mm": "mm", "f_in_N": "N", "f_out_N": "N"}
IMPERIAL = {"time_s": "ms", "x_in_mm": "in", "x_out_mm": "in", "f_in_N": "lbf", "f_out_N": "lbf"}
PER_UNIT = {"s": 1.0, "mm": 1.0, "N": 1.0, "rpm": 1.0} | {
    "ms": 1e-3,
    "in": 25.4,
    "lbf": 4.4482216152605,
    "rad/s": 30.0 / np.pi,
}
CLOCK = "time_s"


@dataclass(frozen=True)
class Raw:
    """Columns and conditions of each run, and what the map says beside them."""

    runs: Mapping[str, Mapping[str, np.ndarray]]
    conditions: Mapping[str, Mapping[str, object]]
    sheet: Mapping[str, float]
    units: Mapping[str, str] = field(default_factory=lambda: UNITS)
    keys: Mapping[str, str] = field(default_factory=dict)  # of columns, such as "sign = -1"
    extra: tuple[str, ...] = ()

    def each(self, change, **more):
        """Return the recordings with the columns of each run changed."""
        runs = {run: dict(change(dict(columns))) for run, columns in self.runs.items()}
        return replace(self, runs=runs, **more)

    def write(self, folder):
        """Write a file for each run, and `map.toml` beside their folder; return both."""
        (folder / "raw").mkdir(parents=True)
        for run, columns in self.runs.items():
            np.savetxt(
                folder / "raw" / f"{run}.csv",
                np.column_stack(list(columns.values())),
                delimiter=",",
                header=",".join(columns),
                comments="",
                fmt="%.17g",
            )
        lines = ["[dataset]", 'name = "bench"', "[read]", f"extra = {list(self.extra)}", "[rig]"]
        lines += [f"{key} = {value!r}" for key, value in self.sheet.items()]
        for name, unit in self.units.items():
            lines += [f"[columns.{name}]", f'source = "{name}"', f'unit = "{unit}"']
            lines += [self.keys.get(name, "")]
        for run, told in self.conditions.items():
            lines += [f"[run.table.{run}]"] + [f"{key} = {value}" for key, value in told.items()]
        (folder / "map.toml").write_text("\n".join(lines), encoding="utf-8")
        return folder / "raw", folder / "map.toml"


def recorded(effect=None, *, seed=1):
    """Return two runs of the independent rig with an effect hidden, or nothing."""
    bench = drawn_bench(np.random.default_rng(seed))
    hidden = [Hidden(effect, FULL[effect][0])] if effect else []
    runs, conditions = {}, {}
    for number, run in enumerate(TAKEN):
        _, _, radius, bend = RUNS[run]
        clean, sensors = clean_run(bench, hidden, run, rate_Hz=RATE_HZ)
        runs[run] = measure(clean, sensors, seed=100 * seed + number)
        conditions[run] = {
            "sheath_length_mm": radius * bend,
            "total_bend_rad": bend,
            "preload_N": 25.0,
            "started": bench.started[run].isoformat(),
        }
    sheet = data_sheet()
    sheet.pop("preload_N")  # stands beside each run
    return Raw(runs, conditions, sheet)


def later(raw, seconds):
    return raw.each(lambda c: c | {CLOCK: c[CLOCK] + seconds})


def called(raw, names):
    runs, conditions = (
        {new: of[old] for old, new in names.items()} for of in (raw.runs, raw.conditions)
    )
    return replace(raw, runs=runs, conditions=conditions)


def in_units(raw, units):
    return raw.each(
        lambda c: {name: c[name] / PER_UNIT[unit] for name, unit in units.items()}, units=units
    )


def turned_round(raw):
    """Wire every sensor the other way, and say so in the map."""
    keys = {name: "sign = -1" for name in UNITS if name != CLOCK}
    return raw.each(lambda c: {n: v if n == CLOCK else -v for n, v in c.items()}, keys=keys)


def with_strangers(raw):
    """Put columns that mean nothing beside the others and among them."""
    rng = np.random.default_rng(7)

    def change(c):
        noise = 1e6 * rng.standard_normal(c[CLOCK].size)
        return {"noise": noise, **dict(reversed(c.items())), "other": noise[::-1]}

    return raw.each(change, extra=("noise",))


def every_second(raw):
    return raw.each(lambda c: {name: values[::2] for name, values in c.items()})


def resampled(raw, times):
    """Lay all channels on a faster clock, straight between samples."""

    def change(c):
        clock = np.linspace(c[CLOCK][0], c[CLOCK][-1], times * (c[CLOCK].size - 1) + 1)
        return {n: clock if n == CLOCK else np.interp(clock, c[CLOCK], v) for n, v in c.items()}

    return raw.each(change)


def at_rest(raw, seconds, *, before):
    """Record for longer while nothing moves, before the motion or after it."""
    rng = np.random.default_rng(8)

    def change(c):
        count = round(seconds * RATE_HZ)
        out = {CLOCK: np.round(np.arange(c[CLOCK].size + count) / RATE_HZ, 9)}
        for name in (name for name in c if name != CLOCK):
            sensor = getattr(SENSORS, name)
            level = np.mean(c[name][:3] if before else c[name][-3:])
            rest = quantised(level + sensor.noise * rng.standard_normal(count), sensor.step)
            out[name] = np.concatenate((rest, c[name]) if before else (c[name], rest))
        return out

    return raw.each(change)


def cut(raw):
    """Make two runs of each, where the sine ends and the strokes begin."""
    runs, conditions = {}, {}
    for run, columns in raw.runs.items():
        omega, periods, _, _ = RUNS[run]
        at = int(np.searchsorted(columns[CLOCK], periods * 2.0 * np.pi / omega))
        told = raw.conditions[run]
        begun = datetime.fromisoformat(told["started"])
        second = begun + timedelta(seconds=float(columns[CLOCK][at]))
        runs[run] = {name: values[:at] for name, values in columns.items()}
        runs[f"{run}2"] = {name: values[at:] for name, values in columns.items()}
        conditions |= {run: told, f"{run}2": {**told, "started": second.isoformat()}}
    return replace(raw, runs=runs, conditions=conditions)


def moved(raw, column, by):
    return raw.each(lambda c: c | {column: c[column] + by})


def stronger(raw, times):
    """Make all that is a force, or a force per length, so many times as large."""
    conditions = {run: {**c, "preload_N": 25.0 * times} for run, c in raw.conditions.items()}
    per_length = ("tendon_modulus_GPa", "load_stiffness_N_per_mm")
    sheet = {**raw.sheet, **{key: times * raw.sheet[key] for key in per_length}}
    forces = ("f_in_N", "f_out_N")
    return raw.each(
        lambda c: c | {name: times * c[name] for name in forces},
        conditions=conditions,
        sheet=sheet,
    )
