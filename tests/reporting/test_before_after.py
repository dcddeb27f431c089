"""The first picture: the run and the channel with the largest gain, and where it is."""

import re

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from matplotlib.figure import Figure

from tests.reporting.made_diagnoses import make_diagnosis, off_at_the_end, write_predictions
from tsas_cli.reporting import before_after
from tsas_cli.reporting.before_after import ShownFit, draw_before_after, pictures
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.glance import glance
from tsas_cli.reporting.inputs import read_inputs


def answered(dataset, folder, wrong, verdict="named"):
    return write_predictions(dataset, make_diagnosis(dataset, folder, verdict), wrong)


def test_the_run_and_the_place_with_the_largest_gain_are_shown(dataset, tmp_path):
    whole, near = pictures(read_inputs([answered(dataset, tmp_path / "d", off_at_the_end)]))
    assert whole.caption.startswith("Run b, f_in over x_in. Below: residual of f_in over time.")
    assert near.caption.startswith("Run b, f_in over x_in, enlarged where the models differ most.")
    (said,) = re.findall(r"nominal model ([\d.]+), extended model ([\d.]+), noise", whole.caption)
    assert float(said[1]) == pytest.approx(0.1, rel=0.1)
    assert float(said[0]) > 5.0 * float(said[1])
    low, high = map(float, re.search('data-x="(.*?) (.*?)"', near.svg).groups())
    assert 15.0 < low < 19.0
    assert 20.0 < high < 21.0
    for colour in ("measured", "before", "after"):
        assert whole.svg.count(f"stroke: var(--{colour})") >= 2  # in the plot and in the legend


def test_another_channel_with_a_gain_is_shown_whole_where_it_can_be_seen(dataset, tmp_path):
    def both(run, name, x_in):
        return off_at_the_end(run, "f_in", x_in) * (2.0 if name == "f_in" else 1.0)

    whole, other = pictures(read_inputs([answered(dataset, tmp_path / "d", both)]))
    assert "f_in over x_in." in whole.caption
    assert other.caption.startswith("Run b, f_out over x_in. Below: residual of f_out")


def test_where_nothing_is_named_the_nominal_model_stands_alone(dataset, tmp_path):
    folder = answered(dataset, tmp_path / "d", off_at_the_end, "unexplained")
    whole, near = pictures(read_inputs([folder]))
    assert "extended" not in whole.caption + near.caption
    assert "enlarged where the residual is most" in near.caption
    assert "var(--after)" not in whole.svg + near.svg


def test_an_extended_model_that_is_worse_makes_a_picture_all_the_same(dataset, tmp_path):
    folder = answered(dataset, tmp_path / "d", lambda _, __, x_in: 0.0 * x_in)
    for path in (folder / "runs").iterdir():
        table = pq.read_table(path)
        worse = pa.array(table.column("f_in_N").to_numpy() + 1.0)
        pq.write_table(table.set_column(2, "f_in_N", worse), path)
    assert len(pictures(read_inputs([folder]))) == 2


def test_without_what_the_diagnosis_has_written_of_the_runs_there_is_no_picture(dataset, tmp_path):
    folder = make_diagnosis(dataset, tmp_path / "d", "named")
    assert pictures(read_inputs([folder])) == ()
    assert glance(read_inputs([folder])).pictures == ()


def fit_of(x, measured, nominal, extended):
    time_s = np.arange(x.size) / 100.0
    models = (("nominal model", "before", nominal), ("extended model", "after", extended))
    return ShownFit("a", "f_in_N", 0.1, time_s, x, x, measured, models)


def test_of_many_cycles_those_with_the_largest_gain_are_taken():
    time_s = np.arange(8000) / 100.0
    x = np.sin(2.0 * np.pi * time_s / 8.0)  # ten cycles
    off = np.where((time_s > 50.0) & (time_s < 54.0), 1.0, 0.0)
    start, end = before_after._cycles(fit_of(x, x, x + off, x))
    assert start < 50.0
    assert end > 54.0
    assert end - start == pytest.approx(24.0, abs=0.1)
    whole = before_after._cycles(fit_of(x[:2000], x[:2000], x[:2000], x[:2000]))
    assert whole == (-np.inf, np.inf)


def test_the_same_place_in_two_curves_is_the_same_sample():
    x = np.sin(np.linspace(0.0, 12.0, 20_000))
    fit = fit_of(x, 2.0 * x, 2.0 * x + 0.5, 2.0 * x + 0.1)
    figure = Figure()
    draw_before_after(figure, loop=fit, below=fit, mark=None, window=None)
    upper, lower = figure.axes
    loops = {one.get_color(): one for one in upper.lines}
    errors = {one.get_color(): one for one in lower.lines}
    for role, error in (("before", -0.5), ("after", -0.1)):
        loop, residual = loops[STAND_IN[role]], errors[STAND_IN[role]]
        assert len(loop.get_xdata()) == len(residual.get_xdata()) < 4000
        assert np.allclose(residual.get_ydata(), error)
        at = np.searchsorted(fit.time_s, residual.get_xdata())
        assert np.array_equal(loop.get_xdata(), x[at])


def test_an_enlarged_part_has_no_line_from_one_pass_to_the_next():
    x = np.tile(np.concatenate([np.linspace(0, 1, 500), np.linspace(1, 0, 500)]), 3)
    fit = fit_of(x, x, x + 0.2, x)
    figure = Figure()
    draw_before_after(figure, loop=fit, below=None, mark=None, window=(0.9, 1.0, 0.9, 1.0))
    drawn = figure.axes[0].lines[0].get_ydata()
    assert np.isnan(drawn).sum() == 2
    assert len(drawn) < x.size / 3
    assert figure.axes[0].get_xlim() == (0.9, 1.0)
