import re
import shlex
from html import unescape
from itertools import product

import numpy as np
import pyarrow.parquet as pq
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from tests.refusals import refusal
from tests.reporting.made_folders import edited, page_from
from tests.reporting.made_loops import make_tracking
from tests.reporting.test_page import Outline, cells, commands_of, headings
from tsas_cli.controllers import CONTROLLERS
from tsas_cli.reporting.colours import STAND_IN, of_controller
from tsas_cli.reporting.inputs import read_inputs
from tsas_cli.reporting.tracking.runs import TimeCurve, draw_panels

PICTURES = ("force", "error", "phase", "adaptation", "effort")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return make_tracking(tmp_path_factory.mktemp("tracking") / "tracked")


@pytest.fixture(scope="module")
def whole(folder):
    return page_from(folder)


@pytest.fixture
def spoiled(tmp_path):
    """Return a folder in which the JSON has been changed."""

    def spoil(change):
        folder = make_tracking(tmp_path / "tracked")
        with edited(folder / "tracking.json") as content:
            change(content)
        return folder

    return spoil


def labels(text):
    """Return what the pictures of the section say."""
    section = text[text.index('<section id="tracking"') : text.index('<section id="recordings"')]
    return [unescape(label) for label in re.findall('<svg[^>]*aria-label="([^"]*)"', section)]


def test_the_page_is_well_formed_leads_with_tracking_and_leaves_out_what_was_not_given(whole):
    Outline(whole)
    assert len(labels(whole)) == 2 * len(PICTURES)
    assert "was given" not in whole
    assert headings(whole, 2)[0] == "Tracking"


def test_scores_stand_with_their_spread_and_the_limit_where_it_was_reached(whole):
    header, first, *_, last = cells(whole, "Scores, mean ± standard deviation over 5 seeds")
    assert first[:3] == ["pid", "undisturbed", "0.200 ± 0.003"]
    assert first[3:] == ["353.6 ± 0.1", "1234", "0", "–"]
    assert (header[-1], last[-1]) == ("at its limit [%]", "12.5 ± 0.5")


def test_the_error_is_wanted_less_true_force(whole):
    shown = [label for label in labels(whole) if label.startswith("Tracking error")]
    assert "undisturbed, in newton: pid, 1.00 to 1.00;" in shown[0]
    assert "disturbed, in newton: pid, 2.00 to 2.00;" in shown[1]


def test_the_phase_portrait_has_the_error_and_its_rate(whole):
    """An error of 0.25 (1 - cos t) mm goes to 0.5 mm, its rate to 0.25 mm/s."""
    (shown, _) = (label for label in labels(whole) if label.startswith("Phase portraits"))
    error, rate = re.search(r"pid error up to (\S+) mm, rate up to (\S+) mm/s", shown).groups()
    assert float(error) == pytest.approx(0.5, rel=0.01)
    assert float(rate) == pytest.approx(0.25, rel=0.01)


def test_adapted_parameters_stand_between_their_bounds(whole):
    _, *rows = cells(whole, "Adapted parameters")
    assert rows[0] == [
        *("φ̂1", "undisturbed", "0.00500", "0.100", "0.001", "0.1", "rpm s³/mm", "50")
    ]
    assert rows[1][2:] == ["18.0", "30.6", "2", "200", "rpm s/mm", "0"]
    assert rows[5][:2] == ["φ̂3", "disturbed"]


@pytest.mark.usefixtures("undrawn")
def test_a_controller_that_does_not_adapt_has_no_such_part(tmp_path):
    text = page_from(make_tracking(tmp_path / "tracked", ("pid", "sliding-mode")))
    Outline(text)
    assert "Adapted parameters" not in text
    assert len(labels(text)) == 2 * (len(PICTURES) - 1)


@pytest.mark.usefixtures("undrawn")
def test_one_controller_under_one_condition_is_a_page_too(spoiled):
    def one(content):
        content.update(results=content["results"][:1], seeds=[1, 1], notes=[])
        content["conditions"] = {"undisturbed": []}

    text = page_from(spoiled(one))  # never at its limit
    Outline(text)
    assert "at its limit" not in cells(text, "Scores")[0]
    assert "Followed by pid" in text
    assert "Keep in mind" not in text
    assert "over 5 seeds" not in text


def test_each_controller_is_drawn_in_its_own_colour(whole):
    pictures = re.findall(r"<svg.*?</svg>", whole, re.DOTALL)
    for what, condition in product(("force", "error", "phase", "effort"), "01"):
        (shown,) = (s for s in pictures if f'"tracking-{what}-{condition}-' in s)
        assert "stroke: var(--first)" in shown
        assert "stroke: var(--third)" in shown


def test_every_controller_has_a_colour_and_one_that_is_not_known_has_one_too():
    assert len({of_controller(name) for name in CONTROLLERS}) == len(CONTROLLERS)
    assert of_controller("made by another version") == STAND_IN["unknown"]


def test_notes_and_changes_of_the_plant_are_said(whole):
    assert "<li>pid-disturbed: the motor is at its &lt;limit&gt;</li>" in whole
    assert "<code>friction_coefficient</code> = 0.16 from 6 s on (dotted line)" in whole
    assert "It knows the data sheet, and of the drive drive.toml; the plant is rig.toml" in whole


def test_a_change_within_the_run_is_a_line_at_its_time_in_every_panel():
    time_s = np.linspace(0.0, 10.0, 50)
    curves = [TimeCurve(name, name, np.sin(time_s)) for name in ("pid", "sliding-mode")]
    for change_s, lines in ((6.0, 1), (None, 0)):
        figure = Figure()
        draw_panels(figure, time_s=time_s, curves=curves, label="", change_s=change_s, band=0.5)
        for axes, curve in zip(figure.axes, curves, strict=True):
            upright = [line for line in axes.lines if list(line.get_xdata()) == [6.0, 6.0]]
            assert len(upright) == lines
            colours = [to_hex(line.get_color()) for line in axes.lines]
            assert of_controller(curve.controller) in colours
            levels = {line.get_ydata()[0] for line in axes.lines if len(line.get_xdata()) == 2}
            assert {-0.5, 0.0, 0.5} <= levels


def test_the_command_says_all_that_was_asked_for(whole):
    (command,) = re.findall("^tsas track .*", commands_of(whole), re.MULTILINE)
    words = shlex.split(command)
    assert words[2:-2] == [
        *("--plant", "rig.toml", "--drive", "drive.toml", "--dynamics", "lugre"),
        *("--compare", "--disturb", "friction_coefficient=0.16@6.0"),
        *("--reference", "sine", "--seeds", "5", "--seed", "3"),
    ]
    assert ["rig.toml", "ab" * 32] in cells(whole, "Files read")
    assert ["drive.toml", "cd" * 32] in cells(whole, "Files read")


@pytest.mark.parametrize("column", ["f_out_true_N", "phi2_rpm_s_per_mm"])
def test_a_run_that_lacks_a_column_is_refused(tmp_path, column):
    folder = make_tracking(tmp_path / "tracked")
    path = folder / "runs" / "adaptive-sliding-mode-disturbed.parquet"
    pq.write_table(pq.read_table(path).drop_columns([column]), path)
    assert path.name in refusal(lambda: page_from(folder))


def test_runs_that_are_not_beside_the_file_are_refused(tmp_path):
    folder = make_tracking(tmp_path / "tracked")
    (tmp_path / "elsewhere").mkdir()
    (folder / "dataset.toml").rename(tmp_path / "elsewhere" / "dataset.toml")
    assert "no dataset.toml here" in refusal(read_inputs, [folder])
    line = refusal(read_inputs, [folder, tmp_path / "elsewhere"])
    assert "its runs are not in the dataset" in line


@pytest.mark.usefixtures("undrawn")
def test_the_commands_of_the_page_make_the_same_page(tmp_path, monkeypatch, here):
    """What `tsas track` writes, the page reads; and its commands do it again."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "short.toml").write_text(
        "format = 1\n[reference]\nduration_s = 0.5\n[loop]\nnodes = 5\n[sensor]\nrate_Hz = 500\n"
    )
    call = "track --controller pid,adaptive-sliding-mode --disturb friction_coefficient=0.16@0.25 "
    call += "--reference ramps --settings short.toml --seeds 2 --seed 4 --out tracked"
    assert here(*call.split())[0] == 0
    assert here("report", "tracked", "--out", "first.html")[0] == 0
    first = (tmp_path / "first.html").read_text()
    for command in commands_of(first).splitlines():
        assert here(*shlex.split(command)[1:], "--force")[0] == 0
    assert (tmp_path / "report.html").read_text() == first
