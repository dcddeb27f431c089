"""The first screen says what came out, with the numbers that it rests on."""

import re
from html import unescape

import pytest

from tests.reporting import made_diagnoses, made_loops
from tests.reporting import made_folders as by_hand
from tests.studies.reproduction.test_page import GROUPS, PAPER
from tsas_cli.reporting.glance import glance
from tsas_cli.reporting.inputs import read_inputs
from tsas_studies.reproduction.page import reproduction_page


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    return by_hand.make_dataset(tmp_path_factory.mktemp("glance") / "dataset", ("a",), samples=400)


def of(*folders):
    return glance(read_inputs(list(folders)))


def facts(it):
    return {fact.label: (fact.before, fact.value, fact.note) for fact in it.facts}


def test_a_named_cause_with_its_gain_and_the_error_before_and_after(dataset, tmp_path):
    folder = made_diagnoses.make_diagnosis(dataset, tmp_path / "d", "named")
    it, noise = of(folder), read_inputs([folder]).noise
    assert noise["f_in_N"] == pytest.approx(by_hand.NOISE, rel=0.2)
    f_in, f_out = (
        f"{before / noise[name]:.2g} → {after / noise[name]:.2g} × noise level"
        for name, before, after in (("f_in_N", 0.91, 0.11), ("f_out_N", 0.104, 0.096))
    )
    assert it.kind == "Cause found: normalised residual on held-out data 48.2 % lower"
    assert it.verdict == "Tendon outside the sheath"
    assert "nominal → extended model" in it.numbers
    assert facts(it) == {
        "normalised residual": ("", "48.2 % lower", "95 %: 44.9 to 51.0 %"),
        "tension at the drive": ("0.910", "0.110 N", f_in),
        "tension at the load": ("0.104", "0.0960 N", f_out),
        "displacement of the tendon at the load": (
            "0.0243",
            "0.00920 mm",
            "3.0 → 1.1 × noise level",
        ),
    }


@pytest.fixture
def diagnosed(dataset, tmp_path):
    """Return a function that gives what stands on top of a diagnosis."""
    make = made_diagnoses.make_diagnosis
    return lambda verdict, **more: of(make(dataset, tmp_path / "d", verdict, **more))


CAUSE = {"effect": "backlash", "title": "Backlash", "parameters": {}}


def test_two_causes_are_one_sentence_and_each_has_its_gain(diagnosed):
    gained = CAUSE | {"gain_percent": 7.25}
    it = diagnosed("named", named=[gained, gained | {"effect": "mine", "title": "Own thing"}])
    assert it.verdict == "Backlash and own thing"
    assert it.next_experiment.startswith("Record the same motion")
    assert facts(it)["normalised residual by own thing"] == ("", "7.25 % lower", "")


def test_what_is_unknown_beside_a_cause_and_a_rival_are_not_kept_back(diagnosed):
    it = diagnosed("partly", named=[CAUSE])
    assert it.kind == "Cause found, but not everything agrees with it"
    assert it.verdict == "Backlash"
    it = diagnosed("ambiguous")
    assert it.kind.startswith("Cause found, but these recordings leave open which: normalised")
    assert it.verdict == "Tendon outside the sheath (or compliance of the drive)"


@pytest.mark.parametrize(
    ("verdict", "said"),
    [
        ("sufficient", "The nominal model explains these recordings"),
        ("unexplained", "No known effect explains what the model misses"),
        ("undecided", "These recordings lead to no verdict"),
    ],
)
def test_without_a_cause_there_is_no_before_and_no_gain(diagnosed, verdict, said):
    it = diagnosed(verdict)
    assert it.verdict == said
    assert "after" not in it.numbers
    assert not any(fact.before or fact.label == "normalised residual" for fact in it.facts)
    assert bool(it.facts) is (verdict != "undecided")


def test_tracking_says_who_follows_best_and_under_which_condition(tmp_path):
    it = of(made_loops.make_tracking(tmp_path / "t"))
    assert it.verdict == "Pid follows best"
    assert it.numbers == "Root mean square error of the force, undisturbed"
    assert facts(it)["adaptive-sliding-mode"] == ("", "0.800 N", "disturbed: 0.800 N")
    assert of(made_loops.make_tracking(tmp_path / "one", ("pid",))).verdict == "Followed by pid"


def test_a_closed_loop_shows_the_median_with_the_poor_the_better_and_the_true_model(tmp_path):
    it = of(made_loops.make_closing(tmp_path / "c"))
    assert it.verdict == "A cause is named in 2 of 3 cases"
    assert "median of 3 cases" in it.numbers
    assert facts(it)["disturbance-observer"] == ("0.90", "0.10 N", "with the true model: 0.10 N")
    one = of(made_loops.make_closing(tmp_path / "one", {"bend": made_loops.CASES["bend"]}))
    assert one.verdict == "A cause is not named"
    assert "median" not in one.numbers


def test_a_simulation_alone_says_how_near_it_is(dataset, tmp_path):
    it = of(by_hand.make_simulation(dataset, tmp_path / "s"))
    assert it.verdict == "Within 2.0 times the noise"
    assert facts(it)["tension at the load"] == ("", "2", "")


@pytest.mark.usefixtures("undrawn")
def test_recordings_alone_have_no_verdict(dataset):
    assert of(dataset) is None
    assert 'class="glance"' not in by_hand.page_from(dataset)


@pytest.mark.usefixtures("undrawn")
def test_it_stands_above_everything_else(dataset, tmp_path):
    text = by_hand.page_from(made_diagnoses.make_diagnosis(dataset, tmp_path / "d", "named"))
    assert text.index('class="verdict">Tendon outside') < text.index("<nav")
    shown = unescape(re.sub("<[^>]*>", "", text[text.index("<dl>") : text.index("</dl>")]))
    assert "0.910 → 0.110 N" in shown


def test_the_reproduction_counts_its_verdicts():
    text = reproduction_page(PAPER, GROUPS)
    assert 'class="verdict">1 of 3 numbers and statements agree' in text


def test_a_law_of_unnamed_origin_shows_its_gain(dataset, tmp_path):
    folder = made_diagnoses.make_diagnosis(
        dataset, tmp_path / "d", "unexplained", laws=[made_diagnoses.LAW]
    )
    with by_hand.edited(folder / "diagnosis.json") as content:
        content["verdict"] = "described"
    it = of(folder)
    assert it.verdict == "A law of unnamed origin predicts better"
    assert it.numbers.endswith("nominal → extended model")
    assert facts(it)["tension at the drive"][0] == "0.620"
    text = by_hand.page_from(folder)
    assert "the RMS of f_in_N falls" not in text
    assert "After a reversal, at the mean tension; along the stroke. Bands" in text
    assert "<code>size_N</code> 1.00 N, 95 % interval 0.90 to 1.10" in text
    assert "x_out_size_mm" not in text
