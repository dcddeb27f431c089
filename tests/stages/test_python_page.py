"""docs/python.md: its lines are run, and print what stands there."""

import doctest
import re
from pathlib import Path

import tsas_cli as tsas

PAGE = Path(__file__).parents[2] / "docs" / "python.md"
NUMBER = re.compile(r"-?\d+\.\d+(?:e-?\d+)?")
NEAR = 0.03  # of a number, which the last digits of a fit may move


class NearNumbers(doctest.OutputChecker):
    """Takes text as it is, and numbers with a point as near enough."""

    def check_output(self, want, got, optionflags):
        if NUMBER.sub("#", " ".join(want.split())) != NUMBER.sub("#", " ".join(got.split())):
            return False
        told, found = (list(map(float, NUMBER.findall(text))) for text in (want, got))
        return all(abs(a - b) <= NEAR * abs(a) for a, b in zip(told, found, strict=True))


def test_its_lines_print_what_stands_there(monkeypatch):
    monkeypatch.chdir(PAGE.parents[1])
    text = PAGE.read_text(encoding="utf-8")
    lines = "\n".join(re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL))
    test = doctest.DocTestParser().get_doctest(lines, {}, "python.md", str(PAGE), 0)
    said = []
    runner = doctest.DocTestRunner(checker=NearNumbers(), verbose=False)
    runner.run(test, out=said.append)
    assert len(test.examples) > 15
    assert runner.failures == 0, "".join(said)


def test_numbers_that_differ_are_seen():
    near = NearNumbers().check_output
    assert near("a  1.00 N\n", "a 1.01 N\n", 0)
    assert not near("a 1.00 N\n", "a 1.20 N\n", 0)
    assert not near("a 1.00 N\n", "b 1.00 N\n", 0)
    assert not near("3 rows\n", "4 rows\n", 0)


def test_it_lists_every_call():
    text = PAGE.read_text(encoding="utf-8")
    listed = set(re.findall(r"`tsas\.(\w+)", text))
    assert listed == set(tsas.__all__) - {"Steps"}
