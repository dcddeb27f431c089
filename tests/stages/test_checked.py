"""Errors in the recordings stop `calibrate` and `diagnose`, unless they are accepted.

What cannot be judged without a channel is said once, with the runs that lack it.
"""

import numpy as np
import pytest

import tsas_cli as tsas
from tests.counted import Counted
from tests.reporting.made_folders import page_from
from tests.rigs import dataset_of, recorded
from tsas_cli.recordings.quality.finding import Finding
from tsas_cli.records.base import DatasetSource, OfDataset
from tsas_cli.records.diagnosis import DiagnosisFile, NamedCause
from tsas_cli.stages.before_fit import unrecorded
from tsas_studies.challenge.rig.tendon import Rig

RIG = Rig(cells=60)


@pytest.fixture(scope="module")
def pounds(tmp_path_factory):
    """Return a dataset whose f_in is in pounds and says newton."""
    newtons = recorded(RIG, 50.0)
    pounds = newtons | {"f_in_N": newtons["f_in_N"] / 4.4482216}
    return dataset_of(RIG, tmp_path_factory.mktemp("pounds") / "dataset", a=pounds)


@pytest.mark.parametrize("stage", ["calibrate", "diagnose"])
def test_an_error_stops_the_stage_and_says_how_to_go_on(pounds, tmp_path, stage):
    with pytest.raises(tsas.InputError, match=r"f_in_N looks like pound-force.*--despite unit$"):
        getattr(tsas, stage)(pounds, out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("stage", ["calibrate", pytest.param("diagnose", marks=pytest.mark.large)])
def test_an_accepted_error_stands_in_the_result_and_on_top_of_the_page(pounds, tmp_path, stage):
    result = getattr(tsas, stage)(pounds, out=tmp_path / "out", despite="unit")
    (error,) = result.record.despite
    assert (error.code, error.run) == ("unit", "a")
    said = "Despite an error in run a: f_out_N is 4.4"
    assert any(said in sentence for sentence in result.sentences())
    made = page_from(pounds, tmp_path / "out")
    assert said in made[: made.index("<nav")]
    assert f"{stage} {pounds}" in made
    assert "--despite unit" in made[made.index('id="repeat"') :]


@pytest.mark.parametrize(
    ("despite", "message"),
    [(["sign", "clipped"], "--despite unit$"), ("unti", r"did you mean unit\?")],
)
def test_only_an_error_that_is_accepted_and_known_is(pounds, despite, message):
    with pytest.raises(tsas.InputError, match=message):
        tsas.calibrate(pounds, despite=despite)


def held(columns, rows):
    """Return a recording whose x_out is held for so many rows."""
    x_out = columns["x_out_mm"]
    return columns | {"x_out_mm": x_out[np.arange(x_out.size) // rows * rows]}


def test_a_warning_is_an_error_where_most_runs_have_it(tmp_path):
    """A channel that is held for 20 rows: in one of two runs it may be the motion's."""
    good = recorded(RIG, 200.0)
    for name, other, severity in (("one", good, "warning"), ("both", held(good, 20), "error")):
        folder = dataset_of(RIG, tmp_path / name, a=held(good, 20), b=other)
        found = [one for one in tsas.check(folder).findings if one.code == "slow-channel"]
        assert {one.severity for one in found} == {severity}
        assert len(found) == (2 if name == "both" else 1)


def test_what_the_checks_warn_of_stands_in_the_result(tmp_path):
    good = recorded(RIG, 200.0)
    kept = np.delete(np.arange(good["time_s"].size), np.arange(900, 930))
    lost = {n: v[: kept.size] if n == "time_s" else v[kept] for n, v in good.items()}
    for runs, warned in (({"a": good, "b": lost}, ["b"]), ({"a": good}, [])):
        result = tsas.calibrate(dataset_of(RIG, tmp_path / "-".join(runs), **runs))
        assert [w.run for w in result.record.warnings if w.code == "lost-samples"] == warned
        said = [s for s in result.sentences() if "(`lost-samples`)" in s]
        assert [s.partition(":")[0] for s in said] == ["- The checks warn of run b"] * len(warned)


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        (20, "Despite an error in run a and run b: x_out_mm changes only every 20"),
        (40, "Despite an error in run a: x_out_mm changes only every 20"),
    ],
)
def test_errors_of_one_kind_are_said_once(tmp_path, rows, said):
    good = recorded(RIG, 200.0)
    other = held(good, rows) | {"f_in_N": good["f_in_N"] + 0.01}
    folder = dataset_of(RIG, tmp_path / "data", a=held(good, 20), b=other)
    found = tsas.calibrate(folder, despite=["slow-channel", "hum"]).record.accepted()
    (both,) = (sentence for sentence in found if "(`slow-channel`)" in sentence)
    assert both.startswith(said)
    assert both.endswith("; others of the kind in run b.") == (rows == 40)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ([0.5] * 6, "The checks warn of 6 runs: 0.5 N (`noise`)."),
        (
            [0.5, 0.4] * 3,
            "The checks warn of run a: 0.5 N (`noise`); others of the kind in 5 runs.",
        ),
        ([0.5, 0.5], "The checks warn of run a and run b: 0.5 N (`noise`)."),
    ],
)
def test_of_many_runs_the_number_is_said(values, said):
    found = [
        Finding("warning", "f_in_N", f"{value} N", "", code="noise", run=run)
        for run, value in zip("abcdef", values, strict=False)
    ]
    source = DatasetSource(name="bench", hashes={})
    assert OfDataset(stage="check", dataset=source, warnings=found).warned() == [said]


@pytest.mark.parametrize(
    ("named", "shift", "too"),
    [
        ("load_damping", "before", True),
        ("load_damping", "after", False),
        ("backlash", "before", False),
    ],
)
def test_a_tension_that_a_named_load_lets_come_early_is_no_second_fault(named, shift, too):
    late = f"f_out_N comes 9 ms (95 %: 7 to 11) {shift} x_out_mm"
    file = DiagnosisFile(
        dataset=DatasetSource(name="bench", hashes={}),
        verdict="named",
        reason="",
        named=(NamedCause(effect=named, gain_percent=50.0),),
        warnings=(Finding("warning", "f_out_N", late, "", code="delay", run="a"),),
    )
    said = f"The checks warn of run a: {late} (`delay`)."
    assert file.warned() == [f"{said} {named} does this too." if too else said]


ALL = ("time_s", "x_in_mm", "x_out_mm", "f_in_N", "f_out_N")


def test_a_missing_channel_and_one_that_some_runs_lack():
    assert list(unrecorded([ALL, ALL])) == []
    proximal, distal = unrecorded([ALL[:3] + ALL[4:], ALL[:3]])
    assert proximal.startswith("f_in is not recorded: without it, the level of friction rests on")
    assert distal.startswith("f_out is not recorded in 1 of 2 runs: without it, the tension at")


def test_a_stage_says_it_before_it_is_done(dataset):
    class Heard(Counted):
        said = ()

        def say(self, sentence):
            self.said += ((sentence, self.done),)

    heard = Heard()
    tsas.calibrate(dataset, step=heard)
    assert any(
        s.startswith("f_out is not recorded") and done < heard.done for s, done in heard.said
    )
