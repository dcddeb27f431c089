"""What the viewer opens with."""

from tests.reporting import made_folders as by_hand
from tests.reporting import made_loops
from tests.reporting.stream.streams import make_diagnosed, read, shown, views
from tsas_cli.reporting.inputs import read_inputs
from tsas_cli.reporting.stream import stream_of, write_stream


def root_of(inputs):
    return stream_of(inputs).layout.root_container


def test_only_tabs_are_there_that_have_something_to_show(dataset, tmp_path):
    made = {
        dataset: ["Overview"],
        by_hand.make_check(dataset, tmp_path / "check"): ["Overview"],
        by_hand.make_calibration(dataset, tmp_path / "calibrate"): ["Overview"],
        by_hand.make_simulation(dataset, tmp_path / "simulate"): ["Overview", "Residuals"],
        make_diagnosed(dataset, tmp_path / "diagnose"): ["Overview", "Residuals"],
        made_loops.make_tracking(tmp_path / "track"): ["Overview", "Tracking"],
    }
    for folder, names in made.items():
        root = root_of(read_inputs([folder]))
        assert [part.name for part in root.contents] == names
        opens = root.contents[root.active_tab].name
        assert opens == ("Tracking" if "Tracking" in names else "Overview")


def test_every_view_shows_something_that_was_recorded(dataset, tmp_path):
    folders = [
        by_hand.make_calibration(dataset, tmp_path / "calibrate"),
        by_hand.make_simulation(dataset, tmp_path / "simulate"),
        make_diagnosed(dataset, tmp_path / "diagnose"),
    ]
    for number, given in enumerate([folders, [made_loops.make_tracking(tmp_path / "track")]]):
        inputs, path = read_inputs(given), tmp_path / f"{number}.rrd"
        write_stream(inputs, path)
        recorded = set(read(path))
        made = views(root_of(inputs))
        assert {view.class_identifier for view in made} >= {"TimeSeries", "2D", "TextDocument"}
        for view in made:
            for entity in shown(view):
                assert any(one == entity or one.startswith(f"{entity}/") for one in recorded)


def test_phases_and_faults_stand_with_the_run_that_they_are_of(dataset, tmp_path):
    fault = {"code": "stuck", "severity": "error", "run": "b", "sentence": "f_in_N is stuck"}
    folders = [
        by_hand.make_calibration(dataset, tmp_path / "calibrate"),
        by_hand.make_check(dataset, tmp_path / "check", [fault]),
    ]
    overview = root_of(read_inputs(folders)).contents[0]
    runs = overview.contents[0].contents[1].contents
    assert [run.name for run in runs] == ["run a", "run b", "all runs"]
    kinds = {"a": ["StateTimeline"], "b": ["StateTimeline", "TextLog"]}
    for run, (name, wanted) in zip(runs, kinds.items(), strict=False):
        found = [view for view in views(run) if view.class_identifier in kinds["b"]]
        assert [view.class_identifier for view in found] == wanted
        assert all(path.split("/")[2] == name for view in found for path in shown(view))
