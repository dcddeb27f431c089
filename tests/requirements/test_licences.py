"""Every licence is known, listed, and one that Apache-2.0 may be combined with."""

import pytest

from requirements import licences
from requirements.licences import ALLOWED, PAGE, READ, licence, page, refused
from requirements.locked import locked, uses


def test_the_list_is_current():
    assert PAGE.read_text(encoding="utf-8") == page(), "run make licences"


def test_no_licence_is_outside_of_what_is_allowed():
    found = {n: refused(licence(n), use) for n, use in uses(locked()).items()}
    assert {n: parts for n, parts in found.items() if parts} == {}


@pytest.mark.parametrize(
    ("expression", "use", "parts"),
    [
        ("MIT", "run", []),
        ("MIT AND (BSD-3-Clause OR GPL-2.0-only)", "run", []),
        ("MIT OR GPL-3.0-only", "run", []),
        ("MIT AND GPL-3.0-only", "run", ["GPL-3.0-only"]),
        ("LGPL-3.0-or-later", "run", ["LGPL-3.0-or-later"]),
        ("LGPL-3.0-or-later", "extra", []),
        ("AGPL-3.0-only", "development", ["AGPL-3.0-only"]),
    ],
)
def test_an_expression_is_held_to_its_use(expression, use, parts):
    assert refused(expression, use) == parts


def test_no_strong_copyleft_is_allowed_anywhere():
    assert not [name for allowed in ALLOWED.values() for name in allowed if name.startswith("GPL")]


def test_a_package_that_says_nothing_is_refused(monkeypatch, tmp_path):
    (tmp_path / "madeup-1.0.dist-info").mkdir()
    told = "Metadata-Version: 2.1\nName: madeup\nVersion: 1.0\nLicense: own terms\n"
    (tmp_path / "madeup-1.0.dist-info" / "METADATA").write_text(told)
    monkeypatch.syspath_prepend(str(tmp_path))
    with pytest.raises(licences.UnknownLicenceError, match="own terms"):
        licence("madeup")
    with pytest.raises(licences.UnknownLicenceError, match="not installed"):
        licence("nobody-has-this")


def test_only_locked_packages_were_read_by_hand():
    assert set(READ) <= {package.name for package in locked()}
