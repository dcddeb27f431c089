"""The baselines name what is hidden where it is plain, each by its own rule."""

import json
import math
import sys

import numpy as np
import pytest
from scipy.signal import lfilter

from tsas_cli.diagnosis.held_out import folds_of
from tsas_cli.effects import EFFECTS
from tsas_cli.identification.fit import Solution
from tsas_cli.identification.fit_problem import unknown_of
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.prepared import prepare
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.support.errors import InputError
from tsas_studies.challenge.baselines import information_criterion, write_diagnosis
from tsas_studies.challenge.cases import Case, Hidden
from tsas_studies.challenge.entry import read_entry
from tsas_studies.challenge.library import terms
from tsas_studies.challenge.make import make
from tsas_studies.challenge.run import TOOLS
from tsas_studies.challenge.sparse import regression

HIDDEN = Hidden("drive_friction", {"friction_N": 1.5})
BASELINES = [name for name in TOOLS if name != "diagnose"]


@pytest.fixture(scope="module")
def sealed(tmp_path_factory):
    """A set of one case with hidden friction and one with nothing hidden."""
    out = tmp_path_factory.mktemp("set")
    cases = (Case("friction", "one", 1.0, (HIDDEN,), 5, 0), Case("plain", "nothing", 0.0, (), 5, 1))
    make(out, cases, rate_Hz=30.0)
    answers = json.loads((out / "answers.json").read_text(encoding="utf-8"))["cases"]
    return {case["name"]: out / "cases" / name / "dataset" for name, case in answers.items()}


def answer(tool, dataset, folder):
    folder.mkdir(parents=True)
    TOOLS[tool](dataset, folder / "case")
    return read_entry(folder, ["case"]).diagnoses["case"]


@pytest.mark.parametrize(
    "tool", [pytest.param(t, marks=pytest.mark.large if t == "bic" else ()) for t in BASELINES]
)
def test_a_plain_cause_is_named_first(tool, sealed, tmp_path):
    said = answer(tool, sealed["friction"], tmp_path / tool)
    assert said.verdict == "named"
    assert said.named[0].effect == HIDDEN.cause
    (found,) = said.named[0].parameters.values()
    assert found.value == pytest.approx(1.5, rel=0.05)
    assert found.stderr > 0.0


def trial(names, jacobian, values, residual):
    """A fit that ended at these scaled values."""
    bound = np.zeros(len(names), dtype=bool)
    solution = Solution(np.array(values), bound, residual, jacobian, True, "", 1)
    unknowns = tuple(unknown_of(name) for name in names)
    return HypothesisFit((), unknowns, solution, (residual.size,), on_mesh=False)


def test_bic_is_schwarzs():
    residual = np.array([1.0, -2.0, 3.0, -2.0])
    names = ("proximal_spring.stiffness_N_per_mm", "backlash.play_mm")
    fit = trial(names, np.eye(4)[:, :2], (0.0, 0.0), residual)
    assert information_criterion(fit) == pytest.approx(4 * math.log(18 / 4) + 2 * math.log(4))


def test_errors_are_those_of_the_plain_formula(tmp_path):
    """A line through the origin: the error of its slope is s/√Σx²; 2 N/mm is the size of 1."""
    x, residual = np.arange(1.0, 5.0), np.array([0.1, -0.2, 0.1, 0.0])
    name = "drive_compliance.compliance_mm_per_N"
    fit = trial((name,), x[:, None], (3.0,), residual)
    write_diagnosis(tmp_path / "case", fit, {"drive_compliance": ["free_tendon"]})
    (named,) = read_entry(tmp_path, ["case"]).diagnoses["case"].named
    size = 0.002  # the start of this parameter, in which a fit counts
    (estimate,) = named.parameters.values()
    assert named.rivals == ("free_tendon",)
    assert estimate.value == pytest.approx(3.0 * size)
    expected = math.sqrt(float(residual @ residual) / 3) / math.sqrt(30.0)
    assert estimate.stderr == pytest.approx(expected * size)


def test_nothing_named_is_sufficient(tmp_path):
    write_diagnosis(tmp_path / "case", trial((), np.zeros((4, 0)), (), np.ones(4)), {})
    said = read_entry(tmp_path, ["case"]).diagnoses["case"]
    assert (said.verdict, said.named, said.warns) == ("sufficient", (), False)


def test_every_effect_has_a_term_and_every_run_the_same(sealed):
    listed = [
        [(term.effect, term.text, *term.channels) for term in terms(prepare(recording))]
        for recording in read_dataset(sealed["plain"])
    ]
    without = {effect.name for effect in EFFECTS} ^ {effect for effect, *_ in listed[0]}
    assert not without, "terms() of tsas_studies/challenge/library.py has one for each effect"
    assert all(each == listed[0] for each in listed)


@pytest.mark.parametrize("seed", range(5))
def test_a_sparse_regression_keeps_what_is_there_and_nothing_else(seed):
    rng = np.random.default_rng(seed)
    columns = rng.normal(size=(4000, 30))
    columns /= np.linalg.norm(columns, axis=0)
    folds = folds_of([np.arange(1000) // 50] * 4)
    truth = np.zeros(30)
    truth[[4, 17]] = 40.0, -15.0
    found = regression(columns, columns @ truth + rng.normal(size=4000), folds)
    assert np.flatnonzero(found).tolist() == [4, 17]
    assert found[[4, 17]] == pytest.approx([40.0, -15.0], abs=5.0)
    assert not regression(columns, rng.normal(size=4000), folds).any()


def test_without_pysindy_the_line_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "pysindy", None)
    folds = folds_of([np.arange(10)] * 3)
    with pytest.raises(InputError, match="pysindy") as error:
        regression(np.eye(30), np.ones(30), folds)
    assert "tsas[challenge]" in error.value.line()


def memory(rng, correlation, count):
    """Noise of unit variance in which neighbours are alike."""
    news = rng.normal(size=count) * math.sqrt(1.0 - correlation**2)
    news[0] = rng.normal()
    return lfilter([1.0], [1.0, -correlation], news)


@pytest.mark.parametrize(("correlation", "least", "most"), [(0.0, 0.0, 0.05), (0.99, 0.5, 1.0)])
def test_bic_per_sample_accepts_what_is_not_there_where_noise_has_memory(correlation, least, most):
    """A slow signal that has nothing to do with a residual; see docs/challenge.md."""
    accepted = 0
    for seed in range(100):
        rng = np.random.default_rng(seed)
        residual, candidate = memory(rng, correlation, 10_000), memory(rng, 0.99, 10_000)
        left = residual - candidate * (candidate @ residual) / (candidate @ candidate)
        name = "proximal_spring.stiffness_N_per_mm"
        before = trial((), np.zeros((10_000, 0)), (), residual)
        after = trial((name,), candidate[:, None], (0.0,), left)
        accepted += information_criterion(after) < information_criterion(before)
    assert least <= accepted / 100 <= most
