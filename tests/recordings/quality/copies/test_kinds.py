"""Every kind of copy is found, with the stretch that it holds; true repeats are left in peace."""

import numpy as np
import pytest

import tsas_cli as tsas
from tests.drives import STIFF, columns, speeds
from tests.recordings.quality.bench import Bench
from tests.recordings.quality.bench import columns as sensed
from tsas_cli.recordings import pieces
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.quality.copies import rows as copied_rows
from tsas_studies.challenge.rig.drive import Gear
from tsas_studies.challenge.rig.recordings import Run, write_dataset

CONDITIONS = {"sheath_length_mm": 785.4, "total_bend_rad": 3.1416, "preload_N": 25.0}


def dataset(folder, conditions=None, **runs):
    """Write runs, all under the same conditions but for some, and open them."""
    by_run = conditions or {}
    made = [Run(name, c, CONDITIONS | by_run.get(name, {})) for name, c in runs.items()]
    return read_dataset(write_dataset(folder / "runs", made))


def recorded(seed=0, **bench):
    return sensed(Bench(**{"rate_Hz": 100.0, "seed": seed, **bench}))


def rows(run, *between):
    return {name: values[slice(*between)] for name, values in run.items()}


def later(run, by_s):
    return run | {"time_s": run["time_s"] + by_s}


def rounded(run, digits):
    return {n: v if n == "time_s" else np.round(v, digits) for n, v in run.items()}


A, OTHER = recorded(1), recorded(2)
N, T = A["time_s"].size, A["time_s"][-1]
DRIVEN = ("time_s", "x_in_mm", "f_in_N")
HALF, PART = rows(A, 0, 1000), rows(A, 700, N)


def copies(data):
    """Return severity, run and sentence of each finding of the check."""
    found = [f for f in tsas.check(data).findings if f.code == "copies"]
    return [(f.severity, f.run, f.sentence) for f in found]


@pytest.fixture
def reported(tmp_path):
    """Return a function that checks a dataset of runs, some under other conditions."""
    return lambda *conditions, **runs: copies(dataset(tmp_path, *conditions, **runs))


ALL = "holds the samples of run a"
SAME = {
    "another file": (A, ALL),
    "one more column": (A | {"temperature_C": np.linspace(20.0, 22.0, N)}, ALL),
    "single precision": ({n: v.astype(np.float32).astype(float) for n, v in A.items()}, ALL),
    "rounded": (rounded(A, 3), ALL),
    "to a tenth": (rounded(A, 1), ALL),
    "five significant digits": (
        {n: v if n == "time_s" else np.array([float(f"{x:.5g}") for x in v]) for n, v in A.items()},
        ALL,
    ),
    "a few samples changed": (A | {"x_in_mm": A["x_in_mm"] + 0.05 * (np.arange(N) % 97 == 9)}, ALL),
    "later": (later(A, 12.5), f"{ALL}, its time shifted by 12.5 s"),
}
LESS = {
    "fewer columns": ({n: A[n] for n in ("time_s", "x_in_mm", "f_out_N")}, ALL),
    "cut out": (rows(A, 300, 500), f"{ALL} from 3 s to 4.99 s"),
    "every second": (rows(A, None, None, 2), "holds every 2nd sample of run a"),
    "every seventh of a piece": (
        later(rows(A, 103, 1200, 7), -1.0),
        "holds every 7th sample of run a from 1.03 s to 11.95 s",
    ),
}


@pytest.mark.parametrize("kind", [*SAME, *LESS])
def test_a_copy_is_found_and_what_tells_less_is_the_copy_though_it_comes_first(reported, kind):
    copy, sentence = (SAME | LESS)[kind]
    assert reported(a=A, b=copy, c=OTHER) == [("warning", "b", sentence)]
    if kind in LESS:
        assert reported(b=copy, c=OTHER, a=A) == [("warning", "b", sentence)]


def test_the_end_of_one_run_is_the_beginning_of_another(reported):
    found = reported(a=HALF, b=later(PART, -7.0), c=OTHER)
    sentence = "holds, from 0 s to 2.99 s, the samples of run a from 7 s to 9.99 s"
    assert found == [("warning", "b", sentence)]


def test_of_a_run_with_lines_between_its_samples_the_samples_are_the_copy(reported):
    time_s = np.arange(0.0, T, 0.005)
    lines = {name: np.interp(time_s, A["time_s"], values) for name, values in A.items()}
    assert reported(a=A, b=lines) == [("warning", "a", "holds every 2nd sample of run b")]


def test_stretches_at_different_shifts_are_found(reported):
    """A recording without a pause in its middle."""
    cut = {name: np.concatenate((v[100:500], v[900:1200])) for name, v in A.items()}
    found = reported(a=A, b=cut | {"time_s": A["time_s"][:700]})
    assert [sentence for *_, sentence in found] == [
        "holds, from 0 s to 3.99 s, the samples of run a from 1 s to 4.99 s",
        "holds, from 4 s to 6.99 s, the samples of run a from 9 s to 11.99 s",
    ]


def test_the_copies_under_other_conditions_are_an_error(reported):
    other = {"b": {"total_bend_rad": 1.0}}
    ((severity, run, sentence),) = reported(other, a=A, b=later(A, 1.0))
    assert (severity, run) == ("error", "b")
    assert sentence.endswith(", but the manifest says total_bend_rad = 1 here and 3.1416 there")
    found = reported({"b": {"total_bend_rad": 3.14}}, a=A, b=later(A, 1.0))
    assert [severity for severity, *_ in found] == ["warning"]


def test_a_slow_channel_is_compared_where_it_was_recorded(reported):
    def slow(seed):
        run = recorded(seed, noise_mm=0.0)
        force = np.where(np.arange(N) % 10, np.nan, run["f_in_N"])
        return {"time_s": run["time_s"], "x_in_mm": run["x_in_mm"], "f_in_N": force}

    assert reported(a=slow(1), b=rows(slow(1), 200, None))
    assert not reported(a=slow(1), b=rows(slow(2), 200, None))


def test_what_only_one_run_records_is_evidence(reported):
    """One recording in two files, each with a sensor of its own beside the drive."""
    near, far = ({n: A[n] for n in ("time_s", "x_in_mm", force)} for force in ("f_in_N", "f_out_N"))
    assert not reported(a=near, b=far)


@pytest.mark.parametrize(("module", "most"), [(pieces, 300), (copied_rows, 1000)])
def test_of_long_recordings_pieces_and_shares_of_the_rows_are_compared(
    reported, monkeypatch, module, most
):
    """Shares by their values: the same rows of the copy as of the original."""
    monkeypatch.setattr(module, "MOST_ROWS", most)
    found = reported(a=A, b=later(rows(A, 250, 1400), 3.0), c=OTHER)
    assert found == [("warning", "b", "holds the samples of run a from 2.5 s to 13.99 s")]


def test_each_run_is_held_against_one_original(reported):
    found = reported(a=A, b=A, c=later(A, 1.0), d=rows(A, 100, 800), e=OTHER)
    assert [run for _, run, _ in found] == ["b", "c", "d"]
    assert all("of run a" in sentence for *_, sentence in found)


def test_runs_that_nothing_can_be_told_of_are_said_to_be(tmp_path):
    backwards = OTHER | {
        "time_s": np.where(np.arange(N) > 500, OTHER["time_s"] - 1.0, OTHER["time_s"])
    }
    report = tsas.check(dataset(tmp_path, a=A, b=rows(OTHER, 0, 10), c=backwards)).not_checked
    reasons = {(one.run, one.reason) for one in report if one.code == "copies"}
    assert reasons == {("b", "too few rows change"), ("c", "time does not increase")}


def test_a_run_that_cannot_be_read_hides_no_copy(tmp_path):
    data = dataset(tmp_path, a=A, b=OTHER, c=later(A, 1.0))
    (tmp_path / "runs" / "runs" / "b.parquet").write_bytes(b"nothing")
    assert [run for _, run, _ in copies(data)] == ["c"]


SENSORS = {
    "fine": {},
    "stepped": {"step_mm": 0.01, "step_N": 0.1},
    "coarse": {"step_mm": 0.1, "step_N": 1.0},
    "noise hidden": {"noise_mm": 1e-3, "step_mm": 0.05, "noise_N": 0.01, "step_N": 0.5},
    "commanded": {"noise_mm": 0.0, "step_N": 0.2},
}


@pytest.mark.parametrize(
    ("shape", "sensors"),
    [
        *(("dwells", sensors) for sensors in SENSORS),
        *((shape, "coarse") for shape in ("sine", "nested", "triangle", "chirp")),
    ],
)
def test_true_repeats_are_never_accused(reported, shape, sensors):
    """Five runs of one command, begun at the same moment of the clock."""
    runs = {f"r{k}": recorded(10 + k, shape=shape, **SENSORS[sensors]) for k in range(5)}
    assert not reported(**runs)
    two = {name: {n: c[n] for n in ("time_s", "x_in_mm", "f_in_N")} for name, c in runs.items()}
    assert not reported(**two)


def test_ripple_that_every_repeat_shows_is_no_copy(reported):
    phase = np.arange(N) * 0.37 * 2.0 * np.pi
    ripple = {"x_in_mm": 0.1, "x_out_mm": 0.1, "f_in_N": 1.0, "f_out_N": 1.0}
    runs = {
        f"r{k}": {n: v + ripple.get(n, 0.0) * np.sin(phase) for n, v in recorded(k).items()}
        for k in range(4)
    }
    assert not reported(**runs)


def test_a_rest_is_no_evidence_of_a_copy(reported):
    """Before and after another motion each, both stand still where the encoder reads zero."""
    still = {n: np.full(2000, 25.0 if n.endswith("N") else 0.0) for n in A}

    def rested(run):
        both = {n: np.concatenate((still[n], np.round(v, 1), still[n])) for n, v in run.items()}
        return both | {"time_s": np.arange(both["time_s"].size) / 100.0}

    assert not reported(a=rested(A), b=rested(recorded(3, shape="triangle")))


def test_the_coarse_copy_is_found_all_the_same(reported):
    coarse = recorded(1, shape="dwells", **SENSORS["coarse"])
    assert reported(a=coarse, b=later(rows(coarse, 100, None), 0.5))


def test_runs_computed_without_noise_are_copies_where_they_agree(reported):
    quiet = {"noise_mm": 0.0, "noise_N": 0.0}
    same = {"a": recorded(1, **quiet), "b": later(recorded(2, **quiet), 1.0)}
    assert [run for _, run, _ in reported(**same)] == ["b"]
    # Under other conditions a model may compute the same: that contradicts nothing.
    found = reported({"b": {"total_bend_rad": 1.0}}, **same)
    assert [severity for severity, *_ in found] == ["warning"]
    assert not reported(a=same["a"], b=recorded(1, shape="triangle", **quiet))


@pytest.mark.parametrize("name", ["paper-groups", "drive-chirp"])
def test_the_shipped_datasets_hold_no_copies(name):
    assert not copies(f"datasets/{name}")


def test_a_command_beside_a_coarse_force_is_repeated_by_every_repeat(reported):
    """The force takes a dozen levels: in repeats single samples differ, but for those it is one."""

    def repeat(k):
        run = recorded(k, noise_mm=0.0, noise_N=1e-3, step_N=5.0)
        run["f_in_N"][100 + k] += 5.0
        return {name: run[name] for name in DRIVEN}

    assert not reported(**{f"r{k}": repeat(k) for k in range(3)})


def test_a_piece_of_a_drive_that_is_commanded_in_steps_is_found(reported):
    """The command takes few levels, by which no sample is told from others."""
    time_s, speed = speeds(1)["steps"]

    def drive(seed):
        return columns(STIFF, Gear(), time_s, speed, seed)

    found = reported(a=drive(1), b=rows(drive(1), 1000, 4000), c=drive(2))
    assert found == [("warning", "b", "holds the samples of run a from 2 s to 7.998 s")]
