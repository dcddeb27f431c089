"""Tries one input in a process of its own, under the rules of a search."""

import sys
from importlib import import_module
from pathlib import Path

from tests.fuzz import foreign
from tests.fuzz.child import warm_up
from tests.fuzz.rules import Watch


def main() -> None:
    """`python -m tests.fuzz.once TARGET FILE [here-too]`: fail where the input breaks a rule."""
    name, path, *more = sys.argv[1:]
    target, data = import_module(name), Path(path).read_bytes()
    warm_up(target)
    foreign.here_too = bool(more)
    with Watch().during():
        target.one(data)


if __name__ == "__main__":
    main()
