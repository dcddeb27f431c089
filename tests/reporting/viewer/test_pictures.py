"""Real pictures of every tab, drawn without a window."""

import json
import time
from itertools import pairwise

import numpy as np
import pytest
from PIL import Image
from rerun.experimental import ViewerClient

from tests.reporting.made_folders import make_dataset
from tsas_cli.reporting.inputs import read_inputs
from tsas_cli.reporting.stream import write_stream
from tsas_cli.reporting.viewer.child import LOOPBACK, drawn_with, free_ports, viewer_child
from tsas_cli.stages.simulate import simulate
from tsas_cli.support.errors import InputError

COLOURS = 100
COLOURED = 0.005  # of the picture; around the views all is grey but a few signs
SOON_S = 40.0


@pytest.fixture
def viewer(tmp_path, monkeypatch):
    """Open a stream of a dataset and its simulation in a viewer without a window."""
    monkeypatch.setenv("CI", "true")
    try:
        drawn_with()
    except InputError as error:
        pytest.skip(f"the viewer cannot draw here: {error}")
    dataset = make_dataset(tmp_path / "dataset", ("a",), samples=2000)
    simulated = tmp_path / "simulated"
    simulate(dataset, out=simulated)
    stream = tmp_path / "stream.rrd"
    write_stream(read_inputs([simulated]), stream)
    (port,) = free_ports(1)
    call = ["--bind", LOOPBACK, "--port", str(port), "--headless", "--window-size", "900x600"]
    with viewer_child([*call, "--hide-welcome-screen", str(stream)], port=port):
        client = ViewerClient.connect(f"rerun+http://{LOOPBACK}:{port}/proxy")
        until(lambda: client.get_state().views and not client.get_state().loading)
        yield client


def until(holds):
    end = time.monotonic() + SOON_S
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.05)


def picture(client, path):
    """Return what is drawn, once it stays the same."""
    before = None
    end = time.monotonic() + SOON_S
    while time.monotonic() < end:
        client.save_screenshot(str(path))
        now = np.asarray(Image.open(path).convert("RGB"))
        if before is not None and np.array_equal(before, now):
            break
        before = now
    return now


def tabs(blueprint):
    """Return the path of the outermost tabs in a blueprint, and what is in them."""
    root = blueprint["/viewport"]["ViewportBlueprint"]["root_container"]
    path = f"/container/{root}"
    return path, blueprint[path]["ContainerBlueprint"]["contents"]


def test_every_tab_is_drawn_and_no_view_reports_an_error(viewer, tmp_path):
    recording = viewer.get_state().active_recording
    viewer.set_time("t", duration=6.0, play_state="paused")
    blueprint = viewer.get_blueprint().blueprint
    path, parts = tabs(blueprint)
    assert len(parts) == 3  # Overview, Residuals, Tendon
    pictures = []
    for part in parts:
        chosen = json.loads(json.dumps(blueprint))
        chosen[path]["ContainerBlueprint"]["active_tab"] = part
        viewer.set_blueprint(chosen, store_id=recording)
        viewer.set_time("t", duration=6.0, play_state="paused")
        pictures.append(picture(viewer, tmp_path / f"{len(pictures)}.png"))
        for view in viewer.get_state().views:
            assert [report.summary for report in view.reports] == [], view.name
    for drawn in pictures:
        assert len(np.unique(drawn.reshape(-1, 3), axis=0)) > COLOURS
        assert (np.ptp(drawn.astype(int), axis=2) > 40).mean() > COLOURED
    for one, other in pairwise(pictures):
        assert (one != other).any(axis=2).mean() > 0.02
    assert [entry for entry in viewer.get_logs() if entry.level == "ERROR"] == []
