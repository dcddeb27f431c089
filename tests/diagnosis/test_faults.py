"""A fault of one run is said in place of a mechanism; a mechanism is not accused."""

import re
import tomllib

import pytest

from tests.studies.challenge.recorded import recordings
from tsas_cli.diagnosis.faults.beside import Candidate
from tsas_cli.diagnosis.faults.words import record_of
from tsas_cli.stages.diagnose import diagnose
from tsas_studies.challenge import bench
from tsas_studies.challenge.cases import Case, Hidden

RATE_HZ = 30.0


@pytest.fixture(scope="module", autouse=True)
def simulated_once():
    """A fault of the recording changes nothing of the motion: each is simulated once."""
    kept, clean_run = {}, bench.clean_run

    def once(*of, **how):
        if (key := repr((of, how))) not in kept:
            kept[key] = clean_run(*of, **how)
        return kept[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(bench, "clean_run", once)
        yield


def made(folder, kind, *hidden, runs="ab", rate_Hz=RATE_HZ, conditions="clean"):
    case = Case("made for a test", kind, 1.0, hidden, seed=3, number=77, conditions=conditions)
    return recordings(folder, case, rate_Hz=rate_Hz, runs=runs)


def of_three(folder, hidden):
    """Return the diagnosis of three runs with a fault."""
    return diagnose(made(folder, "recording", hidden, runs="abcd"), runs=["a", "b", "c"])


def of_a_run(function, **values):
    return Hidden(function, {"run": "b", **values})


MORE = {"channel": "f_in_N", "gain": 1.03}
LESS = {"channel": "f_out_N", "offset": -1.0, "since": 0.5}
LATE = {"channels": ("x_out_mm",), "late_s": 0.02}


@pytest.mark.parametrize(
    ("fault", "values", "code", "column", "size", "unit"),
    [
        ("gain_of_a_run", MORE, "run-gain", "f_in_N", 3.0, "% more"),
        ("step_in_a_run", LESS, "run-offset", "f_out_N", 1.0, "N"),
        ("shifted_start_of_a_run", LATE, "run-delay", "x_out_mm", 20.0, "ms later"),
    ],
)
def test_a_fault_of_one_run_is_said_with_its_size(
    fault, values, code, column, size, unit, tmp_path
):
    result = of_three(tmp_path, of_a_run(fault, **values))
    assert (result.verdict, result.causes) == ("undecided", ())
    (found,) = result.record.faults
    assert (found.code, found.run, found.column) == (code, "b", column)
    said = found.sentence.split(f" {unit} ")[0].removeprefix(f"run b: {column} ").split()[-1]
    assert float(said) == pytest.approx(size, rel=0.1)
    assert found.sentence in result.reason
    assert "leave its run out" in result.next_experiment


@pytest.mark.parametrize(
    ("fault", "values", "code", "said"),
    [
        ("hum_in_the_band", {"amplitude": 0.7, "frequency_Hz": 1.4}, "hum", "swings at 1.4 Hz in"),
        ("soft_saturation", {"depth": 1.5, "knee": 1.5}, "saturates", "as a sensor that saturates"),
    ],
)
def test_a_fault_of_all_runs_is_said(fault, values, code, said, tmp_path):
    hidden = Hidden(fault, {"channels": ("f_out_N",), **values})
    (found,) = of_three(tmp_path, hidden).record.faults
    assert (found.code, found.run, found.column) == (code, None, "f_out_N")
    assert said in found.sentence


def test_counts_that_an_encoder_misses_are_said_as_steps(tmp_path):
    missed = of_a_run("missed_counts", channel="x_out_mm", lost_mm=0.15, times=3)
    (found,) = of_three(tmp_path, missed).record.faults
    assert (found.code, found.run, found.column) == ("run-step", "b", "x_out_mm")
    assert found.sentence.count(" mm less since about ") == 3


@pytest.mark.parametrize(("run", "rate"), [("b", 0.003), (None, -0.002)])
def test_a_clock_is_said_with_its_pace(run, rate, tmp_path):
    values = {"run": run, "channels": ("x_out_mm",), "rate": rate}
    fault = "clock_of_a_run" if run else "second_logger"
    (found,) = of_three(tmp_path, Hidden(fault, values)).record.faults
    assert (found.code, found.run, found.column) == ("clock", run, "x_out_mm")
    way = "slower" if rate > 0.0 else "faster"
    assert f" runs {100.0 * abs(rate):.1g} % {way} than" in found.sentence


def test_a_fault_of_one_run_stands_out_of_slow_noise_in_all(tmp_path):
    """It explains less than seven tenths of what is left, and far more than in any other run."""
    values = {"run": "b", "channels": ("f_out_N",), "rate": 0.0008}
    hidden = Hidden("clock_of_a_run", values)
    dataset = made(tmp_path, "recording", hidden, runs="abc", conditions="slow")
    (found,) = diagnose(dataset).record.faults
    assert (found.code, found.run, found.column) == ("clock", "b", "f_out_N")


def test_what_wanders_without_any_motion_is_no_mechanism(tmp_path):
    values = {"channels": ("f_out_N",), "per_root_s": 0.6}
    result = of_three(tmp_path, Hidden("random_walk", values))
    (found,) = result.record.faults
    assert (result.verdict, found.code, found.column) == ("unexplained", "wanders", "f_out_N")
    assert "follows no signal of the motion" in result.reason
    assert result.next_experiment.startswith("Repeat one run")


def test_a_mechanism_is_not_accused(tmp_path):
    """Nor is a sound rig: tests/metamorphic/test_relations.py."""
    effect = "direction_dependent_friction"
    result = diagnose(made(tmp_path, "one", Hidden(effect, {"asymmetry": 0.08})))
    assert result.record.faults == ()
    assert [cause.effect for cause in result.causes] == [effect]


def test_a_tendon_that_is_stiffer_than_its_data_sheet_is_a_fault_of_the_manifest(tmp_path):
    """A modulus in 10^6 psi that is stated as GPa: the tendon is 6.9 times as stiff."""
    folder = made(tmp_path, "nothing", rate_Hz=20.0)
    manifest = folder / "dataset.toml"
    stated = tomllib.loads(manifest.read_text())["rig"]["tendon_modulus_GPa"]
    wrong = f"tendon_modulus_GPa = {stated / 6.895}"
    manifest.write_text(re.sub(r"tendon_modulus_GPa = \S+", wrong, manifest.read_text()))
    found = diagnose(folder)
    (fault,) = found.record.faults
    assert (found.verdict, fault.code) == ("undecided", "tendon-stiffness")
    ratio = float(fault.sentence.partition("the tendon is ")[2].partition(" times")[0])
    assert ratio == pytest.approx(6.895, rel=0.1)
    again = diagnose(folder, despite="tendon-stiffness")
    assert "does not seek the fault tendon-stiffness" in again.record.cannot_tell[0]
    assert again.verdict == "sufficient"


def test_where_one_run_has_its_bend_a_law_of_friction_is_said_beside_a_wrong_bend(tmp_path):
    values = {"run": "d", "key": "total_bend_rad", "factor": 1.12}
    dataset = made(tmp_path, "recording", Hidden("bend_of_a_run", values), runs="abcd")
    (found,) = diagnose(dataset).record.faults
    assert (found.code, found.run) == ("run-friction", "d")
    assert "no other run has its bend" in found.sentence
    shared = record_of([Candidate("run-friction", 0, (), 0.1, 9.0)], ["a"])
    assert "no other run has its bend" not in shared.sentence


def test_bends_that_are_exchanged_are_said(tmp_path):
    dataset = made(tmp_path, "nothing", runs="abcd")
    manifest = dataset / "dataset.toml"
    stated = "total_bend_rad = "
    head, a, b, c, d = manifest.read_text().split(stated)
    (bend_b, rest_b), (bend_d, rest_d) = b.split("\n", 1), d.split("\n", 1)
    assert bend_b != bend_d
    manifest.write_text(stated.join([head, a, f"{bend_d}\n{rest_b}", c, f"{bend_b}\n{rest_d}"]))
    found = diagnose(dataset)
    (fault,) = found.record.faults
    assert (found.verdict, fault.code) == ("unexplained", "run-frictions")
    assert "with those of runs b and d exchanged it is the same" in fault.sentence
    assert fault.sentence in found.reason
