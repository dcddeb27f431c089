"""The tendon's part of a stream, read back and held against a simulation of its own."""

import json
import math
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest

import tsas_cli as tsas
from tests.reporting import made_diagnoses
from tests.reporting import made_folders as by_hand
from tests.reporting.stream.streams import stream
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model
from tsas_cli.identification.model_file import write_model
from tsas_cli.numerics.conditioning import condition
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import simulate
from tsas_cli.recordings.columns import nominal_name
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.writing import write_parquet
from tsas_cli.reporting.inputs import read_inputs
from tsas_cli.reporting.stream.seen import seen_runs
from tsas_cli.reporting.stream.tendon import MOST, moments, sheath_of, view_of_tendon
from tsas_studies.challenge.rig.recordings import Run, write_dataset

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
        condition(recording.time_s, recording.columns["x_in_mm"]).values,
        time_s=recording.time_s,
        start_f_in_N=float(slope_and_start[1]),
    )
    return simulate(one.rig(recording.run), drive, looked_at=samples)


@pytest.fixture(scope="module")
def made(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("tendon")
    dataset = by_hand.make_dataset(folder / "dataset", ids=("a",), samples=1500)
    out = made_diagnoses.make_diagnosis(dataset, folder / "diagnose", "named")
    for name, one in (("model-nominal.toml", NOMINAL), ("model-extended.toml", EXTENDED)):
        write_model(out / name, MODELS[one], version="0.1.0", dataset=by_hand.source(dataset, out))
    (out / "runs").mkdir()
    for recording in read_dataset(dataset):
        told = {"time_s": recording.time_s, "x_in_mm": recording.columns["x_in_mm"]}
        told["f_in_N"] = answer(recording, MODELS[EXTENDED]).f_in_N
        told[nominal_name("f_in_N")] = answer(recording, MODELS[NOMINAL]).f_in_N
        write_parquet(out / "runs" / f"{recording.run.id}.parquet", pa.table(told))
    return folder


@pytest.fixture(scope="module")
def found(made):
    return stream(made, made / "diagnose")


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
def test_the_curve_is_as_high_as_the_tension(found, recording, key):
    curve = found[f"/run/a/tendon/{key}/tension"]
    samples = samples_of(curve, recording)
    expected = answer(recording, MODELS[key], samples).frames.tension_N
    height = np.array([row[0] for row in curve.rows["LineStrips3D:strips"]])[..., 2]
    per_N = height[0, 0] / expected[0, 0]
    np.testing.assert_allclose(height, per_N * expected, rtol=1e-4)
    other = answer(recording, MODELS[EXTENDED if key == NOMINAL else NOMINAL], samples)
    assert np.abs(other.frames.tension_N - expected).max() > 1.0  # they are not swapped
    scale = found[f"/run/a/tendon/{NOMINAL}/tension"].rows["LineStrips3D:strips"][0][0][0][2]
    assert height[0, 0] == pytest.approx(scale, rel=1e-4)  # both begin at the preload


@pytest.mark.parametrize("key", [NOMINAL, EXTENDED])
def test_it_is_thick_where_it_slips_and_the_front_stands_on_the_curve(found, recording, key):
    tendon = found[f"/run/a/tendon/{key}/tendon"]
    samples = samples_of(tendon, recording)
    frames = answer(recording, MODELS[key], samples).frames
    radii = np.array(tendon.rows["LineStrips3D:radii"])
    slips = np.isin(frames.slip, (1, -1))
    assert radii[slips].min() > 2.0 * radii[~slips].max()
    assert 0.02 < (~slips).mean() < 0.9
    points = found[f"/run/a/tendon/{key}/front"].rows["Points3D:positions"]
    runs = (frames.front > 0.0) & (frames.front < 1.0)
    assert [len(at) for at in points] == runs.astype(int).tolist()
    assert runs.sum() > 30  # a dead band is seen in many pictures
    x = np.array(tendon.static["LineStrips3D:strips"])[:, 0, 0]
    fronts = np.array([at[0][0] for at in points if at])
    assert np.corrcoef(np.interp(fronts, x, frames.places[:-1]), frames.front[runs])[0, 1] > 0.999


def test_the_tendon_has_the_colours_of_its_tension(found, recording):
    tendon = found[f"/run/a/tendon/{NOMINAL}/tendon"]
    frames = answer(recording, MODELS[NOMINAL], samples_of(tendon, recording)).frames
    colours = np.array(tendon.rows["LineStrips3D:colors"], dtype=np.uint32)
    shade = np.stack([(colours >> shift) & 0xFF for shift in (24, 16, 8)], axis=-1)
    light = shade @ [0.2126, 0.7152, 0.0722]
    middle = 0.5 * (frames.tension_N[:, 1:] + frames.tension_N[:, :-1])
    order = np.argsort(middle, axis=None)
    assert (np.diff(light.ravel()[order][::50]) >= 0.0).all()
    assert (colours & 0xFF == 0xFF).all()


def test_it_is_looked_at_evenly_in_time_and_more_often_where_a_tension_changes():
    time_s = np.arange(0.0, 20.0, 1e-3)
    jump = 25.0 + 50.0 * np.clip((time_s - 10.0) / 0.05, 0.0, 1.0)
    at = moments(time_s, [jump])
    assert at[0] == 0
    assert at[-1] == time_s.size - 1
    assert (np.diff(time_s[at]) < 0.07).all()
    assert ((at > 10_000) & (at < 10_050)).sum() > 25
    assert moments(np.arange(0.0, 2000.0, 0.01), []).size <= MOST + 1


@pytest.mark.parametrize("bend", [0.0, 1.0, math.pi, 9.0, 30.0])
def test_the_sheath_has_its_length_and_its_bend(bend):
    steps = np.diff(sheath_of(785.4, bend, 400), axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    assert lengths.sum() == pytest.approx(785.4, rel=1e-3)
    cosines = (steps[1:] * steps[:-1]).sum(axis=1) / (lengths[1:] * lengths[:-1])
    assert np.arccos(np.clip(cosines, -1.0, 1.0)).sum() == pytest.approx(bend, rel=0.01, abs=1e-3)


def view_in(*folders):
    run = next(iter(seen_runs(read_inputs(list(folders)))))
    return view_of_tendon(run)


def simulated(folder, dataset, one):
    """Return what a stream shows of a simulation with 20 nodes."""
    write_model(folder / "m.toml", one, version="0.1.0", dataset={})
    tsas.simulate(dataset, model=folder / "m.toml", out=folder / "s", nodes=20)
    return stream(folder, folder / "s")


def test_a_simulation_shows_its_one_model(made, tmp_path):
    paths = simulated(tmp_path, made / "dataset", MODELS[EXTENDED])
    assert len(paths["/run/a/tendon/simulated/tendon"].static["LineStrips3D:strips"]) == 20
    assert "/run/a/tendon/simulated/tension" in paths


def test_other_dynamics_and_folders_without_a_model_show_none(made, tmp_path):
    dataset = made / "dataset"
    assert view_in(by_hand.make_simulation(dataset, tmp_path / "simulate")) is None
    assert view_in(made_diagnoses.make_diagnosis(dataset, tmp_path / "diagnose", "named")) is None
    for dynamics in ("static", "lugre"):
        out = tmp_path / dynamics
        tsas.simulate(dataset, dynamics=dynamics, out=out)
        assert json.loads((out / "simulation.json").read_text())["dynamics"] == dynamics
        assert view_in(out) is None
    assert view_in(dataset) is None


def test_runs_with_gaps_without_x_in_and_with_other_loads(tmp_path):
    """A stage does not write down how it has cleaned forces; they are cleaned again."""
    whole = by_hand.columns(3000)
    gap = whole | {"f_in_N": whole["f_in_N"].copy()}
    gap["f_in_N"][800:1600] = np.nan  # all of the second stroke
    by_force = {name: values for name, values in whole.items() if name != "x_in_mm"}
    given = {"gap": (gap, "spring"), "f_in": (by_force, "spring"), "f_out": (whole, "force")}
    told = {"sheath_length_mm": 785.0, "total_bend_rad": math.pi, "preload_N": 25.0}
    runs = [Run(name, table, told | {"load": load}) for name, (table, load) in given.items()]
    write_dataset(tmp_path / "d", runs, data_sheet={})
    paths = simulated(tmp_path, tmp_path / "d", MODELS[NOMINAL])
    for name in given:
        assert len(paths[f"/run/{name}/tendon/simulated/tendon"].at()) > 150
