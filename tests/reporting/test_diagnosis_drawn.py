"""Bars and maps of a diagnosis, as they are drawn."""

import pytest
from matplotlib.figure import Figure

from tsas_cli.records.diagnosis import Bin, HeldOut
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.diagnosis.maps import Panel, draw_residual_map
from tsas_cli.reporting.diagnosis.section import draw_gains


def test_the_bar_after_is_as_long_as_the_error_after():
    channel = HeldOut(
        unit="N", rmse_before=0.91, rmse_after=0.11, noise_floor=0.1, attainable=0.105
    )
    figure = Figure()
    draw_gains(figure, {"f_in_N": channel}, named=True)
    (axes,) = figure.axes
    assert {bar.get_label(): bar.patches[0].get_width() for bar in axes.containers} == {
        "nominal model": 0.91,
        "extended model": 0.11,
    }
    marks = {line.get_label(): line.get_xdata()[0] for line in axes.lines}
    assert marks == {"attainable": 0.105, "noise level": 0.1}


def test_the_map_draws_before_and_after_in_their_colours_at_their_means():
    bins = [
        tuple(
            Bin.model_validate({"from": a, "to": a + 1, "mean": sign * a, "sd": 2, "samples": 9})
            for a in (1.0, 3.0)
        )
        for sign in (1, -1)
    ]
    figure = Figure()
    draw_residual_map(figure, [Panel("f_in_N", "x_in_mm", *bins)], label="x")
    drawn = {bar.get_label(): bar.lines[0] for bar in figure.axes[0].containers}
    assert drawn["nominal model"].get_color() == STAND_IN["before"]
    assert list(drawn["nominal model"].get_ydata()) == [1.0, 3.0]
    assert list(drawn["extended model"].get_ydata()) == [-1.0, -3.0]
    assert drawn["extended model"].get_xdata() == pytest.approx([1.5, 3.5], abs=0.3)
