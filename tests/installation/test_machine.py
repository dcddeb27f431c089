import pytest

from tsas_cli.installation import machine
from tsas_cli.installation.machine import abilities
from tsas_cli.numerics import side_by_side
from tsas_cli.numerics.compiled import cache_folder
from tsas_cli.reporting.viewer.open import SCREENS
from tsas_cli.support.errors import InputError
from tsas_cli.support.limits import THREADS


@pytest.fixture
def told(monkeypatch):
    """Tell what this machine can do, without drawing."""
    monkeypatch.setattr(machine, "drawn_with", lambda: "Vulkan on a card")
    cache_folder.cache_clear()
    yield lambda: {a.name: a for a in abilities()}
    cache_folder.cache_clear()


def test_the_cache_says_where_it_is_and_how_large(told, tmp_path, monkeypatch):
    monkeypatch.setenv("TSAS_CACHE_DIR", str(tmp_path))
    first = told()["compiled code"]
    assert first.works
    assert first.found.startswith(str(tmp_path))
    assert "empty" in first.found
    (next((tmp_path / "kernels").iterdir()) / "kernel.nbc").write_bytes(bytes(2_500_000))
    assert told()["compiled code"].found.endswith("2.5 MB")


def test_a_cache_that_cannot_be_written_says_what_to_do(told, tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv("TSAS_CACHE_DIR", str(tmp_path / "file"))
    found = told()["compiled code"]
    assert not found.works
    assert "TSAS_CACHE_DIR" in found.remedy


def test_threads_are_as_asked_for(told, monkeypatch):
    monkeypatch.setenv(THREADS, "7")
    assert told()["threads"].found.startswith("7 of ")
    monkeypatch.setenv(THREADS, "many")
    assert not told()["threads"].works
    with pytest.raises(InputError, match="TSAS_THREADS is 'many'"):
        side_by_side.each(str, [1, 2])


def test_a_viewer_that_cannot_draw_says_what_to_install(told, monkeypatch):
    def nothing():
        raise InputError("finds nothing to draw with", remedy="apt install vulkan")

    monkeypatch.setattr(machine, "drawn_with", nothing)
    found = told()["drawing"]
    assert (found.works, found.found) == (False, "finds nothing to draw with")
    assert found.remedy == "apt install vulkan"


def test_a_screen_is_named(told, monkeypatch):
    for name in SCREENS:
        monkeypatch.setenv(name, "")
    monkeypatch.setattr("sys.platform", "linux")
    assert not told()["screen"].works
    monkeypatch.setenv("DISPLAY", ":3")
    assert told()["screen"].found == "DISPLAY=:3"


def test_a_browser_is_found_by_any_of_its_names(told, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    assert not told()["Chromium"].works
    program = tmp_path / "google-chrome"
    program.touch(mode=0o755)
    assert told()["Chromium"].found == str(program)
