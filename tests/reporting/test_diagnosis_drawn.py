"""Bars, maps and laws of a diagnosis, as they are drawn."""

import pytest
from matplotlib.figure import Figure

from tsas_cli.records.diagnosis import Bin, DescribedLaw, HeldOut
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.diagnosis.causes import _draw_law
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


def drawn(after_reversal, along_stroke, margin):
    law = DescribedLaw.model_construct(
        channel="x_out_mm",
        unit="mm",
        what="x_out [mm]",
        travel_mm=(0.0, 5.0),
        after_reversal=after_reversal,
        after_reversal_margin=(0.0, 1e-9),
        place_mm=(0.0, 5.0, 10.0),
        along_stroke=along_stroke,
        along_stroke_margin=margin,
    )
    figure = Figure()
    _draw_law(figure, law)
    return [axes for axes in figure.axes if axes.get_visible()]


def test_what_does_nothing_is_not_drawn():
    both = drawn((0.0, 0.1), (0.0, 0.02, -0.02), (0.0, 0.01, 0.01))
    assert [axes.get_xlabel() for axes in both] == [
        "travel since reversal [mm]",
        "displacement [mm]",
    ]
    (one,) = drawn((0.0, 1e-12), (0.0, 0.02, -0.02), (0.0, 0.01, 0.01))
    assert one.get_xlabel() == "displacement [mm]"
    assert drawn((), (), ()) == []


@pytest.mark.parametrize(("margin", "ends"), [(0.01, (-0.03, 0.03)), (5.0, (-0.08, 0.08))])
def test_a_wide_band_is_cut_so_that_the_curve_is_seen(margin, ends):
    (one,) = drawn((0.0, 0.0), (0.0, 0.02, -0.02), (margin,) * 3)
    assert one.get_ylim() == pytest.approx(ends)
