"""What is said of faults of recordings."""

from dataclasses import replace

import numpy as np
import pytest

from tsas_cli.diagnosis.faults.beside import Candidate
from tsas_cli.diagnosis.faults.words import differing, record_of, wandering
from tsas_cli.diagnosis.remainder import Remainder, SlowPart
from tsas_cli.recordings.manifest import Run

F, X = "f_out_N", "x_out_mm"


@pytest.mark.parametrize(
    ("bends_rad", "frictions", "falls"),
    [
        ((1.0, 2.0, 3.0, 4.0), (0.10, 0.01, -0.05, -0.06), True),
        ((1.0, 2.0, 3.0, 4.0), (-0.10, -0.01, 0.05, 0.06), False),
        ((1.0, 2.0, 3.0, 4.0), (0.06, -0.09, 0.07, -0.04), False),
        ((3.0, 3.1, 3.2, 3.3), (0.10, 0.01, -0.05, -0.06), False),
        ((1.0, 4.0), (0.10, -0.10), False),
        ((None, None, None), (0.10, 0.0, -0.10), False),
    ],
)
def test_friction_that_does_not_grow_with_the_bend_is_said(bends_rad, frictions, falls):
    runs = [
        Run(id=f"r{k}", file="a", sha256=64 * "0", total_bend_rad=bend)
        for k, bend in enumerate(bends_rad)
    ]
    said = differing(np.array(frictions), runs).sentence
    assert ("does not grow with the bend" in said) == falls
    assert ("state total_bend_rad of each run" in said) == (None in bends_rad)


@pytest.mark.parametrize(("of_last", "exchanged"), [(0.25, True), (0.5, False), (1.0, False)])
def test_two_bends_that_are_exchanged_are_said(of_last, exchanged):
    """Of 1 rad and 4 rad: the friction per radian is four times the usual one, and a quarter."""
    runs = [
        Run(id=f"r{k}", file="a", sha256=64 * "0", total_bend_rad=bend)
        for k, bend in enumerate((1.0, 2.0, 3.0, 4.0))
    ]
    frictions = np.array([4.0, 1.0, 1.0, of_last])
    said = differing(frictions / frictions.mean() - 1.0, runs).sentence
    assert ("with those of runs r0 and r3 exchanged it is the same" in said) == exchanged


@pytest.mark.parametrize(
    ("code", "channels", "amount", "between", "said"),
    [
        ("run-offset", (F,), -1.0, (), "f_out_N reads 1 N less than the other runs and channels"),
        ("run-offset", (F,), 0.2, (3, None), "N more than the other runs and channels fit since"),
        ("run-offset", (X,), 0.2, (None, 4), "channels fit until about 4 s"),
        ("run-offset", (X,), 0.2, (3, 4), "a clamp that slips, from about 3 to 4 s"),
        ("run-gain", (F,), 0.03, (), "f_out_N reads 3 % more than in the other runs"),
        ("run-delay", (F, X), -0.02, (), "f_out_N and x_out_mm come 20 ms earlier than the other"),
        ("run-delay", (X,), 0.02, (), "x_out_mm comes 20 ms later than the other channels"),
        ("clock", (X,), -0.003, (), "the clock of x_out_mm runs 0.3 % faster than that of the"),
        ("run-length", (), np.log(1.25), (), "its tendon is 1.25 times as stiff as in the other"),
        ("run-length", (), np.log(1.25), (), "sheath_length_mm were 0.8 times what is stated"),
        ("run-friction", (), np.log(0.5), (), "its friction is 0.5 times that of the other runs"),
        ("run-lag", (X,), 0.08, (), "x_out_mm lags, as behind a low pass of 80 ms"),
        ("lost-samples", (F,), -0.3, (7, None), "are lost: f_out_N comes 300 ms earlier than the"),
        ("repeated-buffer", (F,), 0.3, (7, None), "are repeated: f_out_N comes 300 ms later than"),
        ("ac-coupled", (F,), 5.55, (), "f_out_N loses its constant part within about 5.5 s, as"),
        ("saturates", (F,), 46.0, (), "reads less than it should beyond about 46 N, as a sensor"),
        ("hum", (F,), 1.5, (), "f_out_N swings at 1.5 Hz in all runs, whatever the motion"),
    ],
)
def test_a_fault_is_said_with_its_size_its_sign_and_its_time(code, channels, amount, between, said):
    found = Candidate(code, 1, channels, amount, 9.0, 1, *between)
    record, of_all = (record_of([c], ["a", "b"]) for c in (found, replace(found, run=None)))
    assert said in record.sentence
    assert record.sentence == f"run b: {of_all.sentence}"
    assert (record.run, record.column) == ("b", channels[0] if channels else None)


def test_what_wanders_is_said_with_its_size_and_its_memory():
    slow = {F: SlowPart(3.0, 1.25), X: SlowPart(2.0, 0.5)}
    found = wandering(Remainder(9.0, {}, (), slow=slow))
    assert found.column == F
    assert "f_out_N wanders by 3 times its noise within 1.2 s and follows no" in found.sentence
    assert wandering(Remainder(9.0, {}, ("x_in_mm",), slow=slow)) is None
