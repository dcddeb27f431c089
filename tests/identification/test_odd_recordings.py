"""Recordings as strangers bring them: right numbers, or a sentence that says why there are none."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.identification.recorded import TRUE, VALUES, clean
from tests.identification.recorded import ran as recorded_as
from tsas_cli.identification.calibration import calibrate_runs
from tsas_cli.identification.comparison import compare
from tsas_cli.physics.phases import SLACK
from tsas_cli.physics.response import DriveInput, simulate
from tsas_cli.physics.rig import Rig as ModelRig
from tsas_cli.recordings.manifest import Manifest
from tsas_studies.challenge.rig.motions import dwell, nested, sine, triangle
from tsas_studies.challenge.rig.recordings import DATA_SHEET, conditions
from tsas_studies.challenge.rig.sensors import PERFECT, Sensor, Sensors, measure
from tsas_studies.challenge.rig.tendon import Rig

SENSORS = Sensors(rate_Hz=100.0)
CHANNELS = ("f_in_N", "f_out_N", "x_out_mm")


def recorded(motion=None, *, rig=TRUE, sensors=SENSORS, seed=1):
    return measure(clean(rig, motion or sine(rate_Hz=400.0)), sensors, seed=seed)


def ran(columns, *, rig=TRUE, run_id="a", **said):
    return recorded_as(columns, run_id=run_id, **conditions(rig) | said)


def calibrated(*runs, **sheet):
    stated = {key: value for key, value in (DATA_SHEET | sheet).items() if value is not None}
    manifest = Manifest(
        format=1, name="t", kind="measured", rig=stated, run=tuple(run.run for run in runs)
    )
    return calibrate_runs(manifest, runs)


def fitted(result):
    return {e.name: e for e in result.model.estimates if e.origin == "fitted"}


def is_right(result, *names, part=0.01, values=VALUES):
    estimates = fitted(result)
    for name in names or values:
        assert estimates[name].value == pytest.approx(values[name], rel=part), name
        assert 0.0 < estimates[name].stderr < 0.05 * values[name], name


def part_of(columns, first, end):
    size = columns["time_s"].size
    return {name: v[int(first * size) : int(end * size)] for name, v in columns.items()}


def with_gap(columns, rows, *names):
    gone = np.zeros(columns["time_s"].size, dtype=bool)
    gone[rows] = True
    return {name: np.where(gone, np.nan, v) if name in names else v for name, v in columns.items()}


@pytest.mark.parametrize("ends", [(0.1, 1.0), (0.255, 1.0), (0.45, 1.0), (0.0, 0.25), (0.25, 0.5)])
def test_a_recording_may_begin_anywhere_in_a_cycle_and_half_of_one_is_enough(ends):
    """In contraction, in the dead band, in loosening: what came before does not enter the fit."""
    result = calibrated(ran(part_of(recorded(), *ends)))
    is_right(result)
    assert not any("lacks an effect" in sentence for sentence in result.cannot_tell)


def test_a_dead_band_alone_says_that_it_is_not_enough():
    """The tendon's state before it is unknown, and with it what its tensions mean."""
    columns = part_of(recorded(sensors=Sensors()), 0.25, 0.262)
    result = calibrated(ran(columns))
    assert fitted(result) == {}
    assert any("after the first full slip" in s for s in result.cannot_tell)


LEVELS = {"x_in_mm": 5.0, "x_out_mm": 3.0, "f_in_N": 30.0, "f_out_N": 25.0}


@pytest.mark.parametrize("noise", [0.0, 0.05])
def test_nothing_moves(noise):
    rng = np.random.default_rng(0)
    columns = {n: level + noise * rng.standard_normal(400) for n, level in LEVELS.items()}
    is_no_fit(columns | {"time_s": np.arange(400) / 200.0})


@pytest.mark.parametrize("samples", [2, 17])
def test_a_few_samples_are_no_fit(samples):
    is_no_fit({name: v[300 : 300 + samples] for name, v in recorded().items()})


def is_no_fit(columns):
    result = calibrated(ran(columns))
    assert fitted(result) == {}
    assert result.cannot_tell


@pytest.mark.parametrize("name", CHANNELS)
def test_a_dead_channel_does_not_spoil_the_others(name):
    """A sensor that hangs has no noise: by its own light it would outweigh everything."""
    columns = recorded()
    result = calibrated(ran(columns | {name: np.full_like(columns[name], 7.0)}))
    is_right(result, "friction_coefficient", "load_stiffness_N_per_mm")
    assert f"{name} of run a does not enter the fit: it is constant." in result.cannot_tell


@pytest.mark.parametrize("name", CHANNELS)
def test_an_empty_channel_is_as_if_it_were_not_there(name):
    columns = recorded()
    there = {key: v for key, v in columns.items() if key != name}
    empty = calibrated(ran(columns | {name: np.full_like(columns[name], np.nan)}))
    without = calibrated(ran(there))
    assert empty.model == without.model


@pytest.mark.parametrize("name", ["x_in_mm", "f_in_N"])
def test_gaps_are_left_out(name):
    """At the beginning, in the middle and at the end."""
    rows = [*range(100), *range(600, 700), *range(-100, 0)]
    result = calibrated(ran(with_gap(recorded(), rows, name)))
    is_right(result)
    assert not any("lacks an effect" in sentence for sentence in result.cannot_tell)


def test_channels_of_two_loggers_that_never_share_a_row():
    """Each column holds every other row: that is its rate, not a gap."""
    columns = recorded(sensors=replace(SENSORS, rate_Hz=400.0))
    columns = with_gap(columns, slice(0, None, 2), "x_in_mm")
    run = ran(with_gap(columns, slice(1, None, 2), *CHANNELS))
    assert not run.in_gap.all()
    is_right(calibrated(run))


def test_the_drive_is_cleaned_by_its_own_samples():
    """Filled by straight lines before, a channel with every other row looks too good."""
    columns = recorded()
    half = {name: v[::2] for name, v in columns.items()}
    full = ran(with_gap(columns, slice(1, None, 2), "x_in_mm")).conditioned["x_in_mm"]
    alone = ran(half).conditioned["x_in_mm"]
    assert full.noise == alone.noise
    assert np.array_equal(full.values[::2], alone.values)


def test_sampling_may_be_irregular():
    exact = clean(TRUE).columns
    rng = np.random.default_rng(2)
    t = np.sort(rng.uniform(0.0, exact["time_s"][-1], 2500))
    noise = {name: 0.005 if name.startswith("x") else 0.08 for name in ("x_in_mm", *CHANNELS)}
    columns = {
        name: np.interp(t, exact["time_s"], exact[name]) + sd * rng.standard_normal(t.size)
        for name, sd in noise.items()
    }
    is_right(calibrated(ran({"time_s": t, **columns})))


def at_rate(rate_Hz):
    return replace(SENSORS, rate_Hz=rate_Hz)


@pytest.mark.parametrize(
    ("motion", "sensors", "part"),
    [
        (triangle, SENSORS, 0.01),
        (dwell, SENSORS, 0.01),
        (nested, SENSORS, 0.01),
        (triangle, at_rate(1500.0), 0.01),  # simulated at as many samples as a short run
        (sine, at_rate(30.0), 0.02),
        (sine, replace(SENSORS, jitter_s=0.3 / 200.0), 0.01),
        (sine, replace(PERFECT, rate_Hz=200.0), 2e-3),
    ],
)
def test_other_motions_and_sensors(motion, sensors, part):
    moved = motion(rate_Hz=max(400.0, sensors.rate_Hz))
    is_right(calibrated(ran(recorded(moved, sensors=sensors))), part=part)


@pytest.mark.parametrize(
    "sensors",
    [
        Sensors(200.0, 0.0, Sensor(0.1), Sensor(0.1), Sensor(1.0), Sensor(1.0)),
        Sensors(200.0, 0.0, *2 * [Sensor(step=0.2)], *2 * [Sensor(step=1.0)]),
    ],
    ids=["large noise", "coarse steps"],
)
def test_large_noise_and_coarse_steps(sensors):
    """What they drown is kept as the data sheet says; the rest is found."""
    result = calibrated(ran(recorded(sensors=sensors)))
    is_right(result, "friction_coefficient", "load_stiffness_N_per_mm", "preload_N")
    rest = {e.name: e for e in result.model.estimates if e.origin == "data sheet"}
    assert "tendon_stiffness_N" in fitted(result) | rest


def test_almost_no_friction_is_found_to_be_that():
    rig = Rig(friction_coefficient=0.001 / math.pi)
    result = calibrated(ran(recorded(rig=rig), rig=rig))
    assert fitted(result)["friction_coefficient"].value < 0.002
    assert fitted(result)["load_stiffness_N_per_mm"].value == pytest.approx(1.579, rel=2e-3)
    assert not any("lacks an effect" in sentence for sentence in result.cannot_tell)


def test_much_friction():
    rig = Rig(friction_coefficient=2.5 / math.pi)
    result = calibrated(ran(recorded(rig=rig), rig=rig))
    assert fitted(result)["friction_coefficient"].value == pytest.approx(2.5 / math.pi, rel=1e-3)


def test_a_short_run_among_long_ones():
    rest = ran(part_of(recorded(), 0.25, 0.255), run_id="b")
    result = calibrated(ran(recorded()), rest)
    is_right(result)
    assert any("Run b does not enter the fit" in sentence for sentence in result.cannot_tell)


def test_runs_with_loads_of_different_kinds():
    """One friction and one tendon for all; only the spring's run has a preload to find."""
    columns = recorded()
    runs = [ran(columns, run_id=kind, load=kind) for kind in ("spring", "force", "displacement")]
    result = calibrated(*runs)
    is_right(result)
    owners = {e.run for e in result.model.estimates if e.name == "preload_N" and e.stderr}
    assert owners == {"spring"}


def test_a_force_drives_the_tendon():
    """Without x_in the tension at the drive drives; friction comes from what passes."""
    columns = {n: v for n, v in recorded().items() if n != "x_in_mm"}
    for first in (0.0, 0.3):
        result = calibrated(ran(part_of(columns, first, 1.0)))
        is_right(result, "friction_coefficient", "load_stiffness_N_per_mm", "preload_N")


def test_a_tendon_that_hangs_slack_for_a_while():
    """By the product's own model: the independent rig stops where no tension is left."""
    t = np.arange(0.0, 12.0, 0.005)
    rig = ModelRig(0.135, TRUE.axial_stiffness, 1.45, TRUE.sheath_length_mm, math.pi, 27.0)
    response = simulate(rig, DriveInput(12.0 * np.sin(t) - 12.0))
    assert 0.05 < np.mean(response.phase == SLACK) < 0.5
    rng = np.random.default_rng(5)
    noise = {"x_in_mm": 0.005, "x_out_mm": 0.005, "f_in_N": 0.08, "f_out_N": 0.08}
    columns = {
        name: getattr(response, name) + sd * rng.standard_normal(t.size)
        for name, sd in noise.items()
    }
    is_right(calibrated(ran({"time_s": t, **columns})))


def test_a_fit_that_ends_at_a_bound_says_so():
    """Half of x_in is cut off, so that no spring fits: a stiffness runs away."""
    columns = recorded()
    result = calibrated(ran(columns | {"x_in_mm": np.minimum(columns["x_in_mm"], 15.0)}))
    at_bound = [e.name for e in result.model.estimates if e.at_bound]
    said = [s.split()[0] for s in result.cannot_tell if "converged to its plausible bound" in s]
    assert at_bound == said
    assert any("lacks an effect" in sentence for sentence in result.cannot_tell)


def test_a_run_begins_with_the_tension_that_was_measured():
    """Started at the top, the first samples are a dead band with a known side."""
    columns = part_of(recorded(sensors=at_rate(200.0)), 0.25, 1.0)
    answer = compare(ran(columns), calibrated(ran(columns)).model)
    assert answer.summary.rmse["f_in_N"] < 0.2


def test_what_the_fit_leaves_open_is_fixed_with_a_sentence():
    """With displacements of a thousand kilometres the zeros, bounded by a metre, are nothing."""
    columns = {n: v if n.startswith("t") else 1e9 * v for n, v in recorded().items()}
    result = calibrated(ran(columns))
    said = " ".join(result.cannot_tell)
    for name in ("x_in_zero_mm", "x_out_zero_mm"):
        assert name not in fitted(result)
        assert f"{name} is not identifiable from these recordings; it is fixed" in said


def test_where_a_fit_ends_with_every_parameter_at_a_bound_the_model_is_called_wrong():
    """A band around a drum, slack at one end: no friction is as large as what is measured."""
    time_s = np.arange(0.0, 8.0, 0.01)
    rng = np.random.default_rng(4)
    pull = 0.5 * (1.0 + np.tanh(6.0 * np.cos(np.pi * time_s)))
    columns = {
        "time_s": time_s,
        "x_in_mm": 5.0 * np.sin(np.pi * time_s) + 0.002 * rng.standard_normal(time_s.size),
        "f_in_N": 700.0 * pull - 30.0 + 2.0 * rng.standard_normal(time_s.size),
        "f_out_N": 600.0 * (1.0 - pull) - 30.0 + 2.0 * rng.standard_normal(time_s.size),
    }
    run = recorded_as(columns, preload_N=89.0, load="force")
    result = calibrated(run, **dict.fromkeys(DATA_SHEET))
    assert any("the nominal model lacks an effect" in note for note in result.cannot_tell)
