"""Draw docs/before-after.svg: `.venv/bin/python -m docs.before_after`.

The shipped recordings are diagnosed by the command line, and what their page shows first is drawn.
"""

import contextlib
import tempfile
from pathlib import Path
from typing import Any

from docs.examples import ROOT, output_of
from docs.manual.colours import palettes
from tsas_cli.reporting.before_after import best_fits, draw_loop, draw_residuals, near
from tsas_cli.reporting.drawing import legend, picture
from tsas_cli.reporting.inputs import read_inputs

OUT = Path(__file__).parent / "before-after.svg"


def main() -> None:
    """Diagnose in an empty folder and draw what is written there."""
    with tempfile.TemporaryDirectory() as name, contextlib.chdir(name):
        output_of(f"tsas diagnose {ROOT / 'datasets' / 'paper-groups'} --out diagnose --quiet")
        inputs = read_inputs([Path("diagnose")])
        fits, held_out = best_fits(inputs) or (), inputs.held_out["f_in_N"]
    fit = fits[0]
    window = near(fit)

    def draw(figure: Any) -> None:
        panels = figure.subplot_mosaic([["loop", "near"], ["error", "error"]], height_ratios=(3, 2))
        draw_loop(panels["loop"], fit, mark=window)
        draw_loop(panels["near"], fit, window=window)
        draw_residuals(panels["error"], fit)
        legend(figure, panels["loop"], ncols=3)

    alt = (
        "Tension at the drive over its displacement, measured, by the nominal and by the extended "
        "model, and near the upper reversal; below, the residuals over time. On held-out runs the "
        f"residual falls from {held_out.rmse_before:.2g} to {held_out.rmse_after:.2g} N."
    )
    drawn = picture(draw, key="a", alt=alt, caption="", height_in=4.2)
    OUT.write_text(standing_alone(str(drawn.svg)), encoding="utf-8")


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
