"""The list of checks is complete, and the manual says what the checks say."""

import sys
from importlib import import_module
from pathlib import Path

from tsas_cli.recordings import quality

ROOT = Path(__file__).parents[3]
CODES = [check.code for check in quality.CHECKS]
EXPLAINED = {c.code: sys.modules[c.find.__module__].__doc__.strip() for c in quality.CHECKS}


def test_every_file_is_in_the_list_under_its_own_name():
    folder = Path(quality.__file__).parent / "checks"
    files = {path.stem.replace("_", "-") for path in folder.glob("[!_]*.py")}
    assert len(CODES) == len(set(CODES))
    assert set(CODES) == files
    for check in quality.CHECKS:
        module = import_module(f"{quality.__name__}.checks.{check.code.replace('-', '_')}")
        assert module.CHECK is check


def test_the_manual_lists_the_checks_in_order_with_their_first_line():
    rows = [f"| `{code}` | {said.splitlines()[0]} |" for code, said in EXPLAINED.items()]
    manual = (ROOT / "docs" / "check.md").read_text(encoding="utf-8").splitlines()
    assert [line for line in manual if line.startswith("| `")][: len(rows)] == rows


def test_each_explanation_says_more_than_one_line():
    assert all(len(said.splitlines()) > 2 for said in EXPLAINED.values())
