"""The list of checks is complete, and the manual says what the checks say."""

from importlib import import_module
from inspect import getdoc, getmembers, isfunction
from pathlib import Path
from pkgutil import iter_modules

import pytest

from tsas_cli.recordings import quality
from tsas_cli.recordings.quality import checks

ROOT = Path(__file__).parents[3]
EXPLAINED = {check.code: getdoc(check.find) for check in quality.CHECKS}
MODULES = [import_module(f"{checks.__name__}.{m.name}") for m in iter_modules(checks.__path__)]


@pytest.mark.parametrize("module", MODULES)
def test_every_function_of_the_checks_is_in_the_list(module):
    public = {
        name.replace("_", "-")
        for name, function in getmembers(module, isfunction)
        if function.__module__ == module.__name__ and not name.startswith("_")
    }
    assert public <= set(quality.CODES)
    assert len(quality.CODES) == len(set(quality.CODES))


def test_the_manual_lists_the_checks_in_order_with_their_first_line():
    rows = [f"| `{code}` | {said.splitlines()[0]} |" for code, said in EXPLAINED.items()]
    manual = (ROOT / "docs" / "check.md").read_text(encoding="utf-8").splitlines()
    assert [line for line in manual if line.startswith("| `")][: len(rows)] == rows


def test_each_explanation_says_more_than_one_line():
    assert all(len(said.splitlines()) > 2 for said in EXPLAINED.values())
