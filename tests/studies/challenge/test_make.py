import json
import math

import numpy as np
import pytest

from tsas_cli.recordings.dataset import read_dataset
from tsas_studies.challenge.bench import RUNS, SENSORS, clean_run, drawn_bench, motion, recorded
from tsas_studies.challenge.cases import Hidden, cases
from tsas_studies.challenge.make import make
from tsas_studies.challenge.truth import read_truth

NAMES = {
    "backlash, size 1",
    "nothing 1",
    "missed_counts",
    "backlash and force_sensor_offset",
}
CASES = tuple(case for case in cases(5) if case.name in NAMES)


@pytest.fixture(scope="module")
def sealed(tmp_path_factory):
    out = tmp_path_factory.mktemp("set")
    steps = []
    make(out, CASES[::-1], rate_Hz=25.0, step=lambda: steps.append(1))
    assert len(steps) == len(CASES)
    return out


def files(folder):
    return {p.relative_to(folder): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_the_answers_are_what_was_hidden(sealed):
    answers = read_truth(sealed)
    assert answers.seed == 5
    assert set(answers.cases) == {p.name for p in (sealed / "cases").iterdir()}
    kinds = {case.kind: case for case in answers.cases.values()}
    assert set(kinds) == {"one", "pair", "nothing", "unknown"}
    assert kinds["unknown"].unknown == "missed_counts"
    assert kinds["unknown"].hidden == kinds["nothing"].hidden == ()
    (one,) = kinds["one"].hidden
    assert one.parameters == next(c for c in CASES if c.kind == "one").hidden[0].parameters
    assert kinds["pair"].effects == {"backlash", "force_sensor_offset"}


def test_a_dataset_says_nothing_of_what_is_hidden(sealed):
    manifests = [p.read_text(encoding="utf-8") for p in sealed.rglob("dataset.toml")]
    assert len(manifests) == len(CASES)
    said = [
        "\n".join(line for line in text.splitlines() if not line.startswith(("sha256", "started")))
        for text in manifests
    ]
    assert len(set(said)) == 1
    for word in ("backlash", "missed", "offset", "nothing", "pair"):
        assert word not in said[0].lower()
    assert {p.name for p in sealed.iterdir()} == {"cases", "answers.json"}


def test_the_product_reads_a_case(sealed):
    for folder in (sealed / "cases").iterdir():
        dataset = read_dataset(folder / "dataset")
        assert [recording.run.id for recording in dataset] == list(RUNS)
        assert dataset.manifest.session_start is not None
        for recording in dataset:
            assert all(np.isfinite(values).all() for values in recording.columns.values())
            assert recording.time_s[-1] == pytest.approx(20.0, abs=0.2)
            assert np.diff(recording.time_s) == pytest.approx(0.04)


def test_the_truth_shows_in_the_recordings(sealed):
    """Where nothing is hidden the load spring's line and the capstan ratio are the answers'."""
    answers = json.loads((sealed / "answers.json").read_text(encoding="utf-8"))["cases"]
    name = next(name for name, case in answers.items() if case["kind"] == "nothing")
    nominal = answers[name]["nominal"]
    for recording in read_dataset(sealed / "cases" / name / "dataset"):
        columns, run = recording.columns, recording.run
        slope, preload = np.polyfit(columns["x_out_mm"], columns["f_out_N"], 1)
        assert slope == pytest.approx(nominal["load_stiffness_N_per_mm"], rel=0.005)
        assert preload == pytest.approx(nominal["preload_N"], rel=0.005)
        late = (columns["x_in_mm"] > 5.0) & (np.gradient(columns["x_in_mm"]) > 0.05)
        late &= recording.time_s < 12.0
        ratio = columns["f_in_N"][late].sum() / columns["f_out_N"][late].sum()
        expected = nominal["friction_coefficient"] * run.total_bend_rad
        assert math.log(ratio) == pytest.approx(expected, rel=0.02)


def test_nominal_values_are_off_by_up_to_a_tenth():
    friction = [
        drawn_bench(np.random.default_rng(seed)).nominal["friction_coefficient"] / 0.125
        for seed in range(200)
    ]
    assert 0.9 <= min(friction) < 0.91
    assert 1.09 < max(friction) <= 1.1


def test_the_motion_is_the_papers_and_then_smooth_loops():
    for run, (omega, periods, _, _) in RUNS.items():
        m = motion(run, 400.0)
        paper = m.time_s < periods * 2.0 * math.pi / omega
        np.testing.assert_allclose(
            m.x_in_mm[paper], 10.0 - 10.0 * np.cos(omega * m.time_s[paper]), atol=1e-9
        )
        assert m.x_in_mm[~paper].max() == pytest.approx(20.0, abs=1e-3)
        assert m.x_in_mm[-1] == pytest.approx(0.0, abs=0.01)
        assert np.abs(np.diff(m.x_in_mm, 2)).max() * 400.0**2 < 81.0


def test_wear_over_the_session_is_counted_from_the_first_run():
    bench = drawn_bench(np.random.default_rng(1))
    worn = (Hidden("friction_drift", {"session_rate_per_s": 1e-3}),)
    for run, same in (("a", True), ("b", False)):
        plain, _ = clean_run(bench, (), run, rate_Hz=25.0)
        later, _ = clean_run(bench, worn, run, rate_Hz=25.0)
        assert np.array_equal(plain.columns["f_in_N"], later.columns["f_in_N"]) is same


def test_a_sensor_that_drifts_over_the_session_is_off_by_its_rate_times_the_runs_start():
    bench = drawn_bench(np.random.default_rng(1))
    drifting = (Hidden("force_sensor_drift", {"f_out_session_rate_N_per_s": 1e-3}),)
    for run, began in bench.started.items():
        plain = recorded(bench, (), run, rate_Hz=25.0, seed=1)
        later = recorded(bench, drifting, run, rate_Hz=25.0, seed=1)
        off = 1e-3 * (began - bench.started["a"]).total_seconds()
        step = SENSORS.f_out_N.step
        np.testing.assert_allclose(later["f_out_N"] - plain["f_out_N"], off, atol=step)
        assert np.array_equal(later["f_in_N"], plain["f_in_N"])


def test_a_case_has_the_same_bytes_in_any_set_and_order(sealed, tmp_path):
    other = tuple(case for case in cases(6) if case.name == "nothing 1")
    make(tmp_path, (*other, *CASES[:2]), rate_Hz=25.0)
    assert read_truth(tmp_path).seed == (5, 6)
    content = json.loads((tmp_path / "answers.json").read_text(encoding="utf-8"))
    assert sorted(case["seed"] for case in content["cases"].values()) == [5, 5, 6]
    both, of_five = files(tmp_path / "cases"), files(sealed / "cases")
    shared = both.keys() & of_five.keys()
    assert len({name.parts[0] for name in shared}) == 2
    assert all(both[name] == of_five[name] for name in shared)


def test_a_set_of_no_cases(tmp_path):
    with pytest.raises(ValueError, match="no cases"):
        make(tmp_path, (), rate_Hz=25.0)
