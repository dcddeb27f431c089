"""The picture of a law of unnamed origin."""

import pytest
from matplotlib.figure import Figure

from tsas_cli.records.diagnosis import DescribedLaw
from tsas_cli.reporting.diagnosis.causes import _draw_law


def drawn(after_reversal, along_stroke, margin):
    law = DescribedLaw(
        law="load_law",
        title="Lost motion",
        equation="",
        sentence="",
        parameters={},
        channel="x_out_mm",
        unit="mm",
        rmse_before=1.0,
        rmse_after=0.5,
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
