"""What is left, on errors that are made of known signals."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.diagnosis import remainder as remainder_module
from tsas_cli.diagnosis.held_out import Folds
from tsas_cli.diagnosis.moments import _is_brief, _is_late, at_moments
from tsas_cli.diagnosis.remainder import Remainder, SlowPart, remainder
from tsas_cli.diagnosis.signals import signals_at_residuals

SIZE, ROWS = 800, 400
RANGE = 10.0  # of all readings, in units of noise
TIME_S = 0.05 * np.arange(SIZE)
X = 10.0 - 10.0 * np.cos(2.0 * np.pi * TIME_S / 10.0)
REVERSALS = np.array([0, *range(100, SIZE, 100), SIZE - 1])
SHORT_S = 5.0 + 0.02 * np.arange(ROWS)


class Run:
    """A run with errors at its samples, or at some of them."""

    def __init__(self, errors, time_s=TIME_S, x=X, reversals=REVERSALS, samples=None):
        drive = SimpleNamespace(
            values=x, reversals=reversals, step=0.002, sd=np.full(time_s.size, 1e-4), window_s=0.1
        )
        self.run = SimpleNamespace(
            time_s=time_s,
            drive_column="x_in_mm",
            conditioned={"x_in_mm": drive},
            channel={"x_in_mm": x}.get,
            measured={name: np.resize([-RANGE, RANGE], time_s.size) for name in errors},
            noise=dict.fromkeys(errors, 1.0),
        )
        everything = np.arange(time_s.size)
        self.samples = dict.fromkeys(errors, everything if samples is None else samples)
        self.weights = dict.fromkeys(errors, np.ones(time_s.size))
        self.given, self.f_in = errors, 7.0 * everything
        self.lags, self.delay_unit = np.array([0.1, -0.2, 0.1, 0.0]), 0.001

    @property
    def count(self):
        return sum(errors.size for errors in self.given.values())

    def errors(self, rig):
        return self.given

    def changed(self, changes):
        return np.concatenate([changes.get(n, 0.0 * e)[: e.size] for n, e in self.given.items()])

    def delays(self, rig):
        return dict.fromkeys(self.given, self.lags)

    def predict(self, rig):
        return {"f_in_N": self.f_in, "x_out_mm": np.zeros(self.f_in.size)}


def one_stroke(errors, time_s=SHORT_S, samples=None):
    """Return a run whose drive makes one stroke."""
    size = time_s.size
    return Run(errors, time_s, np.arange(float(size)), np.array([0, size - 1]), samples)


def bench_of(*runs):
    return SimpleNamespace(
        rigs=[None] * len(runs),
        rig=lambda trial, k: None,
        errors_for=lambda trial: runs,
        closed=runs,
        channels=sorted({name for run in runs for name in run.given}),
    )


def phrase(of, *runs):
    """Return what a function says of the errors of some runs."""
    return of(runs, [run.errors(None) for run in runs])


def left_of(*errors, made=Run):
    """Return what is left where a residual is the error of one sample."""
    bench = bench_of(*map(made, errors))
    residual = np.concatenate([np.concatenate(list(e.values())) for e in errors])
    block = np.arange(residual.size) // 40
    run = np.repeat(np.arange(len(errors)), [sum(e.size for e in one.values()) for one in errors])
    folds = Folds(block % 4, block, run, by_run=False)
    none = np.zeros((residual.size, 0))
    solution = SimpleNamespace(residual=residual, jacobian=none, at_bound=np.zeros(0, np.bool_))
    trial = SimpleNamespace(unknowns=[], solution=solution)
    return remainder(bench, trial, folds, signals_at_residuals(bench, trial), none)


def noise(seed):
    return np.random.default_rng(seed).standard_normal(SIZE)


def test_what_depends_on_the_place_is_said_to_and_could_be_had():
    """Of 1 + 9 ·½ squares the part over the place is explained, of one channel of two."""
    wave = 3.0 * np.sign(np.sin(0.9 * X))
    found = left_of(
        {"f_in_N": wave + noise(1), "x_out_mm": noise(2)},
        {"f_in_N": wave + noise(3), "x_out_mm": noise(4)},
    )
    assert found.depends_on[0] == "x_in_mm"
    assert found.mean_square == pytest.approx(0.5 * (10.0 + 1.0), rel=0.1)
    assert 5.0 < found.explained["f_in_N"] < 10.0
    assert found.explained["x_out_mm"] == 0.0


def test_noise_depends_on_nothing():
    found = left_of(*({"f_in_N": noise(k), "f_out_N": noise(10 + k)} for k in range(3)))
    assert found.depends_on == ()
    assert found.explained == {"f_in_N": 0.0, "f_out_N": 0.0}
    assert found.mean_square == pytest.approx(1.0, rel=0.1)
    assert (found.slow, found.structure) == ({}, 0.0)
    assert found.complete


@pytest.mark.parametrize(("size", "left"), [(0.25, 0.0), (0.5, 0.25)])
def test_what_is_below_the_linearity_of_a_sensor_is_no_structure(monkeypatch, size, left):
    """Two ten-thousandths of a range of 2000 are 0.4 of the noise."""
    monkeypatch.setattr(f"{__name__}.RANGE", 1000.0)
    wave = size * np.sign(np.sin(0.9 * X))
    found = left_of(*({"x_out_mm": wave + noise(k)} for k in range(6)))
    assert found.explained["x_out_mm"] == pytest.approx(left, abs=0.4 * left)
    assert found.complete == (left == 0.0)


@pytest.mark.parametrize(("most", "complete"), [(1000.0, True), (100.0, False)])
def test_zeros_of_the_runs_own_are_left_out_as_they_are_plausible(monkeypatch, most, complete):
    """As large as the noise, within two deviations of two thousandths of 1000, not of 100."""
    monkeypatch.setattr(f"{__name__}.RANGE", most)
    runs = Run({"f_in_N": 1.0 + noise(1)}, x=1.1 * X), Run({"f_in_N": noise(2) - 1.0}, x=0.3 * X)
    in_turn = iter(runs)
    found = left_of(*(run.given for run in runs), made=lambda errors: next(in_turn))
    assert found.complete == complete


def test_structure_is_not_complete():
    wave = np.sign(np.sin(0.9 * X))
    assert not left_of(*({"f_in_N": wave + noise(k)} for k in range(3))).complete


def slow_noise(seed, time_s):
    """Return first-order coloured noise of unit variance."""
    keep = np.exp(-0.05 / time_s)
    kicks = np.sqrt(1.0 - keep**2) * np.random.default_rng(seed).standard_normal(SIZE)
    values = np.zeros(SIZE)
    for i in range(1, SIZE):
        values[i] = keep * values[i - 1] + kicks[i]
    return values


def test_noise_that_follows_no_signal_is_slow_noise_and_complete():
    errors = [
        {"f_in_N": noise(k) + slow_noise(20 + k, 1.0), "x_out_mm": noise(k)} for k in (1, 2, 3)
    ]
    found = left_of(*errors)
    assert set(found.slow) == {"f_in_N"}
    assert found.slow["f_in_N"].ratio == pytest.approx(1.0, abs=0.15)
    assert found.slow["f_in_N"].time_s == pytest.approx(1.0, abs=0.4)
    assert found.complete


def test_an_error_far_above_the_noise_is_no_slow_noise():
    errors = [{"f_in_N": noise(k) + 2.5 * slow_noise(20 + k, 1.0)} for k in (1, 2, 3)]
    assert not left_of(*errors).complete


@pytest.mark.parametrize(
    ("delays", "late"),
    [
        ((3.0, 3.4, 2.8, 3.1), True),
        ((-3.0, -3.4, -2.8, -3.1), True),  # a lead
        ((9.0, -8.0, 9.0, -8.0), False),  # errors of reversals, one by one
        ((1.9, 1.95, 2.0, 1.95), False),
        ((2.1, 2.15, 2.2, 2.15), True),
        ((3.0, 3.4, 2.8), False),  # three strokes
        ((6.0 + 2.51, 6.0 - 2.51) * 2, True),  # four standard errors, and a little more,
        ((6.0 + 2.77, 6.0 - 2.77) * 2, False),  # or less
    ],
)
def test_strokes_that_all_lag_are_late(delays, late):
    assert _is_late(np.array(delays)) == late
    assert not Remainder(1.0, {}, (), late=("f_in_N",)).complete


@pytest.mark.parametrize(
    ("unit_mm", "late"), [(0.0019, ("f_in_N",)), (0.0022, ("f_in_N", "x_out_mm"))]
)
def test_a_displacement_is_late_by_more_than_a_contact_gives_way(unit_mm, late):
    """By three units: 5.7 µm are within the elastic travel, 6.6 µm are not."""
    run = Run({"f_in_N": noise(1), "x_out_mm": noise(2)})
    run.lags, run.delay_unit = np.array([3.0, 3.1, 3.0, 3.1]), unit_mm
    assert at_moments(bench_of(run), [run], [None])[0] == late


def test_a_place_over_which_the_error_repeats_is_said_once(monkeypatch):
    repeats = "x_in_mm (f_in_N repeats every 7 mm)"
    monkeypatch.setattr(remainder_module, "ripple", lambda runs, by_run: repeats)
    wave = 3.0 * np.sign(np.sin(0.9 * X))
    found = left_of({"f_in_N": wave + noise(1)}, {"f_in_N": wave + noise(3)})
    assert found.depends_on[0] == repeats
    assert "x_in_mm" not in found.depends_on


def test_an_error_that_swings_by_itself_is_periodic_at_its_frequency():
    """1.7 Hz: no signal of the run swings so fast."""
    swing = 4.0 * np.sin(2.0 * np.pi * 1.7 * TIME_S)
    found = left_of({"f_in_N": swing + noise(1)}, {"f_in_N": swing + noise(2)})
    assert found.depends_on[0] == "time_s (f_in_N oscillates at 1.7 Hz)"


@pytest.mark.parametrize(
    ("moment_s", "within_s", "weight", "brief"),
    [
        (20.0, 0.8, 1.0, True),  # noise of the drive does nothing there
        (0.4, 0.8, 1.0, False),  # a load may still remember what came before the run
        (20.0, 0.8, 1.05, False),  # 0.32 N by 0.1 µm: 9.6 N by a contact's 3 µm
        (20.0, 0.52, 1.05, False),  # within a window of 0.1 s of each sample
        (20.0, 0.08, 1.05, True),
    ],
)
def test_a_force_deviates_briefly_by_more_than_a_contacts_travel_does(
    moment_s, within_s, weight, brief
):
    from_moment_s = np.abs(TIME_S - moment_s)
    run = Run({"f_in_N": noise(1) + 8.0 * (from_moment_s < 0.6)})
    run.weights["f_in_N"] = np.where(from_moment_s < within_s, weight, 1.0)
    found = at_moments(bench_of(run), [run], [None])[1]
    assert found == (("f_in_N",) if brief else ())


def test_errors_at_a_few_moments_of_a_run_are_brief_and_noise_of_any_size_is_not():
    rng = np.random.default_rng(5)
    noise = rng.standard_normal(4000)
    slow = np.convolve(rng.standard_normal(4199), np.ones(200) / math.sqrt(200.0), "valid")
    few, some = noise.copy(), noise.copy()
    few[[70, 900, 901]] += 25.0
    some[300:330] += 9.0
    assert _is_brief(some)
    assert not _is_brief(np.where(np.arange(noise.size) % 3 == 0, noise, 0.0))  # mostly the same
    assert not any(map(_is_brief, (noise, 2.0 * noise, noise + slow, few)))
    mostly_less = np.where(np.arange(noise.size) % 25 < 13, 0.1, 1.6) * noise
    assert float(np.mean(mostly_less**2)) > 1.15
    assert not _is_brief(mostly_less)  # than the weights say


@pytest.mark.parametrize(
    ("rows", "far", "size", "brief"),
    [
        *((1000, 7, 12.0, False), (1000, 8, 12.0, True)),  # eight of them
        *((1000, 60, 3.9, False), (1000, 60, 4.1, True)),  # four deviations
        *((1000, 9, 4.05, False), (1000, 10, 4.05, True)),  # 0.15 of the squares
        *((5400, 8, 20.0, False), (5200, 8, 20.0, True)),  # one counts for ten deviations
    ],
)
def test_errors_are_brief_by_how_many_are_far_and_by_what_they_weigh(rows, far, size, brief):
    """Beside noise whose quartiles are those of one deviation; three tenths are 2.5 of them."""
    errors = 0.67449 * (-1.0) ** np.arange(rows)
    errors[: 3 * rows // 10] *= 2.5 / 0.67449
    errors[-far:] = size * np.sign(errors[-far:])
    assert _is_brief(errors) == brief
    assert not _is_brief(errors, least=20.1)  # all are within what every rig has
    assert _is_brief(errors, least=0.99 * size) == brief


@pytest.mark.parametrize(
    ("changed", "wanders"),
    [
        ({}, "f_in_N"),
        ({"slow": {"f_in_N": SlowPart(1.4, 1.0)}}, None),  # slow noise
        ({"explained": {"f_out_N": 0.06}}, None),
        ({"late": ("x_out_mm",)}, None),
        ({"depends_on": ("x_in_mm",)}, None),
        ({"slow": {"f_in_N": SlowPart(3.0, 0.1)}}, None),  # a burst, a catch
    ],
)
def test_a_channel_wanders_where_nothing_follows_a_signal(changed, wanders):
    slow = {"f_in_N": SlowPart(3.0, 1.0), "f_out_N": SlowPart(2.0, 1.0)}
    left = Remainder(9.0, {"f_in_N": 0.0}, (), slow=slow)
    assert replace(left, **changed).wanders == wanders


def test_a_signal_is_taken_in_the_middle_of_the_samples_of_each_mean():
    """Of 2500 samples three at a time make a mean: the second one of each, the last alone."""
    time_s = 0.01 * np.arange(2600)
    samples = np.arange(50, 2550)
    given = {"f_out_N": np.zeros(2500), "x_out_mm": np.zeros(2500)}
    found = signals_at_residuals(bench_of(one_stroke(given, time_s, samples)), None)
    signals, channel = found.signals, found.channel
    middle = np.minimum(np.arange(51, 2551, 3), 2549)
    assert middle.size == 834
    np.testing.assert_array_equal(signals["x_in_mm"], np.tile(middle, 2))
    np.testing.assert_array_equal(signals["f_in_N"], 7.0 * np.tile(middle, 2))
    np.testing.assert_array_equal(channel, np.repeat([0, 1], 834))


NOISE = np.random.default_rng(1).standard_normal((8, ROWS))


def test_what_is_explained_is_of_all_squares_of_the_channel_and_what_is_not_is_none():
    """Squares of 1 + 8, the latter a straight line over the place."""
    line = np.linspace(-1.0, 1.0, ROWS) * np.sqrt(3.0 * 8.0)
    found = left_of({"f_in_N": line + NOISE[0]}, {"f_in_N": line + NOISE[1]}, made=one_stroke)
    assert found.explained["f_in_N"] == pytest.approx(8.0, rel=0.05)
    assert found.mean_square == pytest.approx(9.0, rel=0.05)
    quiet = left_of({"f_in_N": 0.1 * NOISE[0]}, {"f_in_N": 0.1 * NOISE[1]}, made=one_stroke)
    assert quiet.explained == {"f_in_N": 0.0}
    assert quiet.mean_square == pytest.approx(0.01, rel=0.1)
