"""What a benchmark takes from the program and its studies is there: no other test imports it."""

from importlib import import_module
from pkgutil import walk_packages

import pytest

import benchmarks


@pytest.mark.parametrize(
    "name", [found.name for found in walk_packages(benchmarks.__path__, "benchmarks.")]
)
def test_a_module_can_be_imported(name):
    assert import_module(name).__doc__
