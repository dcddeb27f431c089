"""Exported models: read back as JSON and CSV, run by MuJoCo within the error that they state."""

import csv
import json
import warnings

import numpy as np
import pytest

import tsas_cli as tsas
from tests.refusals import refusal
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model
from tsas_cli.physics.lumped import follow, lumped_of
from tsas_cli.physics.rig import Rig
from tsas_cli.support.errors import InputError

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    import mujoco

RIG = {
    "friction_coefficient": (0.125, "1"),
    "tendon_stiffness_N": (6e4, "N"),
    "load_stiffness_N_per_mm": (1.6, "N/mm"),
    "free_tendon.proximal_length_mm": (150.0, "mm"),
    "load_friction.after_sensor_N": (2.0, "N"),
}
CONDITIONS = {"sheath_length_mm": 800.0, "total_bend_rad": 3.0, "preload_N": 25.0}
STROKE_M, STROKE_S = 0.01, 1.0


def model(**changed):
    values = RIG | changed
    return Model(tuple(Estimate(name, *value, origin="fitted") for name, value in values.items()))


def test_json_and_csv_are_the_estimates(tmp_path):
    estimates = [vars(e) for e in model().estimates]
    tsas.export(model(), to="json", out=tmp_path / "m.json")
    assert json.loads((tmp_path / "m.json").read_text())["parameters"] == estimates
    tsas.export(model(), to="csv", out=tmp_path / "m.csv")
    with (tmp_path / "m.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [(r["name"], float(r["value"]), r["unit"]) for r in rows] == [
        (e["name"], e["value"], e["unit"]) for e in estimates
    ]
    one = Model((Estimate("preload_N", 25.0, "N", "fitted", "=1+1"),))
    tsas.export(one, to="csv", out=tmp_path / "n.csv")
    assert "preload_N,'=1+1,25.0,N" in (tmp_path / "n.csv").read_text()  # a sheet computes no name


def moved(path):
    """Return x_in [m], f_in [N] and x_out [mm] of strokes in MuJoCo, after the first one."""
    simulated = mujoco.MjModel.from_xml_path(str(path))
    state, step_s = mujoco.MjData(simulated), simulated.opt.timestep
    x_in, f_in, x_out = [], [], []
    for n in range(round(3.0 * STROKE_S / step_s)):
        phase = np.pi * n * step_s / STROKE_S
        state.qpos[0] = 0.5 * STROKE_M * (1.0 - np.cos(phase))
        state.qvel[0] = 0.5 * STROKE_M * np.pi / STROKE_S * np.sin(phase)
        mujoco.mj_step1(simulated, state)
        tendon = simulated.tendon_stiffness[0]
        f_in.append(tendon * (state.ten_length[0] - simulated.tendon_lengthspring[0, 1]))
        x_in.append(state.qpos[0])
        x_out.append(1e3 * state.qpos[2])
        mujoco.mj_step2(simulated, state)
    after = round(STROKE_S / step_s)
    return tuple(np.array(values)[after:] for values in (x_in, f_in, x_out))


def test_a_mujoco_model_that_was_edited_stays(tmp_path):
    call = {"to": "mujoco", "out": tmp_path / "rig.xml", "force": True, **CONDITIONS}
    tsas.export(model(), **call)
    tsas.export(model(), **call)
    text = call["out"].read_text()
    call["out"].write_text(text.replace("<worldbody>", "<worldbody><light/>"))
    with pytest.raises(InputError, match=r"rig\.xml: has changed since it was written"):
        tsas.export(model(), **call)


def test_mujoco_does_what_the_file_says_within_the_error_that_it_states(tmp_path):
    path = tmp_path / "rig.xml"
    exported = tsas.export(model(), to="mujoco", out=path, **CONDITIONS)
    x_in, f_in, x_out = moved(path)
    lumped = lumped_of(Rig(*(v for v, _ in list(RIG.values())[:3]), *CONDITIONS.values()), 10.0)
    lumped = lumped._replace(proximal_N_per_mm=6e4 / (400.0 + 150.0), load_friction_N=2.0)
    tension, place = follow(lumped, 1e3 * x_in)
    assert np.sqrt(np.mean((f_in - tension) ** 2)) < 0.01 * np.ptp(tension)
    assert np.sqrt(np.mean((x_out - place) ** 2)) < 0.01 * np.ptp(place)
    assert exported.summary["errors"]["f_in_N"]["rms"] < 0.1 * np.ptp(tension)
    said = path.read_text()
    assert f"{exported.summary['errors']['f_in_N']['rms']:.3g} N (RMS)" in said
    assert all(sentence in said for sentence in exported.lost)


def test_without_friction_the_lumped_tendon_is_the_model(tmp_path):
    none = {"friction_coefficient": (0.0, "1"), "load_friction.after_sensor_N": (0.0, "N")}
    exported = tsas.export(model(**none), to="mujoco", out=tmp_path / "a.xml", **CONDITIONS)
    for channel in exported.summary["errors"].values():
        assert channel["largest"] < 1e-6 * channel["span"]


def test_what_a_tendon_of_mujoco_cannot_hold_is_said(tmp_path):
    played = model(**{"backlash.play_mm": (0.3, "mm")})
    exported = tsas.export(played, to="mujoco", out=tmp_path / "a.xml", **CONDITIONS)
    assert any("backlash" in sentence for sentence in exported.lost)


def test_a_condition_that_the_recordings_do_not_agree_on_is_asked_for(tmp_path):
    groups = tsas.calibrate("datasets/paper-groups", runs=["a", "d"], out=tmp_path / "model")
    with pytest.raises(InputError, match=r"--sheath-length-mm: the model holds for .* 314.*785"):
        tsas.export(groups.out, to="mujoco", out=tmp_path / "a.xml")
    assert not (tmp_path / "a.xml").exists()
    one = tsas.export(
        groups.out, to="mujoco", out=tmp_path / "a.xml", sheath_length_mm=785.4, total_bend_rad=3.14
    )
    assert 'gear="4428.04' in one.out.read_text()  # 120 / 27.1 mm


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("sheath_length_mm", -5.0, "expected 1e-06 to 1e+09 mm, got -5.0"),
        ("sheath_length_mm", 1e30, "expected 1e-06 to 1e+09 mm"),
        ("preload_N", -1.0, "expected 0, or 1e-06 to 100000 N"),
        ("total_bend_rad", float("nan"), "input should be a finite number"),
    ],
)
def test_an_implausible_condition_is_one_line(tmp_path, name, value, told):
    call = {"to": "mujoco", "out": tmp_path / "a.xml"} | CONDITIONS | {name: value}
    assert refusal(tsas.export, model(), **call).startswith(f"{name}: {told}")
