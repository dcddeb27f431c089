import pytest

from tsas_cli.reporting.viewer.open import NOTE, SCREENS, has_screen, note_once


@pytest.fixture
def state(tmp_path, monkeypatch):
    monkeypatch.setenv("TSAS_STATE_DIR", str(tmp_path / "state"))
    return tmp_path / "state"


def test_it_is_said_once_to_each_user_and_names_the_command(state, monkeypatch):
    assert "rerun analytics disable" in NOTE
    assert [note_once(), note_once(), note_once()] == [NOTE, "", ""]
    monkeypatch.setenv("TSAS_STATE_DIR", str(state / "other"))
    assert note_once() == NOTE


def test_where_nothing_can_be_remembered_it_is_said_each_time(state):
    state.write_text("a file")
    assert [note_once(), note_once()] == [NOTE, NOTE]


@pytest.mark.parametrize(
    ("system", "named", "expected"),
    [
        ("linux", None, False),
        ("linux", "DISPLAY", True),
        ("linux", "WAYLAND_DISPLAY", True),
        ("darwin", None, True),
    ],
)
def test_a_screen_is_what_the_system_says(monkeypatch, system, named, expected):
    monkeypatch.setattr("sys.platform", system)
    for name in SCREENS:
        monkeypatch.setenv(name, ":0" if name == named else "")
    assert has_screen() is expected
