"""A fault of one run is said in place of a mechanism; a sound rig and a mechanism are not accused.

The recordings are those of the independent rig.
"""

import pytest

from tsas_cli.diagnosis.faults.candidates import Candidate
from tsas_cli.diagnosis.faults.words import record_of
from tsas_cli.stages.diagnose import diagnose
from tsas_studies.challenge.cases import Case, Hidden
from tsas_studies.challenge.make import make

RATE_HZ = 30.0


def made(folder, kind, *hidden):
    case = Case("made for a test", kind, 1.0, hidden, seed=3, number=77)
    make(folder, [case], rate_Hz=RATE_HZ)
    (dataset,) = (folder / "cases").glob("*/dataset")
    return dataset


def of_a_run(function, **values):
    return Hidden(function, {"run": "b", **values})


@pytest.mark.parametrize(
    ("fault", "values", "code", "column", "words"),
    [
        (
            "gain_of_a_run",
            {"channel": "f_in_N", "gain": 1.03},
            "run-gain",
            "f_in_N",
            ("run b: f_in_N reads ", 3.0, " % more than in the other runs"),
        ),
        (
            "step_in_a_run",
            {"channel": "f_out_N", "offset": -1.0, "since": 0.5},
            "run-offset",
            "f_out_N",
            ("run b: f_out_N reads ", 1.0, " N less than the other runs and channels fit since"),
        ),
        (
            "shifted_start_of_a_run",
            {"channels": ("x_out_mm",), "late_s": 0.02},
            "run-delay",
            "x_out_mm",
            ("run b: x_out_mm comes ", 20.0, " ms later than the other channels"),
        ),
    ],
)
def test_a_fault_of_one_run_is_said_with_its_size(fault, values, code, column, words, tmp_path):
    dataset = made(tmp_path, "recording", of_a_run(fault, **values))
    result = diagnose(dataset)
    assert (result.verdict, result.causes) == ("undecided", ())
    (found,) = result.record.faults
    assert (found.code, found.run, found.column) == (code, "b", column)
    before, size, after = words
    assert after in found.sentence
    said = float(found.sentence.removeprefix(before).split(after)[0])
    assert said == pytest.approx(size, rel=0.1)
    assert found.sentence in result.reason
    assert "leave its run out" in result.next_experiment


def test_the_sign_of_a_gain(tmp_path):
    dataset = made(tmp_path, "recording", of_a_run("gain_of_a_run", channel="f_in_N", gain=0.97))
    (found,) = diagnose(dataset).record.faults
    assert " % less than in the other runs" in found.sentence


def test_hum_is_said_with_its_frequency(tmp_path):
    values = {"channels": ("f_out_N",), "amplitude": 0.7, "frequency_Hz": 1.4}
    result = diagnose(made(tmp_path, "recording", Hidden("hum_in_the_band", values)))
    (found,) = result.record.faults
    assert (found.code, found.run, found.column) == ("hum", None, "f_out_N")
    assert found.sentence == "f_out_N swings at 1.4 Hz in all runs, whatever the motion"


def test_the_beginning_of_a_fault_is_found_between_the_parts_of_a_run(tmp_path):
    step = of_a_run("step_in_a_run", channel="f_out_N", offset=1.0, since=0.53)
    (found,) = diagnose(made(tmp_path, "recording", step)).record.faults
    assert found.first_s == pytest.approx(0.53 * 20.0, abs=0.15)


def test_counts_that_an_encoder_misses_are_said_as_steps(tmp_path):
    missed = of_a_run("missed_counts", channel="x_out_mm", lost_mm=0.15, times=3)
    (found,) = diagnose(made(tmp_path, "recording", missed)).record.faults
    assert (found.code, found.run, found.column) == ("run-step", "b", "x_out_mm")
    assert found.sentence.count(" mm less since about ") == 3


def test_the_time_constant_of_an_amplifier_is_found_between_those_that_are_tried(tmp_path):
    values = {"channels": ("f_out_N",), "time_s": 27.0}
    (found,) = diagnose(
        made(tmp_path, "recording", Hidden("ac_coupled_amplifier", values))
    ).record.faults
    assert (found.code, found.run, found.column) == ("ac-coupled", None, "f_out_N")
    said = float(found.sentence.split(" within about ")[1].split(" s,")[0])
    assert said == pytest.approx(27.0, rel=0.1)


@pytest.mark.parametrize(("run", "rate"), [("b", 0.003), (None, -0.002)])
def test_a_clock_is_said_with_its_pace(run, rate, tmp_path):
    values = {"run": run, "channels": ("x_out_mm",), "rate": rate}
    fault = "clock_of_a_run" if run else "second_logger"
    (found,) = diagnose(made(tmp_path, "recording", Hidden(fault, values))).record.faults
    assert (found.code, found.run, found.column) == ("clock", run, "x_out_mm")
    way = "slower" if rate > 0.0 else "faster"
    assert f" runs {100.0 * abs(rate):.1g} % {way} than" in found.sentence


def test_a_sensor_that_saturates_softly_is_said(tmp_path):
    values = {"channels": ("f_in_N",), "depth": 1.5, "knee": 1.5}
    result = diagnose(made(tmp_path, "recording", Hidden("soft_saturation", values)))
    (found,) = result.record.faults
    assert (found.code, found.run, found.column) == ("saturates", None, "f_in_N")


def test_what_wanders_without_any_motion_is_no_mechanism(tmp_path):
    values = {"channels": ("f_out_N",), "per_root_s": 0.6}
    result = diagnose(made(tmp_path, "recording", Hidden("random_walk", values)))
    (found,) = result.record.faults
    assert (result.verdict, found.code, found.column) == ("unexplained", "wanders", "f_out_N")
    assert "follows no signal of the motion" in result.reason
    assert result.next_experiment.startswith("Repeat one run")


@pytest.mark.parametrize("effect", ["direction_dependent_friction", None])
def test_a_mechanism_and_a_sound_rig_are_not_accused(effect, tmp_path):
    hidden = (Hidden(effect, {"asymmetry": 0.08}),) if effect else ()
    result = diagnose(made(tmp_path, "one" if effect else "nothing", *hidden))
    assert result.record.faults == ()
    assert [cause.effect for cause in result.causes] == ([effect] if effect else [])


def test_where_one_run_has_its_bend_a_law_of_friction_is_said_beside_a_wrong_bend(tmp_path):
    values = {"run": "d", "key": "total_bend_rad", "factor": 1.12}
    dataset = made(tmp_path, "recording", Hidden("bend_of_a_run", values))
    (found,) = diagnose(dataset).record.faults
    assert (found.code, found.run) == ("run-friction", "d")
    assert "no other run has its bend" in found.sentence
    shared = record_of([Candidate("run-friction", 0, (), 0.1, 9.0)], ["a"])
    assert "no other run has its bend" not in shared.sentence
