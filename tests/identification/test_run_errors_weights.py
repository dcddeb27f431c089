"""How much each error counts, with a model so simple that it can be worked out by hand.

The tension at the drive is k times the drive, that at the load k times the load, and x_out is the
drive once more; the rig is k.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.identification import run_errors as r
from tsas_cli.identification import run_simulation as rs
from tsas_cli.physics.ends import DriveInput

X = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 4.0, 3.0, 2.0, 1.0, 0.0])
N = X.size
TURN_AT = np.array([0, 5, 10])
NOISE = {"f_in_N": 2.0, "f_out_N": 0.5}
LOAD = 7.0 * np.ones(N)
EVERY = np.arange(N)


class Model:
    """Answers of the simple model, and what it was asked."""

    def __init__(self):
        self.asked = []

    def __call__(self, rig, drive, dynamics, **how):
        self.asked.append((rig, drive, dynamics, how))
        load = drive.values if drive.load_values is None else drive.load_values
        return SimpleNamespace(
            f_in_N=rig * drive.values,
            f_out_N=rig * load,
            x_out_mm=drive.values,
            step_ends_s=np.array([0.25, 0.5]),
        )


def conditioned(values, sd, unseen=0.0):
    return SimpleNamespace(
        values=values,
        sd=np.full(N, sd),
        unseen=np.full(N, unseen),
        reversals=TURN_AT,
        window_s=0.3,
    )


def run_of(*, sd=0.1, unseen=0.0, load_sd=None):
    ends = {"x_in_mm": conditioned(X, sd, unseen)}
    if load_sd is not None:
        ends["f_out_N"] = conditioned(LOAD, load_sd)
    noise = {n: v for n, v in NOISE.items() if n not in ends}
    drive = DriveInput(
        values=X,
        load="spring" if load_sd is None else "force",
        load_values=None if load_sd is None else LOAD,
        start_f_in_N=3.0,
        time_s=0.1 * EVERY,
    )
    return SimpleNamespace(
        drive=drive,
        conditioned=ends,
        drive_column="x_in_mm",
        measured={n: np.zeros(N) for n in noise},
        noise=noise,
        time_s=0.1 * EVERY,
        step_tolerance=1e-5,
    )


@pytest.fixture
def model(monkeypatch):
    made = Model()
    monkeypatch.setattr(rs, "solve", made)
    monkeypatch.setattr(rs, "read", lambda rig, drive, solved: solved)
    monkeypatch.setattr(rs, "mechanics_of", lambda rig, drive: rig)
    monkeypatch.setattr(rs, "is_closed", lambda rig, drive: False)
    monkeypatch.setattr(rs, "points", lambda run: EVERY)
    monkeypatch.setattr(r, "reversed_at_rest", lambda conditioned, time_s: conditioned.values)
    return made


def errors_of(run, rig=3.0, dynamics="slip", samples=EVERY):
    return r.run_errors(run, dict.fromkeys(run.measured, samples), rig, dynamics)


def test_noise_and_what_moves_the_drive_count_by_their_squares(model):
    """k = 3: an error of 0.1 mm is 0.3 N, what was taken for noise, 0.2 mm, is 0.6 N."""
    found = errors_of(run_of(unseen=0.2))
    np.testing.assert_allclose(found.weights["f_in_N"], np.sqrt(4.0 + 0.09 + 0.36))
    np.testing.assert_allclose(found.weights["f_out_N"], np.sqrt(0.25 + 0.09 + 0.36))


def test_a_load_that_is_driven_has_its_own_error(model):
    """It moves f_out by k times 0.4 N and f_in by nothing; f_out is not compared then."""
    run = run_of(load_sd=0.4)
    run.conditioned["f_out_N"].unseen = np.full(N, 5.0)
    run.noise |= {"x_out_mm": 0.3, "f_out_N": 1.0}
    run.measured |= {"x_out_mm": np.zeros(N), "f_out_N": np.zeros(N)}
    found = errors_of(run)
    np.testing.assert_allclose(found.weights["f_in_N"], np.sqrt(4.0 + 0.09))
    np.testing.assert_allclose(found.weights["x_out_mm"], np.sqrt(0.09 + 0.01))
    np.testing.assert_allclose(found.weights["f_out_N"], np.sqrt(1.0 + 1.44 + 225.0))
    # The shape of a wrong turn is that of the drive's error, not of the load's.
    assert found.turns["f_in_N"].shape.any()
    assert not found.turns["f_out_N"].shape.any()


def test_a_channel_without_noise_has_next_to_none(model):
    run = run_of(sd=0.0)
    run.noise["f_in_N"] = 0.0
    np.testing.assert_allclose(errors_of(run).weights["f_in_N"], 1e-9)


LATER = np.arange(1, N)  # a fit never holds the first sample: nothing is forgotten there


def test_the_shape_of_a_wrong_turn_is_in_units_of_the_errors(model):
    """Of two strokes with five samples, all alike: c = ±0.3/√4.09, Σ c² is 5 c²."""
    turns = errors_of(run_of(), samples=LATER).turns["f_in_N"]
    assert turns.starts.tolist() == [0, 5]
    c = 0.3 / np.sqrt(4.09)
    size = np.sqrt((1.0 - 1.0 / np.sqrt(1.0 + 9.0 * 5 * c * c)) / 5)
    np.testing.assert_allclose(turns.shape, [size] * 5 + [-size] * 5)


def test_errors_are_simulated_less_measured_without_the_shape_of_a_wrong_turn(model):
    run = run_of()
    run.measured["f_in_N"] = 3.0 * X + 1.0
    found = errors_of(run, samples=LATER)
    expected = -np.ones(10) / np.sqrt(4.09)
    shape = found.turns["f_in_N"].shape
    for part in (slice(0, 5), slice(5, 10)):
        expected[part] -= shape[part] * (shape[part] @ expected[part])
    np.testing.assert_allclose(found.errors(3.0)["f_in_N"], expected)
    np.testing.assert_allclose(found.raw(3.0)["f_in_N"], 1.0)
    np.testing.assert_allclose(found.predict(2.0)["f_in_N"], 2.0 * X)


def test_between_samples_that_are_simulated_answers_are_straight(monkeypatch, model):
    """Simulated are 0, 4 and 10: at 2 half way from 0 to 4, at 7 half way from 4 to 0."""
    monkeypatch.setattr(rs, "points", lambda run: np.array([0, 4, 10]))
    run = run_of(load_sd=0.1)
    run.drive = DriveInput(values=X, load="force", load_values=2.0 * X, time_s=0.1 * EVERY)
    found = errors_of(run)
    answers = found.predict(3.0)
    np.testing.assert_allclose(answers["f_in_N"][[0, 2, 4, 7, 10]], [0.0, 6.0, 12.0, 6.0, 0.0])
    np.testing.assert_allclose(answers["f_out_N"][[2, 7]], [12.0, 12.0])
    np.testing.assert_allclose(answers["x_out_mm"][[2, 7]], [2.0, 2.0])
    drive = model.asked[0][1]
    assert drive.values.tolist() == [0.0, 4.0, 0.0]
    assert drive.load_values.tolist() == [0.0, 8.0, 0.0]
    assert drive.time_s == pytest.approx([0.0, 0.4, 1.0])
