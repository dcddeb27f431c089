"""Mutation testing itself: which mutants there are, which are drawn, how the score is given."""

import json
from pathlib import Path

import pytest

from benchmarks.mutants.judge import BENCHES, Reached
from benchmarks.mutants.mutations import mutants, sample, statements
from benchmarks.mutants.verdicts import equivalents, lines

ROOT = Path(__file__).parents[2]
SMALL = "tsas_cli/physics/closed_form/capstan.py"
PATHS = [SMALL, "tsas_cli/physics/mesh.py", "tsas_cli/diagnosis/evidence.py"]
SOURCE = """
def f(x: int | None, *, low: float = 1.0) -> float | None:
    if (
        x is None
        or x > 3
    ):
        return low + 2.0
    return None


@dataclass(frozen=True)
class A:
    pairs = zip("ab", "cd", strict=True)
"""


@pytest.fixture
def made(tmp_path):
    (tmp_path / "made.py").write_text(SOURCE)
    return tmp_path


def test_a_mutant_is_one_change_and_none_is_in_an_annotation_or_a_guard(made):
    found = mutants(made, "made.py")
    texts = {mutant.source(made) for mutant in found}
    assert len(texts) == len(found)
    for mutant in found:
        assert "x: int | None, *, low: float =" in mutant.source(made)
        assert mutant.source(made).endswith(SOURCE.rpartition("None")[2])
        before, after = mutant.change(made)
        assert before != after
        assert SOURCE.replace(before, after, 1) == mutant.source(made)
    changed = {mutant.change(made)[1] for mutant in found}
    assert {"return low - 2.0", "return low + 3.0", "x is not None", "or x >= 3"} <= changed


def test_a_mutant_knows_the_lines_of_its_statement():
    of = statements(SOURCE)
    assert of[5] == of[3] == (3, 4, 5, 6)
    assert of[7] == (7,)


def test_a_sample_has_its_size_and_a_share_of_each_file():
    drawn = sample(ROOT, PATHS, 30, seed=3)
    assert len(set(drawn)) == len(drawn) == 30
    total = sum(len(mutants(ROOT, path)) for path in PATHS)
    for path in PATHS:
        share = 30 * len(mutants(ROOT, path)) / total
        assert abs(sum(mutant.path == path for mutant in drawn) - share) < 1.0
    assert drawn == sample(ROOT, PATHS, 30, seed=3)
    assert set(drawn) != set(sample(ROOT, PATHS, 30, seed=4))
    assert set(drawn) < set(sample(ROOT, PATHS, 60, seed=3))
    assert len(sample(ROOT, PATHS, 10**6, seed=3)) == total


def test_every_line_with_an_equivalent_mutant_still_stands():
    """Else it has changed, and the mutant has to be judged again."""
    known = equivalents()
    for path, before, _ in known:
        assert before in {line.strip() for line in (ROOT / path).read_text().splitlines()}
    assert all(len(reason) > 20 for reason in known.values())


@pytest.mark.large
def test_every_equivalent_mutant_still_can_be_made():
    known = equivalents()
    for path in {path for path, _, _ in known}:
        lines = (ROOT / path).read_text().splitlines()
        changes = {(before, after) for name, before, after in known if name == path}
        of = {before for before, _ in changes}
        there = [m for m in mutants(ROOT, path) if lines[m.line - 1].strip() in of]
        assert changes <= {mutant.change(ROOT) for mutant in there}


def verdict(outcome, name="tsas_cli/physics/a.py"):
    return {
        "mutant": f"{name}:1 X 0",
        "path": name,
        "outcome": outcome,
        "before": "a + b",
        "after": "a - b",
        "why": "3 tests",
    }


def test_the_table_counts_and_shows_who_lives():
    told = [verdict(o) for o in ("killed", "killed", "timed out", "survived")]
    text = list(lines(told))
    rows = {line.split()[0]: line.split()[1:] for line in text if line.startswith("  ")}
    assert rows["physics/a.py"][:6] == ["4", "2", "1", "1", "0", "75"]
    assert rows["all"] == rows["physics"] == rows["physics/a.py"]
    assert text[-2:] == ["- a + b", "+ a - b"]


def test_the_tests_that_judge_are_those_that_run_the_line_the_quick_ones_first(made):
    package = made / "tsas_cli" / "physics"
    package.mkdir(parents=True)
    (package / "made.py").write_text(SOURCE)
    (package / "user.py").write_text("from tsas_cli.physics.made import f\n")
    quick, slow = "tests/physics/test_other.py::quick", "tests/physics/test_made.py::slow"
    late = "tests/physics/test_other.py::late"
    reach = {
        "times_s": {quick: 0.1, slow: 1.0, late: 30.0},
        "lines": {
            "tsas_cli/physics/made.py": {"2": [""], "3": ["", quick, slow, late], "8": [slow]},
            "tsas_cli/physics/user.py": {"1": ["", quick]},
        },
    }
    for name, text in (("made", "from tsas_cli.physics.made import f\n"), ("other", "")):
        file = made / "tests" / "physics" / f"test_{name}.py"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    file = made / "reach.json"
    file.write_text(json.dumps(reach))
    reached = Reached([file], made)
    by_line = {mutant.line: mutant for mutant in mutants(made, "tsas_cli/physics/made.py")}
    assert reached.tests(by_line[5], 20.0) == [quick, slow]  # late alone takes more
    assert reached.tests(by_line[7], 20.0) == []
    assert reached.tests(by_line[2], 20.0) == [quick, slow]
    assert reached.quick([quick, slow]) == [quick]


def test_every_module_of_a_package_is_mutated():
    mutated = {file for bench in BENCHES for file in bench.sources(ROOT)}
    assert {"tsas_cli/physics/slip/step.py", "tsas_cli/diagnosis/proven.py"} < mutated
