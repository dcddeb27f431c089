import errno
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
import typer

import tsas_cli
import tsas_cli.app
import tsas_studies
import tsas_studies.commands
from tsas_cli.support.errors import InputError

Tsas = Callable[..., subprocess.CompletedProcess[str]]
HEAVY = {
    "asammdf",
    "control",
    "h5py",
    "jinja2",
    "matplotlib",
    "numba",
    "numpy",
    "pandas",
    "pint",
    "pyarrow",
    "pydantic",
    "rerun",
    "scipy",
    "tomlkit",
}
HELPERS = {"__init__", "common", "completion", "live", "progress"}  # files that are no command
COMMANDS = typer.main.get_command(tsas_studies.commands.app).commands  # type: ignore[attr-defined]
CALLS = {  # `tsas challenge` is a group: its commands stand in its place
    f"{name} {inner}".strip(): call
    for name, command in COMMANDS.items()
    for inner, call in getattr(command, "commands", {"": command}).items()
}


def fail_with(error: Exception, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let every call of the command line end in an error."""

    def app(**_: object) -> None:
        raise error

    monkeypatch.setattr(tsas_cli.app, "app", app)


def test_version_and_help_succeed(tsas: Tsas) -> None:
    version = tsas("--version")
    assert (version.returncode, version.stdout) == (0, f"tsas {tsas_cli.__version__}\n")
    page = tsas("--help")
    assert page.returncode == 0
    for name in COMMANDS:
        assert name in page.stdout


def test_help_loads_no_library_that_it_does_not_need() -> None:
    program = "import tsas_cli.app, sys, json; print(json.dumps(list(sys.modules)))"
    loaded = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert HEAVY & {name.split(".")[0] for name in json.loads(loaded.stdout)} == set()


def test_each_command_is_in_a_panel_of_the_help(tsas: Tsas) -> None:
    panels = {name: command.rich_help_panel for name, command in COMMANDS.items()}
    assert set(panels.values()) == set(tsas_cli.app.PANELS)
    assert panels["reproduce"] == panels["challenge"] == tsas_cli.app.STUDIES
    page = tsas("--help").stdout
    places = [page.find(f"─ {panel} ─") for panel in tsas_cli.app.PANELS]
    assert -1 not in places
    assert places == sorted(places)
    assert "─ Commands ─" not in page


def test_every_command_file_is_a_command() -> None:
    homes = (Path(package.__file__).parent for package in (tsas_cli, tsas_studies))
    files = {path.stem for home in homes for path in (home / "commands").glob("*.py")}
    assert {name.replace("-", "_") for name in COMMANDS} == files - HELPERS


@pytest.mark.parametrize("name", CALLS)
def test_every_command_explains_itself_and_can_be_quiet_or_print_json(name: str) -> None:
    command = CALLS[name]
    options = {option for parameter in command.params for option in parameter.opts}
    assert {"--quiet", "--json"} <= options
    assert command.help
    assert all(p.help for p in command.params if p.name != "help")


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (["nope"], "tsas: No such command 'nope'"),
        (["--nope"], "tsas: No such option: --nope"),
        (["report", "--out"], "tsas: Option '--out' requires an argument"),
    ],
)
def test_a_wrong_call_is_one_line_that_names_the_help(
    tsas: Tsas, call: list[str], told: str
) -> None:
    result = tsas(*call)
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr.startswith(told)
    assert result.stderr.endswith("--help`\n")
    assert result.stderr.count("\n") == 1


def test_no_command_at_all_prints_the_help(tsas: Tsas) -> None:
    result = tsas()
    assert result.returncode == 2
    assert "Usage: tsas" in result.stdout + result.stderr


def test_a_wrong_input_is_one_line_and_exit_code_2(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    fail_with(InputError("no\nsuch run", where="a\x1b[31m"), monkeypatch)
    with pytest.raises(SystemExit) as stopped:
        tsas_cli.app.run()
    assert stopped.value.code == 2
    assert capsys.readouterr() == ("", "tsas: a\\x1b[31m: no\\nsuch run\n")


def test_a_defect_is_one_line_and_exit_code_1(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("TSAS_TRACEBACK", raising=False)
    fail_with(ZeroDivisionError("two\nlines"), monkeypatch)
    with pytest.raises(SystemExit) as stopped:
        tsas_cli.app.run()
    assert stopped.value.code == 1
    error = capsys.readouterr().err
    assert error.startswith("tsas: a defect of tsas itself: ZeroDivisionError: two\\nlines; ")
    assert "TSAS_TRACEBACK=1" in error
    assert error.count("\n") == 1


def test_a_defect_shows_its_traceback_where_it_is_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("TSAS_TRACEBACK", "1")
    fail_with(ZeroDivisionError("here"), monkeypatch)
    with pytest.raises(ZeroDivisionError, match="here"):
        tsas_cli.app.run()


def test_a_reader_that_goes_away_is_no_error() -> None:
    reader, writer = os.pipe()
    os.close(reader)
    call = [sys.executable, "-m", "tsas_cli", "--version"]
    result = subprocess.run(call, stdout=writer, stderr=subprocess.PIPE, check=False)
    os.close(writer)
    assert (result.returncode, result.stderr) == (0, b"")


@pytest.mark.parametrize("closed", ["2>&-", "<&- >&- 2>&-"])
def test_a_closed_stream_loses_what_is_printed_and_nothing_else(tmp_path: Path, closed) -> None:
    out = tmp_path / "map.toml"
    (tmp_path / "a.csv").write_text("time [s],x [mm]\n0,1\n0.1,2\n0.2,3\n0.3,4\n")
    call = f'"{sys.executable}" -m tsas_cli ingest a.csv --guess --out map.toml {closed}'
    done = subprocess.run(["sh", "-c", call], cwd=tmp_path, check=False)  # noqa: S607
    assert done.returncode == 0
    assert "[columns.x_in_mm]" in out.read_text(encoding="utf-8")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is full")
def test_no_room_for_what_is_printed_is_one_line() -> None:
    call = [sys.executable, "-m", "tsas_cli", "effects"]
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(call, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "the system refuses the call (No space left on device)" in done.stderr


def test_no_more_open_files_is_no_defect(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    fail_with(OSError(errno.EMFILE, os.strerror(errno.EMFILE), "a.parquet"), monkeypatch)
    with pytest.raises(SystemExit) as stopped:
        tsas_cli.app.run()
    assert stopped.value.code == 2
    assert capsys.readouterr().err.startswith(
        "tsas: a.parquet: the system refuses the call (Too many"
    )


@pytest.mark.parametrize(
    ("number", "remedy"),
    [(errno.EACCES, "ask its owner"), (errno.ENAMETOOLONG, "shorter"), (errno.ELOOP, "a link")],
)
def test_a_path_that_the_system_refuses_is_no_defect(number, remedy, monkeypatch, capsys) -> None:
    fail_with(OSError(number, os.strerror(number), "a.toml"), monkeypatch)
    with pytest.raises(SystemExit) as stopped:
        tsas_cli.app.run()
    assert stopped.value.code == 2
    line = capsys.readouterr().err
    assert line.startswith("tsas: a.toml: the system refuses the call (")
    assert remedy in line


def test_a_stop_while_the_program_is_loaded_is_quiet() -> None:
    program = """
import sys
class Stop:
    def find_spec(self, name, *more):
        if name == "tsas_cli.app":
            raise KeyboardInterrupt
sys.meta_path.insert(0, Stop())
from tsas_cli.__main__ import main
main()
"""
    done = subprocess.run([sys.executable, "-c", program], stderr=subprocess.PIPE, check=False)
    assert (done.returncode, done.stderr) == (130, b"")


def test_a_stop_in_text_that_a_library_executes_while_it_is_loaded_is_quiet(tmp_path: Path) -> None:
    """CPython remembers a plain one, and ended by SIGINT: -2 in place of 130 on a busy machine."""
    (tmp_path / "sitecustomize.py").write_text("""
import sys
class Stop:
    def find_spec(self, name, *more):
        if name == "tsas_cli.app":
            exec("import os, signal; os.kill(os.getpid(), signal.SIGINT)")
sys.meta_path.insert(0, Stop())
""")
    done = subprocess.run(
        [sys.executable, "-m", "tsas_cli", "--version"],
        capture_output=True,
        check=False,
        env=os.environ
        | {"PYTHONPATH": f"{tmp_path}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"},
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, b"", b"")


def test_a_stop_beside_the_command_is_an_exit_code_too(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def app(**_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(tsas_cli.app, "app", app)
    with pytest.raises(SystemExit) as stopped:
        tsas_cli.app.run()
    assert stopped.value.code == 130
    assert capsys.readouterr() == ("", "")


def test_a_stop_that_compiled_code_has_met_is_no_defect(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("TSAS_TRACEBACK", raising=False)
    error = SystemError("returned a result with an exception set")
    error.__cause__ = KeyboardInterrupt()
    fail_with(error, monkeypatch)
    with pytest.raises(SystemExit) as stopped:
        tsas_cli.app.run()
    assert stopped.value.code == 130
    assert capsys.readouterr() == ("", "")
