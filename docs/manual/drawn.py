"""Draw the signature of an effect: the loops without and with it, and the difference."""

from typing import Any

import numpy as np
import numpy.typing as npt

from docs.manual.signatures import Channel, Motion, Plane, Signature, Variant
from tsas_cli.diagnosis.motions import motion
from tsas_cli.effects import Effect
from tsas_cli.paper import yang2025
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import NODES, Prediction, simulate
from tsas_cli.physics.rig import with_values
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.content import Picture
from tsas_cli.reporting.drawing import kept_cells, picture
from tsas_studies.reproduction.rig import quasi_static_rig

Floats = npt.NDArray[np.float64]
Run = dict[Channel, Floats]

RATE_HZ = 500.0
COLOURS = ("after", "before")
NAMES: dict[Channel, str] = {
    "time_s": "time [s]",
    "x_in_mm": "x_in [mm]",
    "x_out_mm": "x_out [mm]",
    "f_in_N": "f_in [N]",
    "f_out_N": "f_out [N]",
}


def signature_picture(effect: Effect, signature: Signature) -> Picture:
    """Return two loops of group a of Yang 2025 without and with an effect, and what it changes."""
    without = _run(effect, {}, signature.motion)
    variants = [_run(effect, dict(v.values), signature.motion) for v in signature.variants]

    def draw(figure: Any) -> None:
        panels = figure.subplot_mosaic(
            [["one", "two"], ["change", "change"]], height_ratios=(1.5, 1.0)
        )
        for panel, plane in zip(("one", "two"), signature.planes, strict=True):
            _draw_loops(panels[panel], plane, signature, without, variants)
        _draw_change(panels["change"], signature, without, variants)
        handles, labels = panels["one"].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper left", ncols=3, handlelength=1.6)

    return picture(
        draw,
        key=effect.name,
        alt=f"{effect.title}, drawn without and with it. {signature.look}",
        caption=f"{signature.look} Drawn with {_sizes(effect, signature)}.",
        height_in=4.4,
    )


def _run(effect: Effect, values: dict[str, float], way: Motion) -> Run:
    """Simulate the motion with some values of the effect, all on one mesh."""
    time_s, x_in = motion(
        way.kind,
        amplitude_mm=way.amplitude_mm,
        speed_mm_per_s=way.speed_mm_per_s,
        periods=way.periods,
        dwell_s=0.0,
        rate_Hz=RATE_HZ,
    )
    rig = with_values(
        quasi_static_rig(yang2025()),
        {f"{effect.name}.{name}": value for name, value in values.items()},
    )
    answer: Prediction = simulate(rig, DriveInput(x_in, time_s=time_s), nodes=NODES)
    return {
        "time_s": time_s,
        "x_in_mm": answer.x_in_mm,
        "x_out_mm": answer.x_out_mm,
        "f_in_N": answer.f_in_N,
        "f_out_N": answer.f_out_N,
    }


def _draw_loops(
    axes: Any, plane: Plane, signature: Signature, without: Run, variants: list[Run]
) -> None:
    """Draw the loop without the effect, and with each of its variants."""
    _draw_curve(axes, without, plane, color=STAND_IN["measured"], linewidth=2.6, label="without")
    for variant, run, colour in zip(signature.variants, variants, COLOURS, strict=False):
        label = f"with it{', ' * bool(variant.name)}{variant.name}"
        _draw_curve(axes, run, plane, color=STAND_IN[colour], linewidth=1.2, label=label)
    axes.set(xlabel=NAMES[plane[0]], ylabel=NAMES[plane[1]])


def _draw_change(axes: Any, signature: Signature, without: Run, variants: list[Run]) -> None:
    """Draw what each variant changes in its channel."""
    over = signature.over
    axes.axhline(0.0, color=STAND_IN["measured"], linewidth=1.8)
    for variant, run, colour in zip(signature.variants, variants, COLOURS, strict=False):
        change = run | {variant.channel: run[variant.channel] - without[variant.channel]}
        _draw_curve(axes, change, (over, variant.channel), color=STAND_IN[colour])
    axes.set(xlabel=NAMES[over], ylabel=_change_label(signature.variants))


def _change_label(variants: tuple[Variant, ...]) -> str:
    """Return what is drawn as changed, with its unit: `change of f_in, f_out [N]`."""
    channels = list(dict.fromkeys(variant.channel for variant in variants))
    named = [NAMES[channel].split(" ") for channel in channels]
    return f"change of {', '.join(name for name, _ in named)}\n{named[0][1]}"


def _draw_curve(axes: Any, run: Run, plane: Plane, **style: Any) -> None:
    x, y = run[plane[0]], run[plane[1]]
    kept = kept_cells(x, y)
    axes.plot(x[kept], y[kept], **style)


def _sizes(effect: Effect, signature: Signature) -> str:
    """Return the values that are drawn, with their units."""
    units = {p.name: p.unit for p in effect.parameters}
    values = dict(item for variant in signature.variants for item in variant.values.items())
    return ", ".join(
        f"{name} {value:g}{'' if units[name] == '1' else ' ' + units[name]}"
        for name, value in values.items()
    )
