"""Each fault, put into a good recording, is found by its own check and by no other."""

import numpy as np
import pytest

from tests.recordings.quality.bench import Bench, columns, remarks, trial
from tsas_cli.recordings.quality import RUN_CHECKS
from tsas_cli.recordings.quality.finding import NotChecked

GOOD = columns(Bench())
TIME = GOOD["time_s"]
N = TIME.size


def found(measured, code, column=None, load="spring"):
    """Return the only remark; fail if another check reports one too."""
    results = remarks(measured, load=load)
    assert {found_code for found_code, _ in results} == {code}
    if column is not None:
        assert {remark.column for _, remark in results} == {column}
    return results[0][1]


def codes(measured):
    return {code for code, _ in remarks(measured)}


def test_a_force_that_falls_with_the_speed_before_a_reversal_is_not_clipped():
    quiet = columns(Bench(noise_mm=0.0))
    speed = np.gradient(quiet["x_in_mm"], quiet["time_s"])
    noisy = columns(Bench(noise_N=0.3))
    assert codes(noisy | {"f_in_N": noisy["f_in_N"] + 0.4 * speed}) == set()


def changed(**columns_by_name):
    return GOOD | columns_by_name


def kept(rows):
    return {name: values[rows] for name, values in GOOD.items()}


def repeated(rows):
    """Return the recording with the channels of other rows, at its own time."""
    return {name: v if name == "time_s" else v[rows] for name, v in GOOD.items()}


def frozen_from(values, row):
    return np.where(np.arange(N) < row, values, values[row])


def with_gaps():
    values = GOOD["x_out_mm"].copy()
    values[1000:1013] = values[2000] = np.nan
    return changed(x_out_mm=values)


ROWS = np.arange(N)
SET_BACK = TIME - np.where(ROWS > 1000, 0.05, 0.0)
LATE = TIME + 0.03 * np.random.default_rng(1).standard_normal(N)
ERROR = {"severity": "error"}
CHANNELS = ("x_in_mm", "x_out_mm", "f_in_N", "f_out_N")
CLIPPED = [
    ("f_out_N", None, 45.0),
    ("f_in_N", None, 60.0),
    ("f_in_N", 25.0, None),
    ("x_out_mm", None, 17.0),
    ("x_in_mm", None, 18.0),
]
DEAD = {"f_in_N": 0.08, "f_out_N": 1e-4, "x_out_mm": 0.01}  # and their noise
ENCODER = columns(Bench(noise_mm=0.0, step_mm=0.02))
POUNDS = {name: GOOD[name] / 4.448 for name in ("f_in_N", "f_out_N")}


@pytest.mark.parametrize(
    ("measured", "code", "says", "wanted"),
    [
        (changed(time_s=SET_BACK), "time-order",
         "1 of 3200 rows, first at row 1001 (5 s, then 4.955 s)", ERROR | {"column": "time_s"}),
        (changed(time_s=np.floor(TIME / 0.0037) * 0.0037), "time-jitter", "", {}),
        # Half the stamps follow the one before at once: the median interval says nothing.
        (changed(time_s=np.maximum.accumulate(LATE) + 1e-6 * ROWS), "time-jitter", "", {}),
        (columns(Bench(amplitude_mm=0.05, noise_mm=0.001, noise_N=0.02)), "no-steady-motion",
         "no steady contraction", {}),
        (kept(np.r_[0:900, 950:N]), "gap", "1 place; the longest gap is 0.255 s at 4.495 s",
         {"column": "time_s", "first_s": pytest.approx(4.495)}),
        (with_gaps(), "gap", "14 of 3200 rows, at 2 places; the longest has 13 rows at 5 s",
         {"column": "x_out_mm"}),
        (changed(f_out_N=np.full(N, np.nan)), "gap", "", ERROR | {"column": "f_out_N"}),
        # Sample and hold, and a link that is down for a while.
        (repeated(np.where((ROWS >= 500) & (ROWS < 1500), ROWS - ROWS % 2, ROWS)),
         "repeated-rows", "500 of 3200 rows", {}),
        (repeated(np.where((ROWS >= 700) & (ROWS < 760), 700, ROWS)),
         "repeated-rows", "59 of 3200", {"first_s": pytest.approx(701 * 0.005)}),
        (changed(f_out_N=np.full(N, 30.0)), "stuck", "", {"column": "f_out_N"}),
        *((changed(**{name: 30.0 + noise * np.random.default_rng(3).standard_normal(N)}), "stuck",
           "shows its noise alone", ERROR | {"column": name}) for name, noise in DEAD.items()),
        (changed(f_in_N=GOOD["f_in_N"] - 25.0), "negative-tension", "", {"column": "f_in_N"}),
        (GOOD | POUNDS, "unit", "", {"column": "f_out_N"}),  # against the data sheet
        (kept(slice(800)), "few-reversals", "", {"column": "x_in_mm"}),
        (kept(slice(1100)), "few-reversals", "", {"column": "x_in_mm"}),
        (columns(Bench(amplitude_mm=0.0)), "few-reversals", "does not move visibly", {}),
        *((changed(**{name: np.clip(GOOD[name], low, high)}), "clipped", f"{low or high:g}",
           {"column": name}) for name, low, high in CLIPPED),
        *((changed(**{name: frozen_from(GOOD[name], 1700)}), "stuck", "",
           {"column": name, "first_s": pytest.approx(8.5)}) for name in CHANNELS),
        (ENCODER | {"x_out_mm": frozen_from(ENCODER["x_out_mm"], 1700)}, "stuck", "",
         {"column": "x_out_mm"}),
        *((changed(**{name: np.round(GOOD[name] / step) * step}), "quantised",
           f"steps of {step:g} {unit}", {"column": name, "severity": "warning"})
          for name, step, unit in [("x_out_mm", 0.5, "mm"), ("f_in_N", 2.0, "N")]),
        *((changed(**{name: -GOOD[name]}), "sign", "", ERROR | {"column": name})
          for name in CHANNELS),
    ],
)  # fmt: skip
def test_a_fault_is_found_by_its_own_check(measured, code, says, wanted):
    remark = found(measured, code, wanted.get("column"))
    assert says in remark.sentence
    assert {name: getattr(remark, name) for name in wanted} == wanted


def with_load_friction():
    place = np.convolve(GOOD["x_out_mm"], np.ones(25) / 25, mode="same")
    return changed(f_out_N=GOOD["f_out_N"] + np.sign(np.gradient(place)))


@pytest.mark.parametrize(
    ("measured", "load"),
    [
        (GOOD, "spring"),
        (ENCODER, "spring"),
        *(
            (changed(f_in_N=gain * GOOD["f_in_N"] + offset), "spring")
            for gain in (0.95, 1.05)
            for offset in (-5.0, 5.0)
        ),
        (with_load_friction(), "spring"),
        (changed(f_out_N=GOOD["f_out_N"] + 0.01 * GOOD["x_out_mm"] ** 2), "spring"),  # a curved one
        (columns(Bench(amplitude_mm=1.0, noise_mm=0.001, noise_N=0.02)), "spring"),
        # A spring that is a little off its data sheet:
        (changed(**{name: 1.2 * GOOD[name] for name in ("f_in_N", "f_out_N")}), "spring"),
        (columns(Bench(load="displacement", noise_mm=0.0)), "displacement"),  # held, and not stuck
    ],
)
def test_what_is_no_fault_is_left_in_peace(measured, load):
    assert remarks(measured, load=load) == []


def test_jitter_tells_its_size():
    noise = 0.1 * 0.005 * np.random.default_rng(1).standard_normal(N)
    remark = found(changed(time_s=TIME + noise), "time-jitter")
    assert 13.0 < float(remark.sentence.split("by ")[1].split(" %")[0]) < 15.5  # 10 % · √2


def test_rows_of_a_quiet_coarse_recording_may_repeat():
    measured = columns(Bench(noise_mm=0.0, noise_N=0.0, step_mm=0.01, step_N=0.1, rate_Hz=2000.0))
    subject = trial(measured)
    (check,) = (check for check in RUN_CHECKS if check.code == "repeated-rows")
    assert [type(remark) for remark in check.find(subject)] == [NotChecked]


@pytest.mark.parametrize("column", ["x_in_mm", "f_in_N"])
@pytest.mark.parametrize("rows", [2, 10, 50])
@pytest.mark.parametrize("step", [0.0, 0.01])
def test_a_channel_that_is_updated_slowly(column, rows, step):
    measured = columns(Bench(rate_Hz=1000.0, step_mm=step, step_N=5.0 * step))
    slow = measured[column][np.arange(measured[column].size) // rows * rows]
    remark = found(measured | {column: slow}, "slow-channel", column)
    assert f"every {rows} rows" in remark.sentence


@pytest.mark.parametrize("load", ["spring", "force"])
def test_exchanged_tension_sensors(load):
    measured = columns(Bench(load=load))
    swapped = measured | {"f_in_N": measured["f_out_N"], "f_out_N": measured["f_in_N"]}
    found(swapped, "exchanged", load=load)


OF_BOTH_ENDS = {
    "x_in_mm": GOOD["x_out_mm"],
    "x_out_mm": GOOD["x_in_mm"],
    "f_in_N": GOOD["f_out_N"],
    "f_out_N": GOOD["f_in_N"],
}


@pytest.mark.parametrize("names", [("x_in_mm", "x_out_mm"), tuple(OF_BOTH_ENDS)])
def test_exchanged_displacements_are_told_from_a_sensor_that_is_late(names):
    swapped = remarks(GOOD | {name: OF_BOTH_ENDS[name] for name in names})
    assert "x_in_mm" in {remark.column for code, remark in swapped if code == "exchanged"}
    late = GOOD | {"x_in_mm": np.interp(TIME - 0.02, TIME, GOOD["x_in_mm"])}
    assert "exchanged" not in codes(late)


@pytest.mark.parametrize(
    ("column", "factor", "unit"),
    [
        ("x_out_mm", 25.4, "inch"),
        ("x_out_mm", 10.0, "centimetre"),
        ("x_out_mm", 1000.0, "metre"),
        ("x_in_mm", 25.4, "inch"),
        ("x_in_mm", 10.0, "centimetre"),
        ("f_in_N", 4.448, "pound-force"),
        ("f_in_N", 9.807, "kilogram-force"),
        ("f_out_N", 4.448, "pound-force"),
        ("f_out_N", 9.807, "kilogram-force"),
        ("f_out_N", 1000.0, "kilonewton"),
        ("time_s", 1e-3, "millisecond"),
        ("time_s", 1e-6, "microsecond"),
        ("time_s", 1e3, "seconds taken for milliseconds"),
        ("time_s", 1e6, "seconds taken for microseconds"),
    ],
)
def test_a_unit_off_by_a_round_factor_is_named(column, factor, unit):
    remark = found(changed(**{column: GOOD[column] / factor}), "unit", column)
    assert remark.sentence.endswith(unit) or f"{unit}, or " in remark.sentence


@pytest.mark.parametrize(("factor", "told"), [(1e7, True), (1e-7, True), (6.0, True), (2.0, False)])
def test_tensions_that_differ_by_more_than_any_friction_are_told(factor, told):
    """Friction cancels in the mean of both directions: what is left is a gain or a unit."""
    measured = changed(f_in_N=factor * GOOD["f_in_N"], time_s=TIME)
    apart = [r for _, r in remarks(measured) if r.sentence.endswith("in which friction cancels")]
    assert bool(apart) == told
    assert all(r.severity == "warning" and "f_in_N and f_out_N" in r.remedy for r in apart)


@pytest.mark.parametrize("time_s", [TIME[::-1], np.zeros(N)])
def test_of_a_clock_that_does_not_increase_no_unit_is_said(time_s):
    of_time = {code for code, r in remarks(changed(time_s=time_s)) if r.column == "time_s"}
    assert of_time == {"time-order"}


def test_a_room_in_kelvin_is_named():
    kelvin = changed(temperature_C=np.linspace(294.9, 295.4, N))
    assert found(kelvin, "unit", "temperature_C").sentence.endswith("looks like kelvin")
    assert codes(changed(temperature_C=np.linspace(60.0, 199.0, N))) == set()


def test_a_channel_that_is_a_copy_of_another_one_is_named():
    results = dict(remarks(changed(f_in_N=GOOD["f_out_N"])))
    assert "f_out_N is a copy of f_in_N" in results["duplicate-channel"].sentence
    rest = GOOD["f_out_N"] + np.random.default_rng(1).normal(0.0, 1e-3, N)
    assert "duplicate-channel" not in codes(changed(f_in_N=rest))


def test_a_load_that_travels_further_than_its_drive_has_a_wrong_scale():
    far = found(changed(x_out_mm=3.0 * GOOD["x_out_mm"]), "unit")
    assert far.severity == "warning"
    assert "times as far as x_in_mm" in far.sentence
    factor = float(far.sentence.split("moves ")[1].split(" ")[0])
    assert 2.0 < factor <= 3.0


@pytest.mark.parametrize("shift_s", [-0.02, 0.005, 0.02])
def test_a_delay_is_reported_with_an_interval_that_holds_it(shift_s):
    late = np.interp(TIME - shift_s, TIME, GOOD["f_out_N"])
    sentence = found(changed(f_out_N=late), "delay", "f_out_N").sentence
    assert sentence.endswith("after x_out_mm" if shift_s > 0 else "before x_out_mm")
    low, high = sentence.split("95 %: ")[1].split(")")[0].split(" to ")
    assert float(low) - 0.1 <= 1e3 * abs(shift_s) <= float(high) + 0.1


@pytest.mark.parametrize("factor", [0.3, 0.6, 1.6])
def test_a_factor_of_both_forces_contradicts_the_stated_spring(factor):
    forces = {name: factor * GOOD[name] for name in ("f_in_N", "f_out_N")}
    remark = found(changed(**forces), "unit")
    assert remark.severity == "warning"
    assert f"is {factor:.2g}" in remark.sentence
    assert "times load_stiffness_N_per_mm" in remark.sentence
    assert "unit and gain of f_out_N and x_out_mm" in remark.remedy


FAULTS = {
    "stuck": changed(x_out_mm=frozen_from(GOOD["x_out_mm"], 1700)),
    "clipped": changed(x_in_mm=np.minimum(GOOD["x_in_mm"], 18.0)),
    "late": changed(f_out_N=np.interp(TIME - 0.02, TIME, GOOD["f_out_N"])),
    "exchanged": changed(f_in_N=GOOD["f_out_N"], f_out_N=GOOD["f_in_N"]),
    "wrong sign": changed(x_in_mm=-GOOD["x_in_mm"]),
    "coarse": changed(x_out_mm=np.round(GOOD["x_out_mm"] / 0.5) * 0.5),
    "jump": changed(x_in_mm=GOOD["x_in_mm"] + 3.0 * (ROWS > 1234)),
    "buffer": repeated(np.concatenate((ROWS[:1020], ROWS[1000:]))[:N]),
    "lost": repeated(np.concatenate((ROWS[:700], ROWS[712:], ROWS[-12:]))),
    "gap": with_gaps(),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_zeros_of_time_and_of_displacements_change_no_finding(fault):
    """Nor does the length of a run's clock: all but the numbers in the sentences is the same."""
    measured = FAULTS[fault]
    zeros = {"time_s": 300.0, "x_in_mm": -40.0, "x_out_mm": -9.0}
    moved = {name: values + zeros.get(name, 0.0) for name, values in measured.items()}
    ours, theirs = (
        [(code, f.severity, f.column, f.first_s and f.first_s - start) for code, f in found]
        for found, start in ((remarks(measured), 0.0), (remarks(moved), 300.0))
    )
    assert [f[:3] for f in theirs] == [f[:3] for f in ours] != []
    assert [f[3] or 0.0 for f in theirs] == pytest.approx([f[3] or 0.0 for f in ours], abs=1e-6)
