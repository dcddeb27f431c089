"""Lines between the two forces, read off forces that lie on such lines exactly, or nearly so."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.identification.phases import Segment
from tsas_cli.identification.transfer import tension_transfer, without_transfer

UP, DOWN = 1.5, 0.7  # f_in over f_out
C_UP, C_DOWN = 4.0, -1.0  # and what is added [N]
STROKE = 40


def run_of(run_id="a", *, bend=3.0, strokes=6, noise=0.0, seed=1, span=(20.0, 60.0)):
    """Return a run that slips in turns both ways; every stroke is one segment."""
    f_out, f_in, segments = [], [], []
    for k in range(strokes):
        up = k % 2 == 0
        force = np.linspace(*(span if up else span[::-1]), STROKE)
        f_out.append(force)
        f_in.append((UP if up else DOWN) * force + (C_UP if up else C_DOWN))
        phase = "contraction" if up else "loosening"
        segments.append(Segment(k * STROKE, (k + 1) * STROKE, phase))
    rng = np.random.default_rng(seed)
    channels = {
        "f_in_N": np.concatenate(f_in) + noise * rng.standard_normal(strokes * STROKE),
        "f_out_N": np.concatenate(f_out),
    }
    run = SimpleNamespace(
        run=SimpleNamespace(id=run_id, total_bend_rad=bend),
        channel=channels.get,
        noise={"f_out_N": 0.1},
        channels=channels,
    )
    return run, segments


def told(*runs):
    found = tension_transfer([r for r, _ in runs], [s for _, s in runs])
    return {(e.name, e.run): e for e in found}


def test_exact_lines_are_found_and_what_follows_from_them():
    found = {name: e.value for (name, _), e in told(run_of()).items()}
    assert found == pytest.approx(
        {
            "ratio_contraction": UP,
            "ratio_loosening": DOWN,
            "intercept_contraction": C_UP,
            "intercept_loosening": C_DOWN,
            "wrap": 0.5 * math.log(UP / DOWN),
            "constant_friction": 2.5,  # half of 4 − (−1)
            "offset": 1.5,  # half of 4 + (−1)
        }
    )


def test_bends_are_told_apart_and_runs_of_one_bend_together():
    found = told(run_of("a"), run_of("b"), run_of("c", bend=1.5))
    assert {run for _, run in found} == {"a, b", "c"}


def test_gaps_are_left_out():
    run, segments = run_of()
    run.channels["f_in_N"][45:60] = np.nan
    run.channels["f_out_N"][100:110] = np.nan
    found = {name: e.value for (name, _), e in told((run, segments)).items()}
    assert found["wrap"] == pytest.approx(0.5 * math.log(UP / DOWN))


def test_what_does_not_tell_it():
    run, segments = run_of()
    assert told((run, segments[::2])) == {}  # one direction alone
    assert told((run, segments[:3])) == {}  # a single stroke down


@pytest.mark.parametrize("factors", [(-1.0, -1.0), (1.0, -1.0), (0.0, 0.0)])
def test_a_ratio_that_is_not_positive_is_no_capstan(factors):
    run, segments = run_of()
    for k, s in enumerate(segments):
        run.channels["f_in_N"][s.first : s.end] *= factors[k % 2]
    assert told((run, segments)) == {}


def left_out(force, pulled, size):
    """Return the covariance of a line from refits, each without one block of neighbours."""
    J = np.column_stack((force, np.ones(force.size)))
    fits = []
    for first in range(0, force.size, size):
        rest = np.ones(force.size, dtype=bool)
        rest[first : first + size] = False
        fits.append(np.linalg.lstsq(J[rest], pulled[rest], rcond=None)[0])
    apart = np.array(fits) - np.mean(fits, axis=0)
    return (len(fits) - 1) / len(fits) * apart.T @ apart


def noisy_one_way(amplitudes):
    """Return a run whose f_in is off by turns up and down: no memory, so blocks of four samples."""
    run, segments = run_of()
    off = np.where(np.arange(STROKE) % 2 == 0, 1.0, -1.0) * np.linspace(0.5, 1.5, STROKE)
    for k, s in enumerate(segments):
        run.channels["f_in_N"][s.first : s.end] += amplitudes[k % 2] * (1.0 + 0.2 * k) * off
    return run, segments


@pytest.mark.parametrize("amplitudes", [(0.3, 0.0), (0.0, 0.2), (0.3, 0.2)])
def test_each_direction_has_the_error_of_its_own_line(amplitudes):
    """Both by leaving out blocks of four, strokes apart; what follows has both in quadrature."""
    run, segments = noisy_one_way(amplitudes)
    variances, ratios = [], []
    for way in range(2):
        parts = [np.arange(s.first, s.end) for s in segments[way::2]]
        force, pulled = (
            np.concatenate([run.channels[name][part] for part in parts])
            for name in ("f_out_N", "f_in_N")
        )
        variances.append(np.diag(left_out(force, pulled, 4)))
        ratios.append(np.polyfit(force, pulled, 1)[0])
    found = {name: e for (name, _), e in told((run, segments)).items()}
    both = 0.5 * math.sqrt(variances[0][1] + variances[1][1])
    parts = [math.sqrt(v[0]) / r for v, r in zip(variances, ratios, strict=True)]
    expected = {
        "ratio_contraction": math.sqrt(variances[0][0]),
        "ratio_loosening": math.sqrt(variances[1][0]),
        "intercept_contraction": math.sqrt(variances[0][1]),
        "intercept_loosening": math.sqrt(variances[1][1]),
        "wrap": 0.5 * math.hypot(*parts),
        "constant_friction": both,
        "offset": both,
    }
    for name, error in expected.items():
        assert found[name].stderr == pytest.approx(error, rel=1e-6, abs=1e-9), name
    units = {name: e.unit for name, e in found.items()}
    without = {name for name, unit in units.items() if unit == "1"}
    assert without == {"ratio_contraction", "ratio_loosening", "wrap"}
    assert {units[name] for name in set(units) - without} == {"N"}


def test_all_intervals_take_the_larger_t_of_both_directions():
    run, segments = noisy_one_way((0.3, 0.2))
    run.channels["f_in_N"][40:44] += 5.0  # one block carries most of what the way down tells
    found = told((run, segments)).values()
    t = {round((e.interval_high - e.value) / e.stderr, 9) for e in found}
    assert t == {round((e.value - e.interval_low) / e.stderr, 9) for e in found}
    (one,) = t
    swapped = [
        Segment(s.first, s.end, "loosening" if s.phase == "contraction" else "contraction")
        for s in segments
    ]
    (other,) = {
        round((e.interval_high - e.value) / e.stderr, 9) for e in told((run, swapped)).values()
    }
    assert one == other > 2.5  # many even blocks would have 2.0


def test_how_much_is_enough():
    """Two strokes, 50 samples and a range of ten times the noise, each of them just so."""
    for sizes, enough in (((24, 25), False), ((25, 25), True)):
        run, segments = run_of(strokes=4)
        cut = [Segment(s.first, s.first + sizes[k // 2], s.phase) for k, s in enumerate(segments)]
        assert bool(told((run, cut))) == enough
    assert told(run_of(span=(20.0, 21.0))) != {}  # ten times 0.1, to the last bit
    assert told(run_of(span=(20.0, 20.95))) == {}
    constant, segments = run_of(span=(20.0, 20.0))
    constant.noise.clear()
    assert told((constant, segments)) == {}
    unknown, segments = run_of(span=(20.0, 20.1))
    unknown.noise.clear()
    assert told((unknown, segments)) != {}


def test_the_noisier_of_two_runs_says_what_is_wide():
    for noises in ((1.0, 5.0), (5.0, 1.0)):
        runs = [run_of("a"), run_of("b")]  # a range of 40 N
        for (run, _), noise in zip(runs, noises, strict=True):
            run.noise["f_out_N"] = noise
        assert told(*runs) == {}


def test_a_run_without_both_forces_is_passed_over():
    for gone in ("f_in_N", "f_out_N"):
        without, segments = run_of("b")
        del without.channels[gone]
        found = told((without, segments), run_of("a"))
        assert {name for name, _ in found} >= {"wrap", "offset"}
    without, segments = run_of("b")
    without.channels["f_in_N"][:] = np.nan
    assert told((without, segments)) == {}


def test_a_run_that_shows_no_transfer_is_named_and_one_without_both_forces_is_not():
    short, long, one_end = run_of("b", bend=2.0, strokes=1), run_of("a"), run_of("c")
    del one_end[0].channels["f_out_N"]
    runs, segments = zip(short, long, one_end, strict=True)
    found = tension_transfer(runs, segments)
    (sentence,) = without_transfer(runs, found)
    assert sentence.startswith("The tension passed on is not fitted in b: ")
    assert list(without_transfer([long[0]], found)) == []


def test_one_stroke_each_way_is_too_few_however_long_it_is():
    """Its samples are of one kind: nothing says how far the next stroke's would be from them."""
    run, _ = run_of(strokes=4)
    swapped = np.r_[0:40, 80:120, 40:80, 120:160]  # up, up, down, down: 80 samples in a row
    for values in run.channels.values():
        values[:] = values[swapped]
    one_each = [Segment(0, 80, "contraction"), Segment(80, 160, "loosening")]
    assert told((run, one_each)) == {}
    up = [Segment(0, 40, "contraction"), Segment(40, 80, "contraction")]
    down = [Segment(80, 120, "loosening"), Segment(120, 160, "loosening")]
    assert told((run, [*up, one_each[1]])) == {}
    assert told((run, [one_each[0], *down])) == {}
    assert told((run, [*up, *down])) != {}
