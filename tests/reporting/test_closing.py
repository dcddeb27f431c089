import re
import shlex
from html import unescape

import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from tests.reporting import made_folders as by_hand
from tests.reporting import made_loops
from tests.reporting.test_page import Outline, cells, commands_of, headings
from tsas_cli.records.closing import ClosingFile
from tsas_cli.reporting import colours
from tsas_cli.reporting.closing import MODELS, draw_dots
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.inputs import read_inputs
from tsas_cli.reporting.page import page
from tsas_studies.closing import cases as closing
from tsas_studies.closing.close_loop import chosen


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return made_loops.make_closing(tmp_path_factory.mktemp("closing") / "loop")


@pytest.fixture(scope="module")
def whole(folder):
    return by_hand.page_from(folder)


def points(text):
    return [unescape(re.sub("<.*?>", "", one)) for one in re.findall("<li>(.*?)</li>", text)]


def test_the_page_is_well_formed_says_its_numbers_and_holds_nothing_of_a_dataset(whole):
    (label,) = Outline(whole).labels
    assert "pid: backlash 0.40, 0.30, 0.10, 0.080, bend 0.20, 0.30, 0.25, 0.24," in label
    assert headings(whole, 2) == ["Does a better model track better?", "How to repeat it"]
    assert "was given" not in whole


def test_hidden_values_stand_beside_what_was_named_with_its_rivals(whole):
    backlash, bend, tendon = cells(whole, "What was hidden")[1:]
    hidden = "<code>backlash.play_mm</code> = 0.15"
    assert backlash[2:] == [hidden, "named", "<code>backlash</code>"]
    assert bend[1:] == [
        "a <bend>",
        "<code>total_bend_rad</code> = 4, <code>friction_drift.rate_per_s</code> = 0.01",
        "sufficient",
        "nothing",
    ]
    either = "<code>drive_compliance</code> or <code>free_tendon</code>"
    assert tendon[-1] == f"{either}, <code>presliding</code>"


def test_errors_stand_by_model_with_spread_and_ratio(whole):
    header, first, *_, last = cells(whole, "RMSE of the force [N] by model, mean ± standard")
    assert header[2:] == ["data sheet", "calibrated", "extended", "true", "extended / true"]
    assert first == [
        *("backlash", "pid", "0.400 ± 0.002", "0.300 ± 0.002", "0.100 ± 0.002", "0.080 ± 0.002"),
        "1.25",
    ]
    assert last[:2] == ["free_tendon", "disturbance-observer"]


def test_it_says_for_whom_the_better_model_matters_and_where_it_falls_short(whole):
    """Data sheet / extended is 4, 0.8 and 1.05 of one controller, 3, 30 and 9 of the other."""
    pid, observer = (p for p in points(whole) if "the better model" in p)
    assert pid == (
        "pid: the better model hardly matters. RMSE data sheet / extended is 1.0 (median of 3 "
        "cases, 0.80 to 4.0); the data sheet's is better by more than 10 % in bend (0.80). "
        "The extended model is more than 10 % above the limit in backlash (1.25 times)."
    )
    assert observer == (
        "disturbance-observer: the better model matters. RMSE data sheet / extended is 9.0 (median "
        "of 3 cases, 3.0 to 30). The extended model is in every case within 10 % of the limit, "
        "or better."
    )


def test_a_model_that_makes_it_worse_is_said_to_do_harm(tmp_path):
    bend = {"bend": made_loops.CASES["bend"]}
    text = by_hand.page_from(made_loops.make_closing(tmp_path / "loop", bend))
    (pid, _) = (p for p in points(text) if "the better model" in p)
    assert pid.startswith("pid: the better model does harm. RMSE data sheet / extended is 0.80. ")
    assert "median" not in text


def test_each_model_has_a_mark_at_its_error_in_its_own_colour_and_form(folder):
    controllers = read_inputs([folder]).get(ClosingFile).of_controllers()
    figure = Figure()
    draw_dots(figure, controllers=controllers)
    assert [axes.get_title(loc="left") for axes in figure.axes] == list(controllers)
    for axes, name in zip(figure.axes, controllers, strict=True):
        assert axes.get_xscale() == "log"
        assert [label.get_text() for label in axes.get_yticklabels()] == list(made_loops.CASES)
        marks = {line.get_label(): line for line in axes.lines if line.get_marker() != "None"}
        assert len({line.get_marker() for line in marks.values()}) == len(MODELS)
        for place, (role, (label, _, _)) in enumerate(MODELS.items()):
            line = marks[label]
            assert to_hex(line.get_color()) == STAND_IN[role]
            expected = [case[3][name][place] for case in made_loops.CASES.values()]
            assert list(line.get_xdata()) == expected
            assert list(line.get_ydata()) == [0, 1, 2]


def test_the_models_are_those_that_the_stage_tracks_with(whole):
    assert tuple(name for name, _, _ in MODELS.values()) == closing.MODELS
    assert tuple(MODELS) == colours.MODELS
    for role in MODELS:
        assert f"stroke: var(--{role})" in whole


@pytest.mark.parametrize(
    ("hide", "option"),
    [(False, ["--cases", "backlash,free_tendon"]), (True, ["--hide", "backlash.play_mm=0.15"])],
)
def test_the_command_asks_for_the_same_cases(tmp_path, hide, option):
    names = ["backlash"] if hide else ["backlash", "free_tendon"]
    made = {("hidden" if hide else name): made_loops.CASES[name] for name in names}
    inputs = read_inputs([made_loops.make_closing(tmp_path / "loop", made)])
    again = chosen(None, [option[1]]) if hide else chosen(option[1].split(","), [])
    assert [case.name for case in again] == list(made)
    if hide:
        assert again[0].hidden == made_loops.CASES["backlash"][1]
    where = str(tmp_path / "loop")
    assert [shlex.split(command) for command in commands_of(page(inputs)).splitlines()] == [
        ["tsas", "close-loop", *option, "--seeds", "5", "--seed", "3", "--out", where],
        ["tsas", "report", where, "--out", "report.html"],
    ]


def test_settings_that_are_not_the_defaults_are_said(tmp_path, whole):
    assert "--settings" not in whole
    changed = made_loops.make_closing(tmp_path / "loop")
    with by_hand.edited(changed / "closing.json") as content:
        content["settings"]["sensor"]["noise_mm"] = 0.5
    text = by_hand.page_from(changed)
    assert "--settings settings.toml" in text
    assert "they are not the defaults" in text


@pytest.mark.usefixtures("undrawn")
def test_beside_recordings_and_tracked_runs_the_page_shows_all(folder, tmp_path):
    first = "Does a better model track better?"
    dataset = by_hand.make_dataset(tmp_path / "dataset", ("a",), samples=400)
    calibrated = by_hand.make_calibration(dataset, tmp_path / "cal")
    text = by_hand.page_from(folder, calibrated)
    Outline(text)
    assert headings(text, 2)[:2] == [first, "Recordings"]
    assert "No diagnosis was given" not in text
    assert f"tsas report {dataset} {folder} {calibrated} --out" in text
    tracked = made_loops.make_tracking(tmp_path / "tracked", ("pid",))
    titles = headings(by_hand.page_from(tracked, folder), 2)
    assert titles[:3] == [first, "Tracking", "Recordings"]
