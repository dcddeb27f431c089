import errno
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import typer

import tsas_cli
import tsas_cli.app
import tsas_studies
import tsas_studies.commands
from tsas_cli.support.errors import InputError

HEAVY = {"numba", "numpy", "pandas", "pint", "pyarrow", "pydantic", "rerun", "scipy", "tomlkit"}
HEAVY |= {"asammdf", "control", "h5py", "jinja2", "matplotlib"}
COMMANDS = typer.main.get_command(tsas_studies.commands.app).commands  # type: ignore[attr-defined]
CALLS = {  # `tsas challenge` is a group: its commands stand in its place
    f"{name} {inner}".strip(): call
    for name, command in COMMANDS.items()
    for inner, call in getattr(command, "commands", {"": command}).items()
}


@pytest.fixture
def failing(monkeypatch, capsys):
    """Let a call of the command line end in an error; return its exit code, and what is said."""
    monkeypatch.delenv("TSAS_TRACEBACK", raising=False)

    def call(error):
        def app(**_):
            raise error

        monkeypatch.setattr(tsas_cli.app, "app", app)
        with pytest.raises(SystemExit) as stopped:
            tsas_cli.app.run()
        printed, said = capsys.readouterr()
        assert printed == ""
        assert said.count("\n") == bool(said)  # one line, if any
        return stopped.value.code, said

    return call


def loaded_by(program):
    """Return the packages that a program has loaded at its end."""
    program += "; import json, sys; print(json.dumps(list(sys.modules)))"
    call = [sys.executable, "-c", program]
    done = subprocess.run(call, capture_output=True, text=True, check=True)
    return {name.split(".")[0] for name in json.loads(done.stdout)}


def test_version_and_help_succeed(done):
    assert done("--version") == f"tsas {tsas_cli.__version__}\n"
    page = done("--help")
    for name in COMMANDS:
        assert name in page


def test_help_and_the_import_load_no_library_that_they_do_not_need():
    assert loaded_by("import tsas_cli.app") & HEAVY == set()
    light = loaded_by("import tsas_cli as tsas; dir(tsas)")
    assert light & (HEAVY | {"typer", "rich"}) == set()


def test_each_command_is_in_a_panel_of_the_help(tsas):
    panels = {name: command.rich_help_panel for name, command in COMMANDS.items()}
    assert set(panels.values()) == set(tsas_cli.app.PANELS)
    assert panels["reproduce"] == panels["challenge"] == tsas_cli.app.STUDIES
    page = tsas("--help").stdout
    places = [page.find(f"─ {panel} ─") for panel in tsas_cli.app.PANELS]
    assert -1 not in places
    assert places == sorted(places)
    assert "─ Commands ─" not in page


def test_every_function_of_a_command_file_is_a_command():
    homes = (Path(package.__file__).parent for package in (tsas_cli, tsas_studies))
    files = {path for home in homes for path in (home / "commands").glob("*.py")}
    text = "\n".join(
        path.read_text() for path in files if path.stem not in {"common", "completion", "challenge"}
    )
    found = {name.replace("_", "-") for name in re.findall(r"^def ([a-z]\w+)", text, re.MULTILINE)}
    assert set(COMMANDS) == found | {"challenge"}


@pytest.mark.parametrize("name", CALLS)
def test_every_command_explains_itself_and_can_be_quiet_or_print_json(name):
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
def test_a_wrong_call_is_one_line_that_names_the_help(refused, call, told):
    said = refused(*call)
    assert said.startswith(told)
    assert said.endswith("--help`\n")


def test_no_command_at_all_prints_the_help(tsas):
    result = tsas()
    assert result.returncode == 2
    assert "Usage: tsas" in result.stdout + result.stderr


def test_a_wrong_input_is_one_line_and_exit_code_2(failing):
    code, said = failing(InputError("no\nsuch run", where="a\x1b[31m"))
    assert (code, said) == (2, "tsas: a\\x1b[31m: no\\nsuch run\n")


@pytest.mark.parametrize("call", [["effects"], ["init", "rig"], ["doctor"]])
def test_a_current_folder_that_is_gone_is_one_line(tsas, tmp_path, call):
    def leave():
        (tmp_path / "gone").mkdir()
        os.chdir(tmp_path / "gone")
        (tmp_path / "gone").rmdir()

    said = tsas(*call, preexec_fn=leave)
    assert (said.returncode, said.stdout) == (2, "")
    assert said.stderr.startswith("tsas: the current folder cannot be found (No such file or dir")
    assert said.stderr.endswith("change to another folder\n")
    assert tsas(call[0], "--help", preexec_fn=leave).returncode == 0


def test_no_width_of_the_terminal_is_no_narrow_one(tsas):
    said = tsas("check", "--help", env=os.environ | {"COLUMNS": "0"})
    assert "Usage: tsas check [OPTIONS] {DATASET}" in said.stdout


def test_python_without_docstrings_is_one_line(tsas):
    said = tsas("explain", "free_tendon", env=os.environ | {"PYTHONOPTIMIZE": "2"})
    assert (said.returncode, said.stdout) == (2, "")
    assert said.stderr.startswith("tsas: Python runs without docstrings")
    assert said.stderr.endswith("unset PYTHONOPTIMIZE\n")


@pytest.mark.parametrize("call", ["simulate DATASET --out loop/x", "init loop"])
def test_a_link_to_itself_is_one_line(refused, dataset, tmp_path, monkeypatch, call):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "loop").symlink_to("loop")
    said = refused(*call.replace("DATASET", str(dataset)).split())
    assert said.endswith("a link leads back to itself: remove it\n")


def test_a_defect_is_one_line_and_exit_code_1(failing):
    code, said = failing(ZeroDivisionError("two\nlines"))
    assert code == 1
    assert said.startswith("tsas: a defect of tsas itself: ZeroDivisionError: two\\nlines; ")
    assert "TSAS_TRACEBACK=1" in said


def test_a_defect_shows_its_traceback_where_it_is_asked_for(monkeypatch):
    monkeypatch.setenv("TSAS_TRACEBACK", "1")
    monkeypatch.setattr(tsas_cli.app, "app", lambda **_: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        tsas_cli.app.run()


def test_a_reader_that_goes_away_is_no_error():
    reader, writer = os.pipe()
    os.close(reader)
    call = [sys.executable, "-m", "tsas_cli", "--version"]
    result = subprocess.run(call, stdout=writer, stderr=subprocess.PIPE, check=False)
    os.close(writer)
    assert (result.returncode, result.stderr) == (0, b"")


@pytest.mark.parametrize("closed", ["2>&-", "<&- >&- 2>&-"])
def test_a_closed_stream_loses_what_is_printed_and_nothing_else(tmp_path, closed):
    out = tmp_path / "map.toml"
    (tmp_path / "a.csv").write_text("time [s],x [mm]\n0,1\n0.1,2\n0.2,3\n0.3,4\n")
    call = f'"{sys.executable}" -m tsas_cli ingest a.csv --guess --out map.toml {closed}'
    done = subprocess.run(["sh", "-c", call], cwd=tmp_path, check=False)  # noqa: S607
    assert done.returncode == 0
    assert "[columns.x_in_mm]" in out.read_text(encoding="utf-8")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is full")
def test_no_room_for_what_is_printed_is_one_line():
    call = [sys.executable, "-m", "tsas_cli", "effects"]
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(call, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "standard output: cannot be written (No space left on device)" in done.stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is full")
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_an_output_without_room_for_what_is_printed_is_complete_and_said_to_be(
    dataset, tmp_path, unbuffered
):
    call = f'"{sys.executable}" -m tsas_cli check dataset --out found > /dev/full'
    environment = os.environ | {"PYTHONUNBUFFERED": unbuffered}
    keywords = {"cwd": tmp_path, "env": environment, "stderr": subprocess.PIPE, "text": True}
    done = subprocess.run(["sh", "-c", call], check=False, **keywords)  # noqa: S607
    assert done.returncode == 2
    assert done.stderr == (
        "tsas: standard output: cannot be written (No space left on device); "
        "found is complete: only what is printed is lost\n"
    )
    assert (tmp_path / "found" / "SHA256SUMS").exists()


@pytest.mark.parametrize(
    ("name", "value"),
    [("NUMBA_NUM_THREADS", "0"), ("NUMBA_NUM_THREADS", "abc"), ("NUMBA_NUM_THREADS", "")]
    + [("TSAS_THREADS", value) for value in ("abc", "-1", "1000000000")],
)
def test_a_variable_that_is_no_number_of_threads_is_named(tsas, name, value):
    said = tsas("effects", env=os.environ | {name: value})
    assert (said.returncode, said.stdout) == (2, "")
    assert said.stderr == (
        f"tsas: environment: {name} is {value!r}; expected a whole number from 1 to 10000; "
        f"correct it, or unset {name}\n"
    )


@pytest.mark.parametrize(
    ("number", "remedy"),
    [
        (errno.EMFILE, "Too many"),
        (errno.EACCES, "ask its owner"),
        (errno.ENAMETOOLONG, "shorter"),
        (errno.ELOOP, "a link"),
    ],
)
def test_a_call_that_the_system_refuses_is_no_defect(failing, number, remedy):
    code, said = failing(OSError(number, os.strerror(number), "a.toml"))
    assert code == 2
    assert said.startswith("tsas: a.toml: the system refuses the call (")
    assert remedy in said


def test_a_stop_while_the_program_is_loaded_is_quiet():
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


def test_a_stop_in_text_that_a_library_executes_while_it_is_loaded_is_quiet(tmp_path):
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


def test_a_stop_is_an_exit_code_even_where_compiled_code_has_met_it(failing):
    assert failing(KeyboardInterrupt()) == (130, "")
    error = SystemError("returned a result with an exception set")
    error.__cause__ = KeyboardInterrupt()
    assert failing(error) == (130, "")
