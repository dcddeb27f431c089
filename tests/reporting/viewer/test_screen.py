import pytest

from tsas_cli.reporting.viewer.screen import SCREENS, has_screen


@pytest.mark.parametrize(
    ("system", "named", "expected"),
    [
        ("linux", None, False),
        ("linux", "DISPLAY", True),
        ("linux", "WAYLAND_DISPLAY", True),
        ("darwin", None, True),
        ("win32", None, True),
    ],
)
def test_a_screen_is_what_the_system_says(monkeypatch, system, named, expected):
    monkeypatch.setattr("sys.platform", system)
    for name in SCREENS:
        monkeypatch.setenv(name, ":0" if name == named else "")
    assert has_screen() is expected
