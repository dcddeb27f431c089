"""What goes to the viewer while runs are computed; a file stands for the viewer here."""

import numpy as np
import pyarrow.parquet as pq
import pytest

from tests.reporting.made_folders import make_dataset, make_simulation
from tests.reporting.made_loops import make_tracking
from tests.reporting.stream.streams import read
from tsas_cli.identification.model import data_sheet
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.recording import Recording
from tsas_cli.records.simulation import SimulationFile
from tsas_cli.records.tracking import TrackingFile
from tsas_cli.reporting.stream.live import LiveStream
from tsas_cli.reporting.stream.recorder import Recorder, outline, to_file


@pytest.fixture
def seen(tmp_path):
    """Give a live stream to a function; return the samples of each run after each of its steps."""

    def record(steps):
        counts = []
        for n in range(1, len(steps) + 1):
            path, folder = tmp_path / f"{n}.rrd", tmp_path / f"live{n}"
            folder.mkdir()
            with to_file(path, "live") as recorder:
                live = LiveStream(recorder, folder)
                for step in steps[:n]:
                    step(live)
            counts.append(rows_by_run(path))
        return counts

    return record


def rows_by_run(path):
    """Return by entity below a run how many rows it has over time."""
    found = {name: sum(entity.chunks) for name, entity in read(path).items()}
    return {name: rows for name, rows in found.items() if name.startswith("/run/") and rows}


@pytest.fixture
def simulated(tmp_path):
    """Return what tells a stream of a run of two, with what the simulation says so far."""
    dataset = read_dataset(make_dataset(tmp_path / "dataset", ("a", "b"), samples=300))
    folder = make_simulation(tmp_path / "dataset", tmp_path / "simulated")
    stage = SimulationFile.model_validate_json((folder / "simulation.json").read_text())
    ones = np.ones(300)
    columns = {"time_s": np.arange(300.0), "f_in_N": ones, "x_in_mm": ones}

    def step(run, so_far):
        said = stage.model_copy(update={"runs": {name: stage.runs[name] for name in so_far}})
        answer = Recording(dataset.only([run]).runs[0], columns)
        return lambda live: live.simulated(dataset, said, answer, data_sheet(dataset.manifest))

    return step


def test_each_simulated_run_is_there_before_the_next_is_computed(seen, simulated):
    first, both = seen([simulated("a", "a"), simulated("b", "b")])
    assert first["/run/a/f_in_N/simulated"] == 300
    assert first["/run/a/f_in_N/measured"] == 300
    assert not any(path.startswith("/run/b") for path in first)
    assert both["/run/b/f_in_N/simulated"] == 300
    assert both.items() >= first.items()


def test_tracked_runs_too(seen, tmp_path):
    folder = make_tracking(tmp_path / "tracked")
    stage = TrackingFile.model_validate_json((folder / "tracking.json").read_text())
    runs = [result.run for result in stage.results][:2]

    def step(run):
        table = pq.read_table(folder / "runs" / f"{run}.parquet")
        return lambda live: live.tracked(stage, run, table)

    first, both = seen([step(run) for run in runs])
    assert len({path for path in first if "tracking_error" in path}) == 1
    assert len({path for path in both if "tracking_error" in path}) == 2


def test_layouts_follow_the_runs_and_do_not_crowd_them_out(simulated, tmp_path, monkeypatch):
    laid_out = []
    outlined = lambda self, layout: laid_out.append(str(outline(layout.root_container)))  # noqa: E731
    monkeypatch.setattr(Recorder, "lay_out", outlined)
    with to_file(tmp_path / "live.rrd", "live") as recorder:
        live = LiveStream(recorder, tmp_path)
        for run in "ab":
            simulated(run, "ab")(live)
        assert len(laid_out) == 1
        live.lay_out()
        live.lay_out()
    first, last = laid_out
    assert "run b" not in first
    assert "run b" in last
