import re
from dataclasses import replace

import pytest

from tests.reporting.made_diagnoses import make_diagnosis
from tests.reporting.made_folders import make_dataset, make_simulation, source
from tests.reporting.test_page import Outline, without_script
from tsas_cli.comparing.compare import compare
from tsas_cli.comparing.stage import record_of
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model
from tsas_cli.identification.model_file import write_model
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.reporting.comparing import comparison_page

HOSTILE = "<script>$x$"
NOMINAL = (
    Estimate("friction_coefficient", 0.125, "1", "fitted", None, 0.001, 0.123, 0.127),
    Estimate("load_stiffness_N_per_mm", 1.579, "N/mm", "fitted", None, 0.01, 1.56, 1.60),
    Estimate("tendon_stiffness_N", 67858.0, "N", "data sheet"),
    Estimate("preload_N", 25.0, "N", "fitted", HOSTILE, 0.1, 24.8, 25.2),
)
LENGTH = Estimate("free_tendon.proximal_length_mm", 152.0, "mm", "fitted", None, 3, 146, 158)


def diagnosed(root, name, verdict, *estimates, dataset=None, **more):
    """Write a dataset, unless there is one, and what a diagnosis says of it."""
    dataset = dataset or make_dataset(
        root / f"data-{name}", ("a", HOSTILE), name="bench & <b>", samples=400 + len(name)
    )
    folder = make_diagnosis(dataset, root / name, verdict, **more)
    model = Model(estimates)
    write_model(folder / "model-extended.toml", model, version="0", dataset=source(dataset, folder))
    return folder


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """A diagnosis of one rig, one of a rougher rig, and two of the same recordings."""
    root = tmp_path_factory.mktemp("comparing")
    rough = replace(NOMINAL[0], value=0.15, interval_low=0.148, interval_high=0.152)
    first = diagnosed(root, "smooth", "sufficient", *NOMINAL)
    again = diagnosed(root, "again", "ambiguous", *NOMINAL, LENGTH, dataset=root / "data-smooth")
    other = diagnosed(
        root, "rough", "unexplained", rough, *NOMINAL[1:], reason="Something <odd> is left."
    )
    return first, again, other


@pytest.fixture(scope="module")
def changed(folders):
    return comparison_page(compare(folders[0], folders[2]))


@pytest.fixture(scope="module")
def extended(folders):
    return comparison_page(compare(folders[0], folders[1]))


def test_every_plot_says_what_it_shows(extended):
    labels = Outline(extended).labels
    assert labels[0].startswith("Values of A and B with 95 % intervals")
    assert "friction_coefficient: A 0.1250, B 0.1250" in labels[0]
    of_runs = [label for label in labels if label.startswith("Run ")]
    assert [label.split(":")[0] for label in of_runs] == ["Run a", f"Run {HOSTILE}"]
    assert all(re.search(r"f_in_N A [\d.]+, B [\d.]+ N", label) for label in of_runs)


def test_names_from_files_show_as_text_and_nothing_is_asked_from_the_network(changed, extended):
    for page in (changed, extended):
        assert all(address.startswith("#") for address in Outline(page).addresses)
        assert "&lt;script&gt;$x$" in page
        assert "bench &amp; &lt;b&gt;" in page
        assert not re.search(r"https?:|@import|url\((?!#)|<script", without_script(page))
    assert "Something &lt;odd&gt; is left." in changed


def test_a_difference_beyond_the_uncertainty_comes_first_and_is_marked(changed):
    summary = re.search(r'<p class="summary">(.*?)</p>', changed, re.DOTALL)[1]
    assert summary.startswith("friction_coefficient is larger in B, by 0.0250 [0.0222, 0.0278]")
    assert "friction_coefficient *" in changed
    assert "load_stiffness_N_per_mm *" not in changed
    assert ">0.0250 [0.0222, 0.0278]</td>" in changed
    assert changed.count('<td class="short">yes</td>') == 1


def test_the_same_recordings_make_no_claim_and_others_are_shown_each_on_its_own(extended, changed):
    assert "their errors are not independent" in extended
    assert '<td class="short">yes</td>' not in extended
    assert "friction_coefficient *" not in extended
    assert "No recording is in both" in changed
    assert 'id="residuals"' not in changed


def test_effects_and_their_rivals_stand_beside_each_other(extended, folders):
    effects = record_of(compare(folders[0], folders[1])).effects
    assert [one.content() for one in effects] == [
        {"effect": "free_tendon", "a": "", "b": "named"},
        {"effect": "drive_compliance", "a": "", "b": "rival of free_tendon"},
    ]
    assert "rival of free_tendon" in extended


def test_errors_on_held_out_data_stand_beside_each_other(folders):
    (f_in, *_) = record_of(compare(folders[0], folders[2])).held_out
    assert f_in.channel == "f_in_N"
    assert (f_in.rmse_a, f_in.rmse_b) == pytest.approx((0.1, 0.62))


@pytest.mark.usefixtures("undrawn")
def test_a_simulation_stands_beside_a_diagnosis_without_values(folders, tmp_path):
    dataset = folders[0].parent / "data-smooth"
    simulated = make_simulation(dataset, tmp_path / "simulated")
    it = compare(simulated, folders[0])
    page = comparison_page(it)
    assert it.pairs == []
    assert [both.ids for both in it.shared] == [(r.id,) * 2 for r in read_dataset(dataset).runs]
    assert 'id="values"' not in page
    assert 'id="residuals"' in page
    assert "does not hold its model" in page
