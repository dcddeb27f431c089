"""What is installed is said to the last byte, and lies in the bounds that pyproject.toml names."""

import re

import pytest
from packaging.version import Version

from requirements.locked import LOCK, ROOT, asked, locked, uses

PACKAGES = locked()
BOUNDS = [requirement for listed in asked().values() for requirement in listed]


def test_every_version_is_exact_and_has_hashes():
    assert len(PACKAGES) > 90
    assert [str(p.requirement) for p in PACKAGES if p.version is None] == []
    assert [p.name for p in PACKAGES if not p.hashes] == []
    assert sum(len(p.hashes) for p in PACKAGES) == LOCK.read_text().count("--hash=")


def test_nothing_but_versions_and_hashes_stands_in_it():
    meant = re.compile(r"^([\w.-]+==\S+( ; .*)? \\|    --hash=sha256:[0-9a-f]{64}( \\)?|    # .*)$")
    assert [line for line in LOCK.read_text().splitlines() if not meant.match(line)] == []


@pytest.mark.parametrize("bound", BOUNDS, ids=lambda bound: bound.name)
def test_what_the_project_asks_for_is_locked_within_its_bounds(bound):
    versions = [p.version for p in PACKAGES if p.name == bound.name]
    assert versions
    assert [v for v in versions if Version(v) not in bound.specifier] == []


def test_one_version_at_a_time_is_chosen():
    for package in PACKAGES:
        others = [p for p in PACKAGES if p.name == package.name]
        assert len(others) == 1 or all(p.requirement.marker for p in others), package.name
        for python in ("3.11.7", "3.12.1", "3.13.0"):
            place = {"python_full_version": python, "python_version": python.rsplit(".", 1)[0]}
            markers = [p.requirement.marker for p in others]
            assert sum(m is None or m.evaluate(place) for m in markers) <= 1, package.name


def test_every_package_is_there_for_a_reason():
    used = uses(PACKAGES)
    assert {p.name for p in PACKAGES} == set(used)
    assert used["numpy"] == "run"
    assert used["llvmlite"] == "run"
    assert used["asammdf"] == "extra"
    assert used["pytest"] == "development"


def test_the_setup_installs_nothing_whose_hash_is_not_known():
    setup = (ROOT / "pipelines" / "setup.mk").read_text()
    installs = re.findall(r"\$\(PIP\) install (.*)", setup)
    assert installs == [
        "--require-hashes --requirement requirements/lock.txt",
        "--no-deps --no-build-isolation --editable .",
    ]
