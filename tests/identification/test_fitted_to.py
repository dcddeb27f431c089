"""Which runs lie in the range that a model was fitted to: made cases of the independent rig."""

import math
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.identification.fitted_to import FittedTo, _speeds, departures, fitted_to, not_stated
from tsas_cli.identification.prepared import prepare
from tsas_cli.recordings.manifest import RigSheet, Run
from tsas_cli.recordings.recording import Recording
from tsas_studies.challenge.rig.motions import sine
from tsas_studies.challenge.rig.recordings import conditions
from tsas_studies.challenge.rig.sensors import Sensors, measure
from tsas_studies.challenge.rig.tendon import Rig, simulate

BASE = Rig(cells=25)
SHEET = RigSheet(tendon_diameter_mm=1.2)


@cache
def clean(rig, amplitude_mm, omega_rad_s):
    return simulate(rig, sine(amplitude_mm, omega_rad_s, rate_Hz=50.0))


def entry(**told):
    return Run(id="r", file="r", sha256="0" * 64, **told)


@cache
def prepared(rig, amplitude_mm, omega_rad_s, seed):
    columns = measure(clean(rig, amplitude_mm, omega_rad_s), Sensors(rate_Hz=100.0), seed=seed)
    return prepare(Recording(entry(), columns))


def run(rig=BASE, amplitude_mm=10.0, omega_rad_s=1.0, *, seed=1, stated=True, **further):
    """Return a recorded run, whose conditions are stated or not."""
    told = conditions(rig) if stated else {}
    made = prepared(rig, amplitude_mm, omega_rad_s, seed)
    return replace(made, run=entry(**told, **further))


def bent(factor):
    return replace(BASE, total_bend_rad=factor * math.pi)


FITS = {
    "one run": [{}],
    "two speeds": [{}, {"omega_rad_s": 2.0}],
    "two bends": [{}, {"rig": bent(0.6)}],
    "two strokes": [{}, {"amplitude_mm": 6.0}],
}
# Another load, bend, speed or stroke than in any of `FITS`.
OTHERS = [
    *({"rig": bent(factor)} for factor in (0.3, 1.3, 1.8)),
    *({"rig": replace(BASE, load_stiffness_N_per_mm=1.579 * f)} for f in (0.5, 1.5, 2.5)),
    *({"rig": replace(BASE, preload_N=25.0 * factor)} for factor in (0.6, 1.6, 2.5)),
    *({"omega_rad_s": omega} for omega in (0.3, 0.6, 3.0, 5.0)),
    *({"amplitude_mm": amplitude} for amplitude in (3.0, 4.5, 13.0, 20.0)),
]
BETWEEN = {
    "two speeds": {"omega_rad_s": 1.5},
    "two bends": {"rig": bent(0.8)},
    "two strokes": {"amplitude_mm": 8.0},
}


@pytest.mark.parametrize("stated", [True, False])
def test_nine_of_ten_made_cases_are_told_inside_or_outside_as_they_were_made(stated):
    """Where no condition is stated, another bend or load shows in the forces alone."""
    wrong, count = [], 0
    others = [fitted_to(SHEET, [run(**case, seed=21, stated=stated)]) for case in OTHERS]
    for name, fit in FITS.items():
        fitted = fitted_to(SHEET, [run(**one, seed=k, stated=stated) for k, one in enumerate(fit)])
        same = [(one, seed) for one in fit for seed in (11, 12)]
        same += [({"amplitude_mm": 10.0 * f, "omega_rad_s": 1.0 / f}, 13) for f in (0.97, 1.03)]
        same += [(BETWEEN[name], 14)] if name in BETWEEN else []
        alike = [fitted_to(SHEET, [run(**case, seed=k, stated=stated)]) for case, k in same]
        for cases, ranges, outside in ((same, alike, False), (OTHERS, others, True)):
            told = [bool(departures(here, fitted)) for here in ranges]
            wrong += [(name, cases[k]) for k, found in enumerate(told) if found != outside]
            count += len(cases)
    assert count > 90
    assert len(wrong) <= 0.1 * count, wrong


@pytest.mark.parametrize(
    ("case", "quantity"),
    [
        ({"omega_rad_s": 2.0}, "speed_mm_per_s"),
        ({"omega_rad_s": 0.5}, "speed_mm_per_s"),
        ({"amplitude_mm": 5.0, "omega_rad_s": 2.0}, "stroke_mm"),
        ({"rig": bent(0.5)}, "total_bend_rad"),
        ({"rig": replace(BASE, preload_N=60.0)}, "preload_N"),
        ({"rig": replace(BASE, load_stiffness_N_per_mm=4.0)}, "f_out_N"),
        ({"temperature_C": 35.0}, "temperature_C"),
        ({"wrist_deg": 45.0}, "wrist_deg"),
        ({"tool": "needle driver"}, "tool"),
    ],
)
def test_what_leaves_the_range_is_said(case, quantity):
    base = {"temperature_C": 22.0, "wrist_deg": 0.0, "tool": "grasper", "take": 1}
    fitted = fitted_to(SHEET, [run(**base)])
    here = fitted_to(SHEET, [run(**base | {"take": 7, "seed": 2} | case)])
    assert quantity in [one.quantity for one in departures(here, fitted)]
    assert departures(fitted_to(SHEET, [run(**base | {"take": 7, "seed": 2})]), fitted) == []


def test_a_range_is_left_by_more_than_a_tenth_of_its_width_or_end():
    fitted = FittedTo(ranges={"a_N": (10.0, 30.0), "b_N": (5.0, 5.0), "c_deg": (0.0, 0.0)})
    for name, inside, outside in (
        ("a_N", 32.9, 33.1),  # a tenth of the end is more than of the width
        ("a_N", 8.1, 7.9),  # a tenth of the width is more than of the end
        ("b_N", 5.4, 4.4),
        ("c_deg", 0.0, 0.1),
    ):
        assert departures(FittedTo(ranges={name: (inside, inside)}), fitted) == []
        assert departures(FittedTo(ranges={name: (outside, outside)}), fitted)
    unknown = {"d_N": (1e9, 1e9)}
    assert departures(FittedTo(ranges=unknown), fitted) == []
    assert departures(FittedTo(ranges=unknown | {"a_N": (99.0, 99.0)}), fitted)
    assert not_stated(FittedTo(ranges={"d_N": (0.0, 1.0), "a_N": (0.0, 1.0)}), fitted) == ["d_N"]


def test_a_word_that_no_run_of_the_fit_had_leaves_it():
    fitted = FittedTo(words={"tool": ("grasper", "hook")})
    for words, left in ((("hook",), []), (("hook", "grasper"), []), (("hook", "knife"), ["tool"])):
        here = FittedTo(words={"tool": words, "load": ("spring",)})
        assert [one.quantity for one in departures(here, fitted)] == left
        assert not_stated(here, fitted) == ["load"]


def test_the_ranges_of_runs_go_from_the_lowest_to_the_highest():
    both = fitted_to(SHEET, [run(), run(bent(0.5), omega_rad_s=3.0)])
    assert both.ranges["total_bend_rad"] == pytest.approx((math.pi / 2.0, math.pi))
    assert both.ranges["tendon_diameter_mm"] == (1.2, 1.2)
    # The 95th percentile of |sin| is sin(0.95·π/2).
    fastest = math.sin(0.95 * math.pi / 2.0)
    assert both.ranges["speed_mm_per_s"] == pytest.approx((10 * fastest, 30 * fastest), rel=0.02)
    assert both.ranges["stroke_mm"] == pytest.approx((20.0, 20.0), rel=1e-3)
    assert both.words == {"load": ("spring",)}


def test_a_label_of_single_runs_is_no_condition():
    runs = [run(tool=tool, operator=f"o{k}", made="2026-03-02") for k, tool in enumerate("aab")]
    assert fitted_to(SHEET, runs).words == {"load": ("spring",), "tool": ("a", "b")}


def test_a_number_that_is_no_condition_is_left_out():
    odd = {"take": 7, "wrist_deg": math.nan, "angle_deg": 10**400, "on_deg": True, "name_of_it": 3}
    assert not {*odd} & {*fitted_to(SHEET, [run(**odd)]).ranges}


def test_the_temperature_of_a_recording_is_a_condition():
    one = run()
    warm = Recording(one.run, {"time_s": one.time_s, "x_in_mm": one.conditioned["x_in_mm"].values,
                               **one.measured, "temperature_C": 20.0 + one.time_s})  # fmt: skip
    low, high = fitted_to(SHEET, [prepare(warm)]).ranges["temperature_C"]
    assert (low, high) == pytest.approx((20.0, 20.0 + one.time_s[-1]))


def test_the_speed_of_a_noisy_drive_is_that_of_its_motion():
    rng = np.random.default_rng(4)
    one = run()
    x = one.conditioned["x_in_mm"].values + rng.normal(0.0, 0.05, one.time_s.size)
    noisy = Recording(one.run, {"time_s": one.time_s, "x_in_mm": x, **one.measured})
    clean_speed, speed = (
        fitted_to(SHEET, [each]).ranges["speed_mm_per_s"][1] for each in (one, prepare(noisy))
    )
    assert speed == pytest.approx(clean_speed, rel=0.05)


@pytest.mark.parametrize(("reversals", "window_s"), [(2, 4.0), (6, 2.0), (0, 4.0)])
def test_a_speed_is_that_over_four_windows_or_a_tenth_of_a_stroke(reversals, window_s):
    """A step of 1 mm within 100 s is as fast as the window is short."""
    time_s = np.linspace(0.0, 100.0, 1001)
    x_in = SimpleNamespace(
        values=np.where(time_s > 50.0, 1.0, 0.0), reversals=np.zeros(reversals), window_s=1.0
    )
    speeds = _speeds(time_s, x_in)
    assert speeds.max() == pytest.approx(1.0 / window_s)
    assert np.mean(speeds > 0.5 / window_s) == pytest.approx(window_s / 100.0, rel=0.05)
    x_in.window_s, x_in.values = 0.0, -3.0 * time_s
    assert _speeds(time_s, x_in) == pytest.approx(np.full(1001, 3.0))
