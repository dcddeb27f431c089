"""Draw docs/before-after.svg: `.venv/bin/python -m docs.before_after`.

The shipped recordings are calibrated, diagnosed and simulated with both models by the command line,
and what it writes is drawn.
"""

import contextlib
import json
import tempfile
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq

from docs.examples import ROOT, output_of
from docs.manual.colours import palettes
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.decimation import kept_cells, kept_samples
from tsas_cli.reporting.drawing import picture

Columns = dict[str, Any]  # of one run, shape (n,) each

OUT = Path(__file__).parent / "before-after.svg"
RUN = "a"
NEAR = (19.55, 20.05, 34.0, 86.0)  # mm and N about the upper reversal
MODELS = {
    "nominal": ("before", "nominal model", "result/calibrate/model.toml"),
    "extended": ("after", "with the named cause", "result/diagnose/model-extended.toml"),
}


def column(path: Path, name: str) -> Any:
    """Return one column of a Parquet file, shape (n,)."""
    return pq.read_table(path, columns=[name]).column(0).to_numpy()


def main() -> None:
    """Run the pipeline in an empty folder and draw what it has written."""
    with tempfile.TemporaryDirectory() as name, contextlib.chdir(name):
        data = ROOT / "datasets" / "paper-groups"
        output_of(f"tsas calibrate {data} --out result/calibrate --quiet")
        output_of(f"tsas diagnose {data} --out result/diagnose --quiet")
        for out, (_, _, model) in MODELS.items():
            output_of(f"tsas simulate {data} --model {model} --out {out} --quiet")
        channel = json.loads(Path("result/diagnose/diagnosis.json").read_text())["channels"][
            "f_in_N"
        ]
        measured = {
            key: column(data / "runs" / f"{RUN}.parquet", key)
            for key in ("time_s", "x_in_mm", "f_in_N")
        }
        simulated = {
            out: {
                key: column(Path(out, "runs", f"{RUN}.parquet"), key)
                for key in ("x_in_mm", "f_in_N")
            }
            for out in MODELS
        }

    def draw(figure: Any) -> None:
        panels = figure.subplot_mosaic([["loop", "near"], ["error", "error"]], height_ratios=(3, 2))
        for panel in ("loop", "near"):
            draw_loop(panels[panel], measured, simulated)
        low, high, bottom, top = NEAR
        panels["near"].set(xlim=(low, high), ylim=(bottom, top), xticks=(19.6, 19.8, 20.0))
        corners = ([low, high, high, low, low], [bottom, bottom, top, top, bottom])
        panels["loop"].plot(*corners, color=STAND_IN["ink"], linewidth=0.8)
        draw_errors(panels["error"], measured, simulated)
        handles, labels = panels["loop"].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper left", ncols=3, handlelength=1.6)

    before, after = (f"{channel[f'rmse_{when}']:.2g}" for when in ("before", "after"))
    alt = (
        "Tension at the drive over its displacement, measured and simulated, and near the upper "
        "reversal; below, what each model misses over time. On held-out runs the error falls from "
        f"{before} to {after} N."
    )
    drawn = picture(draw, key="a", alt=alt, caption="", height_in=4.2)
    OUT.write_text(standing_alone(str(drawn.svg)), encoding="utf-8")


def draw_loop(axes: Any, measured: Columns, simulated: dict[str, Columns]) -> None:
    """Draw the measured loop and both simulated ones, of the last period."""
    last = measured["time_s"] > 0.5 * measured["time_s"][-1]
    curves = [("measured", "measured", measured, 3.2)]
    curves += [(MODELS[out][0], MODELS[out][1], run, 1.3) for out, run in simulated.items()]
    for colour, label, run, width in curves:
        x, y = run["x_in_mm"][last], run["f_in_N"][last]
        kept = kept_cells(x, y)
        axes.plot(x[kept], y[kept], color=STAND_IN[colour], label=label, linewidth=width)
    axes.set(xlabel="x_in [mm]", ylabel="f_in [N]")


def draw_errors(axes: Any, measured: Columns, simulated: dict[str, Columns]) -> None:
    """Draw what is measured less what each model says, over time."""
    for out, run in simulated.items():
        error = measured["f_in_N"] - run["f_in_N"]
        kept = kept_samples(error, points=900)
        colour = STAND_IN[MODELS[out][0]]
        axes.plot(measured["time_s"][kept], error[kept], color=colour, linewidth=0.9)
    axes.set(xlabel="time [s]", ylabel="f_in missed by [N]")


def standing_alone(svg: str) -> str:
    """Return an SVG file with its own ground and colours, light or dark as the reader's screen."""
    light, dark = palettes()
    style = (
        f"<style>:root {{ {light} }} @media (prefers-color-scheme: dark) {{ :root {{ {dark} }} }} "
        "* { stroke-linejoin: round } text { font-family: system-ui, sans-serif !important }"
        "</style>"
        '<rect width="100%" height="100%" rx="6" style="fill: var(--paper)"/>'
    )
    head, end, body = svg.partition(">")
    return f'{head} xmlns="http://www.w3.org/2000/svg"{end}{style}{body}\n'


if __name__ == "__main__":
    main()
