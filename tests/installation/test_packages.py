"""What is installed, told from folders that look like installed packages."""

import pytest

from tsas_cli.installation.packages import core_packages, extras

CORE = """Metadata-Version: 2.4
Name: tsas
Version: 0.1.0
Requires-Python: {python}
Requires-Dist: {core}
Provides-Extra: mat
Provides-Extra: all
Requires-Dist: madeup-reader>=3; extra == "mat"
Requires-Dist: madeup-reader>=3; extra == "all"
Requires-Dist: madeup-core>=1; extra == "all"
"""


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """Install a project that asks for made-up packages, and some of these."""
    monkeypatch.syspath_prepend(str(tmp_path))

    def install(core="madeup-core>=1.5,<3", python=">=3.11", module="", **versions):
        (tmp_path / "tsas-0.1.0.dist-info").mkdir()
        text = CORE.format(core=core, python=python)
        (tmp_path / "tsas-0.1.0.dist-info" / "METADATA").write_text(text)
        for name, version in versions.items():
            (tmp_path / f"{name}-{version}.dist-info").mkdir()
            head = f"Metadata-Version: 2.1\nName: {name.replace('_', '-')}\nVersion: {version}\n"
            (tmp_path / f"{name}-{version}.dist-info" / "METADATA").write_text(head)
            (tmp_path / f"{name}.py").write_text(module)

    return install


def problems():
    return {p.name: (p.found, p.problem) for p in core_packages() if p.problem}


def test_what_is_as_asked_for_is_there(installed):
    installed(madeup_core="1.5")
    assert problems() == {}
    assert [p.asked for p in core_packages()] == [">=3.11", "<3,>=1.5"]


def test_a_missing_package_is_missing(installed):
    installed()
    assert problems() == {"madeup-core": (None, "missing")}


@pytest.mark.parametrize("version", ["1.4.9", "3.0"])
def test_a_version_outside_is_wrong(installed, version):
    installed(madeup_core=version)
    assert problems() == {"madeup-core": (version, "wrong version")}


def test_a_python_that_is_too_old_is_wrong(installed):
    installed(python=">=4", madeup_core="2")
    assert list(problems()) == ["Python"]


def test_a_package_that_cannot_be_loaded_says_why(installed):
    installed(
        core="madeup-broken", madeup_broken="2", module="raise OSError('libgone.so: not there')"
    )
    (problem,) = problems().values()
    assert problem == ("2", "cannot be loaded: OSError: libgone.so: not there")


def test_an_extra_lists_what_it_lacks_and_nothing_of_the_core(installed):
    installed(madeup_core="2", madeup_reader="2.9")
    assert {e.name: e.missing for e in extras()} == {
        "mat": ("madeup-reader",),
        "all": ("madeup-reader",),
    }


def test_an_extra_that_is_there_lacks_nothing(installed):
    installed(madeup_core="2", madeup_reader="3.1")
    assert [e.missing for e in extras()] == [(), ()]
