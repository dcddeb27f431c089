"""The tendon's part of a stream, read back and held against a simulation of its own."""

import json
import math
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from rerun.blueprint import Tabs

import tsas_cli as tsas
from tests.reporting.made_folders import (
    columns,
    make_dataset,
    make_diagnosis,
    make_simulation,
    source,
)
from tests.reporting.stream.streams import read, shown, views
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model, write_model
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import simulate
from tsas_cli.recordings.columns import nominal_name
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.manifest import Manifest, Run
from tsas_cli.recordings.writing import write_dataset, write_parquet
from tsas_cli.reporting.inputs import read_inputs
from tsas_cli.reporting.stream import write_stream
from tsas_cli.reporting.stream.seen import seen_runs
from tsas_cli.reporting.stream.stream import stream_of
from tsas_cli.reporting.stream.tendon.content import view_of_tendon

VALUES = {
    "friction_coefficient": (0.125, "1"),
    "load_stiffness_N_per_mm": (1.579, "N/mm"),
    "tendon_stiffness_N": (67858.0, "N"),
}
FREE = {"free_tendon.proximal_length_mm": (150.0, "mm")}
NOMINAL, EXTENDED = "model", "model_extended"


def model(values):
    return Model(tuple(Estimate(name, v, u, "default") for name, (v, u) in values.items()))


MODELS = {NOMINAL: model(VALUES), EXTENDED: model(VALUES | FREE)}


def answer(recording, one, samples=None):
    f_in = recording.columns["f_in_N"]
    slope_and_start = np.polyfit(recording.time_s[:20], f_in[:20], 1)
    drive = DriveInput(
        recording.columns["x_in_mm"],
        time_s=recording.time_s,
        start_f_in_N=float(slope_and_start[1]),
    )
    return simulate(one.rig(recording.run), drive, looked_at=samples)


@pytest.fixture(scope="module")
def made(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("tendon")
    dataset = make_dataset(folder / "dataset", ids=("a",), samples=6000)
    out = make_diagnosis(dataset, folder / "diagnose", "named")
    for name, one in (("model-nominal.toml", NOMINAL), ("model-extended.toml", EXTENDED)):
        write_model(out / name, MODELS[one], version="0.1.0", dataset=source(dataset, out))
    (out / "runs").mkdir()
    for recording in read_dataset(dataset):
        told = {"time_s": recording.time_s, "x_in_mm": recording.columns["x_in_mm"]}
        told["f_in_N"] = answer(recording, MODELS[EXTENDED]).f_in_N
        told[nominal_name("f_in_N")] = answer(recording, MODELS[NOMINAL]).f_in_N
        write_parquet(out / "runs" / f"{recording.run.id}.parquet", pa.table(told))
    write_stream(read_inputs([out]), folder / "s.rrd")
    return folder


@pytest.fixture(scope="module")
def found(made):
    return read(made / "s.rrd")


@pytest.fixture(scope="module")
def recording(made):
    return next(iter(read_dataset(made / "dataset")))


def samples_of(entity, recording):
    """Return the samples at which an entity stands; its times are theirs to the nanosecond."""
    known = np.round(recording.time_s * 1e9).astype(np.int64)
    at = entity.at()
    samples = np.searchsorted(known, at)
    np.testing.assert_array_equal(known[samples], at)
    return samples


@pytest.mark.parametrize("key", [NOMINAL, EXTENDED])
def test_the_curtain_is_as_high_as_the_tension(found, recording, key):
    curtain = found[f"/run/a/tendon/space/{key}/curtain"]
    samples = samples_of(curtain, recording)
    expected = answer(recording, MODELS[key], samples).frames.tension_N
    corners = np.array(curtain.rows["Mesh3D:vertex_positions"])
    half = corners.shape[1] // 2
    height = corners[:, half:, 2] - corners[:, :half, 2]
    per_N = height.max() / expected.max()
    np.testing.assert_allclose(height, per_N * expected, rtol=1e-4)
    assert (height[:, 0] != height[:, -1]).any()
    other = answer(recording, MODELS[EXTENDED if key == NOMINAL else NOMINAL], samples)
    assert np.abs(other.frames.tension_N - expected).max() > 1.0  # they are not swapped


def test_both_models_are_drawn_to_one_scale(found):
    per_N = []
    for key in (NOMINAL, EXTENDED):
        tension = np.array(found[f"/run/a/tendon/along/{key}/now"].rows["LineStrips2D:strips"])
        corners = np.array(
            found[f"/run/a/tendon/space/{key}/curtain"].rows["Mesh3D:vertex_positions"]
        )
        half = corners.shape[1] // 2
        height = corners[:, half:, 2] - corners[:, :half, 2]
        level = -tension[:, 0, :, 1]
        per_N.append(np.polyfit(level.ravel(), height.ravel(), 1)[0])
    assert per_N[0] == pytest.approx(per_N[1], rel=1e-3)


@pytest.mark.parametrize("key", [NOMINAL, EXTENDED])
def test_it_is_thick_where_it_slips_and_the_front_stands_between(found, recording, key):
    tendon = found[f"/run/a/tendon/space/{key}/tendon"]
    samples = samples_of(tendon, recording)
    frames = answer(recording, MODELS[key], samples).frames
    radii = np.array(tendon.rows["LineStrips3D:radii"])
    slips = np.isin(frames.slip, (1, -1))
    assert radii[slips].min() > 2.0 * radii[~slips].max()
    assert 0.02 < (~slips).mean() < 0.9
    points = found[f"/run/a/tendon/space/{key}/front/ends"].rows["Points3D:positions"]
    runs = (frames.front > 0.0) & (frames.front < 1.0)
    assert [len(at) for at in points] == (2 * runs).tolist()
    assert runs.sum() > 30


def test_the_tendon_has_the_colours_of_its_tension(found, recording):
    tendon = found[f"/run/a/tendon/space/{NOMINAL}/tendon"]
    frames = answer(recording, MODELS[NOMINAL], samples_of(tendon, recording)).frames
    colours = np.array(tendon.rows["LineStrips3D:colors"], dtype=np.uint32)
    shade = np.stack([(colours >> shift) & 0xFF for shift in (24, 16, 8)], axis=-1)
    light = shade @ [0.2126, 0.7152, 0.0722]
    middle = 0.5 * (frames.tension_N[:, 1:] + frames.tension_N[:, :-1])
    order = np.argsort(middle, axis=None)
    assert (np.diff(light.ravel()[order][::50]) >= 0.0).all()


def test_the_fronts_are_among_the_events(found, recording):
    for key in (NOMINAL, EXTENDED):
        events = found[f"/run/a/events/fronts-{key}"]
        phase = answer(recording, MODELS[key]).phase
        texts = [row[0] for row in events.rows["TextLog:text"]]
        assert all(" s: a: " in text for text in texts)
        arrived = samples_of(events, recording)[[" reaches " in text for text in texts]]
        assert arrived.size == 4  # two periods
        assert (np.isin(phase[arrived], (1, -1)) & (phase[arrived - 1] == 0)).all()
    words = " ".join(texts)
    assert words.index("after the drive pulled") < words.index("after the drive let go")


def test_the_dead_band_shows_measured_and_both_models(found):
    below = "/run/a/tendon/dead-band"
    strokes = found[f"{below}/measured"].rows["LineStrips2D:strips"]
    assert len(strokes) == 4
    for key in (NOMINAL, EXTENDED):
        assert len(found[f"{below}/{key}/stroke"].rows["LineStrips2D:strips"]) == 4
        counts = {len(row) for row in found[f"{below}/{key}/now"].rows["Points2D:positions"]}
        assert counts == {0, 1}


def test_every_view_of_the_tab_shows_what_is_recorded(made, found):
    inputs = read_inputs([made / "diagnose"])
    root = stream_of(inputs).layout.root_container
    assert isinstance(root, Tabs)
    tab = next(part for part in root.contents if part.name == "Tendon")
    drawn = views(tab)
    assert [view.class_identifier for view in drawn] == ["3D", "2D", "2D", "2D"]
    for view in drawn:
        for entity in shown(view):
            assert any(f"{path}/".startswith(f"{entity}/") for path in found)


def test_it_costs_little(made, found):
    own = sum(
        len(entity.at()) for path, entity in found.items() if "/tendon/" in path and entity.times
    )
    assert own > 1000
    assert (made / "s.rrd").stat().st_size < 5e6


def view_in(*folders):
    run = next(iter(seen_runs(read_inputs(list(folders)))))
    return view_of_tendon(run)


def test_a_simulation_shows_its_one_model(made, tmp_path):
    dataset = read_dataset(made / "dataset")
    write_model(tmp_path / "m.toml", MODELS[EXTENDED], version="0.1.0", dataset={})
    out = tmp_path / "simulate"
    tsas.simulate(dataset, model=tmp_path / "m.toml", out=out, nodes=20)
    write_stream(read_inputs([out]), tmp_path / "s.rrd")
    paths = read(tmp_path / "s.rrd")
    assert "/run/a/tendon/space/simulated/curtain" in paths
    pieces = paths["/run/a/tendon/space/simulated/tendon"].static["LineStrips3D:strips"]
    assert len(pieces) == 20
    length = np.linalg.norm(np.diff(np.array(pieces), axis=1), axis=2).sum()
    assert length == pytest.approx(785.0 * math.sin(math.pi / 40) / (math.pi / 40), rel=1e-4)


def test_the_lumped_model_and_folders_without_a_model_show_none(made, tmp_path):
    dataset = made / "dataset"
    assert view_in(make_simulation(dataset, tmp_path / "simulate")) is None
    assert view_in(make_diagnosis(dataset, tmp_path / "diagnose", "named")) is None
    out = tmp_path / "static"
    tsas.simulate(dataset, dynamics="static", out=out)
    assert json.loads((out / "simulation.json").read_text())["dynamics"] == "static"
    assert view_in(out) is None
    assert view_in(dataset) is None


def test_runs_with_gaps_without_x_in_and_with_other_loads(tmp_path):
    """A stage does not write down how it has cleaned forces; they are cleaned again."""
    whole = columns(3000)
    gap = whole | {"f_in_N": whole["f_in_N"].copy()}
    gap["f_in_N"][800:1600] = np.nan  # all of the second stroke
    by_force = {name: values for name, values in whole.items() if name != "x_in_mm"}
    given = {"gap": (gap, "spring"), "f_in": (by_force, "spring"), "f_out": (whole, "force")}
    runs = [
        Run(
            id=name,
            file=f"runs/{name}.parquet",
            sha256="0" * 64,
            sheath_length_mm=785.0,
            total_bend_rad=math.pi,
            preload_N=25.0,
            load=load,
        )
        for name, (_, load) in given.items()
    ]
    (tmp_path / "d").mkdir()
    tables = {
        name: pa.table({n: pa.array(v, from_pandas=True) for n, v in table.items()})
        for name, (table, _) in given.items()
    }
    manifest = Manifest(format=1, name="odd", kind="simulated", run=tuple(runs))
    write_dataset(tmp_path / "d", manifest, tables)
    write_model(tmp_path / "m.toml", MODELS[NOMINAL], version="0.1.0", dataset={})
    out = tmp_path / "s"
    tsas.simulate(tmp_path / "d", model=tmp_path / "m.toml", out=out, nodes=20)
    write_stream(read_inputs([out]), tmp_path / "s.rrd")
    paths = read(tmp_path / "s.rrd")
    strokes = {}
    for name in given:
        assert len(paths[f"/run/{name}/tendon/space/simulated/tendon"].at()) > 150
        assert len(paths[f"/run/{name}/events/fronts-simulated"].at()) == 4
        strokes[name] = len(paths[f"/run/{name}/tendon/dead-band/measured"].at())
    assert strokes == {"gap": 3, "f_in": 4, "f_out": 4}
