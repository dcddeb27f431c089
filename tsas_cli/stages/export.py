"""Export a model for other programs: JSON, CSV, or MuJoCo as far as that can hold it."""

import csv
import io
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tsas_cli.effects import EFFECTS, LAWS, Effects
from tsas_cli.identification.fitted_to import FittedTo
from tsas_cli.identification.model import Model
from tsas_cli.identification.model_file import model_of, read_fitted_to
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.lumped import HELD, Lumped, follow, lumped_of
from tsas_cli.physics.mechanics import mechanics_of
from tsas_cli.physics.response import simulate
from tsas_cli.physics.rig import Rig
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.validation import parse
from tsas_cli.records.base import number_text
from tsas_cli.records.result import Result, Table, heading, notes
from tsas_cli.stages.given import Named, file_of, one_of, path_of
from tsas_cli.stages.mjcf import mjcf
from tsas_cli.support import __version__
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import Raw, json_text, new_file
from tsas_cli.support.replacing import sealed

MARKS = {"json": b'"stage": "export"', "csv": b"name,run,value", "mujoco": b"tsas export"}
STROKE_MM = 10.0  # where the model's file does not say what it was fitted to
STROKES, SAMPLES = 4, 400  # of the motion by which models are compared; samples of a stroke
_ALWAYS_LOST = (
    "friction that grows with the tension (it is constant, that at the mean tension)",
    "friction along the sheath (it acts on the tendon's middle)",
    "errors of sensors, and the intervals of all values",
)


Differences = dict[str, dict[str, Any]]  # by channel: rms, largest, span and unit


@dataclass(frozen=True, repr=False, eq=False)
class ExportResult(Result):
    """A model that was exported; `lost` is what the format cannot hold."""

    lost: tuple[str, ...] = ()

    def tables(self) -> list[Table]:
        """Return the error of what was exported, where there is one."""
        title = f"{self.summary['format_of_model']} → {self.out}"
        rows = [
            (name, *(number_text(one[key]) for key in ("rms", "largest", "span")), one["unit"])
            for name, one in self.summary["errors"].items()
        ]
        return [(title, ("channel", "RMS of difference", "largest", "range", "unit"), rows)]

    def sentences(self) -> list[str]:
        """Return what is lost."""
        return notes([f"Not exported: {sentence}." for sentence in self.lost])


def export(
    model: Model | Named,
    *,
    to: str,
    out: Named,
    sheath_length_mm: float | None = None,
    total_bend_rad: float | None = None,
    preload_N: float | None = None,
    force: bool = False,
) -> ExportResult:
    """Write a model as JSON, CSV or MJCF.

    Parameters
    ----------
    model
        A model, or its file.
    to
        `json`, `csv`, or `mujoco`.
    out
        The file to write.
    sheath_length_mm
        The sheath of a MuJoCo model; without it that of the recordings it was fitted to.
    total_bend_rad
        Its bend, likewise.
    preload_N
        The tension at rest, likewise.
    force
        Replace the file if it is there.

    Returns
    -------
    ExportResult
        `.summary["errors"]` holds, for MuJoCo, the differences of f_in [N] and x_out [mm] from the
        model's own prediction, over slow strokes that pull from the preload.

    Raises
    ------
    InputError
        The model is wrong, a condition is not known, or `out` exists and `force` is not set.
    """
    kind = one_of([*MARKS], to, "to")
    given: Model | Path = path_of(model, Model)
    path = file_of(out)
    found = model_of(given)
    fitted = read_fitted_to(given) if isinstance(given, Path) else None
    errors: Differences = {}
    lost: tuple[str, ...] = ()
    conditions = {
        "sheath_length_mm": sheath_length_mm,
        "total_bend_rad": total_bend_rad,
        "preload_N": preload_N,
    }
    stated = [name for name, value in conditions.items() if value is not None]
    if kind != "mujoco" and stated:
        raise InputError(
            f"{stated[0]} is no part of {kind}",
            expected="a condition with `--to mujoco` alone",
            remedy="leave it out: the model holds what was fitted",
        )
    if kind == "mujoco":
        text, errors, lost = _mujoco(found, fitted or FittedTo(), conditions, path.stem)
        text = sealed(text, markup=True)
    else:
        head = {"stage": "export", "version": __version__}
        content = head | {"parameters": [asdict(e) for e in found.estimates]}
        text = json_text(content) if kind == "json" else _csv(found)
    with new_file(path, mark=MARKS[kind], inputs=[given], force=force) as temporary:
        temporary.write_text(text, encoding="utf-8")
    summary = heading("export") | {"format_of_model": kind, "errors": errors, "lost": lost}
    return ExportResult(summary, path, lost)


def _csv(model: Model) -> str:
    rows = [asdict(e) for e in model.estimates]
    for row in rows:
        if row["run"] and row["run"][0] in "=+-@":  # which a spreadsheet would compute
            row["run"] = f"'{row['run']}"
    header = dict.fromkeys(("name", "run", "value", "unit", *(rows[0] if rows else ())))
    text = io.StringIO()
    writer = csv.DictWriter(text, list(header), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def _mujoco(
    model: Model, fitted: FittedTo, conditions: dict[str, float | None], name: str
) -> tuple[str, Differences, tuple[str, ...]]:
    """Return the model file, its errors by channel, and what it does not hold."""
    known = {key: _condition(key, value, fitted) for key, value in conditions.items()}
    if known["preload_N"] is None:
        own = [e.value for e in model.estimates if e.name == "preload_N"]
        known["preload_N"] = float(np.mean(own)) if own else None
    nothing: Raw = {"id": "exported", "file": "none", "sha256": "0" * 64}
    run = parse(Run, nothing | known, "")
    rig = model.rig(run)
    stroke = fitted.ranges.get("stroke_mm", (0.0, STROKE_MM))[1]
    lumped = lumped_of(rig, stroke)
    errors = _errors(rig, lumped, stroke)
    lost = (*_ALWAYS_LOST, *_effects_left_out(rig.effects))
    said = [
        f"A tendon-sheath mechanism, by tsas export {__version__}.",
        f"Sheath {rig.sheath_length_mm:g} mm, bend {rig.total_bend_rad:g} rad.",
        f"Strokes of {stroke:g} mm that pull from a preload of {rig.preload_N:g} N.",
        *(
            f"{channel}: differs from the model by {number_text(one['rms'])} {one['unit']} (RMS), "
            f"{number_text(one['largest'])} at most, in a range of {number_text(one['span'])}."
            for channel, one in errors.items()
        ),
        *(f"Not held: {sentence}." for sentence in lost),
    ]
    ratio, radius = (fitted.ranges.get(n) for n in ("gear_ratio", "turntable_radius_mm"))
    # Tension per torque of the motor [1/m], 1 where the gear is not known.
    gear = 1.0 if ratio is None or radius is None else 1e3 * ratio[1] / radius[1]
    return mjcf(name, lumped, said, gear=gear), errors, lost


def _condition(name: str, given: float | None, fitted: FittedTo) -> float | None:
    """Return a condition as given, or as all recordings had it; None where none is known."""
    low, high = fitted.ranges.get(name, (None, None))
    if given is not None or low is None or high is None:
        return given
    if high - low > 1e-3 * abs(high):
        option = f"--{name.replace('_', '-')}"
        raise InputError(
            f"the model holds for a {name} of {low:.6g} to {high:.6g}",
            where=option,
            expected="the one that is exported",
            remedy=f"{option} {high:.6g}",
        )
    return 0.5 * (low + high)


def _errors(rig: Rig, lumped: Lumped, stroke_mm: float) -> Differences:
    """Return how far the lumped tendon is from the rig after the first stroke, by channel.

    `rms` and `largest` are of the difference, `span` is the channel's range in the rig.
    """
    phase = np.pi * np.arange(STROKES * SAMPLES + 1) / SAMPLES
    x_in = 0.5 * stroke_mm * (1.0 - np.cos(phase))
    drive = DriveInput(x_in)
    plain = mechanics_of(rig._replace(x_in_zero_mm=0.0), drive)
    held = Effects(**{name: getattr(plain.effects, name) for name in HELD})
    true = simulate(plain._replace(effects=held), drive)
    f_in, x_out = follow(lumped, x_in)
    out = {}
    for name, unit, ours, other in (
        ("f_in_N", "N", true.f_in_N, f_in),
        ("x_out_mm", "mm", true.x_out_mm, x_out),
    ):
        difference = (other - ours)[SAMPLES:]
        out[name] = {
            "rms": float(np.sqrt(np.mean(difference**2))),
            "largest": float(np.abs(difference).max()),
            "span": float(np.ptp(ours)),
            "unit": unit,
        }
    return out


def _effects_left_out(effects: Effects) -> Sequence[str]:
    """Return a sentence for each effect of the model that a lumped tendon does not have."""
    neutral = Effects()
    return [
        f"{e.title.lower()} ({e.name})"
        for e in (*EFFECTS, *LAWS)
        if e.name not in HELD
        and e.acts_on != "sensor"
        and getattr(effects, e.name) != getattr(neutral, e.name)
    ]
