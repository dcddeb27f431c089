"""The command line: every subcommand, and the one place where an error becomes a line."""

import errno
import io
import os
import sys
from pathlib import Path
from typing import TypeGuard

import typer
from typer.exceptions import TyperException

from tsas_cli.commands.calibrate import calibrate
from tsas_cli.commands.check import check
from tsas_cli.commands.close_loop import close_loop
from tsas_cli.commands.compare import compare
from tsas_cli.commands.diagnose import diagnose
from tsas_cli.commands.doctor import doctor
from tsas_cli.commands.effects import effects
from tsas_cli.commands.explain import explain
from tsas_cli.commands.identify_harmonic_drive import identify_harmonic_drive
from tsas_cli.commands.ingest import ingest
from tsas_cli.commands.init import init
from tsas_cli.commands.plan import plan
from tsas_cli.commands.report import report
from tsas_cli.commands.runs import runs
from tsas_cli.commands.simulate import simulate
from tsas_cli.commands.sweep import sweep
from tsas_cli.commands.track import track
from tsas_cli.commands.upload import upload
from tsas_cli.commands.verify import verify
from tsas_cli.commands.view import view
from tsas_cli.support import __version__
from tsas_cli.support.errors import InputError, printable
from tsas_cli.support.stopping import EXIT_CODE, cleaned_up_when_stopped

# What the machine refuses: no room, a disk that fails, no more open files.
REFUSALS = frozenset(
    {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS, errno.EIO, errno.EMFILE, errno.ENFILE}
)

app = typer.Typer(
    name="tsas",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="From recordings of a tendon-sheath rig to a calibrated model and its errors.",
)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"tsas {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: bool = typer.Option(
        False, "--version", callback=_version, is_eager=True, help="Print the version."
    ),
) -> None:
    del version


app.command("init")(init)
app.command("ingest")(ingest)
app.command("check")(check)
app.command("calibrate")(calibrate)
app.command("identify-harmonic-drive")(identify_harmonic_drive)
app.command("simulate")(simulate)
app.command("diagnose")(diagnose)
app.command("compare")(compare)
app.command("plan")(plan)
app.command("track")(track)
app.command("close-loop")(close_loop)
app.command("sweep")(sweep)
app.command("report")(report)
app.command("verify")(verify)
app.command("view")(view)
app.command("runs")(runs)
app.command("upload")(upload)
app.command("doctor")(doctor)
app.command("effects")(effects)
app.command("explain")(explain)


def run() -> None:
    """Run the command line; what goes wrong is one line on stderr and an exit code."""
    # Many small matrices: threads inside of each product cost three times what they save.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    _open_what_is_closed()
    _speak_beyond_ascii()
    try:
        with cleaned_up_when_stopped():  # typer makes an exit code of it
            code = app(prog_name="tsas", standalone_mode=False)
        sys.stdout.flush()
    except InputError as error:
        code = _stop(error.line(), 2)
    except TyperException as error:
        code = _stop(_wrong_call(error), 2)
    except KeyboardInterrupt:  # between typer's end and ours
        code = EXIT_CODE
    except (BrokenPipeError, SystemExit):  # who read the output is gone; typer exits then
        _forget_output()
        code = 0
    except MemoryError:
        remedy = "use a larger machine, fewer runs at a time (--runs), or shorter recordings"
        code = _stop(f"this takes more memory than there is; {remedy}", 2)
    except Exception as error:
        if os.environ.get("TSAS_TRACEBACK") == "1":
            raise
        if _was_stopped(error):
            sys.exit(EXIT_CODE)
        code = _refused(error) if _is_refusal(error) else _defect(error)
    sys.exit(code)


def _is_refusal(error: Exception) -> TypeGuard[OSError]:
    return isinstance(error, OSError) and error.errno in REFUSALS


def _refused(error: OSError) -> int:
    """Say what the machine refuses; standard output may be what it refuses to write to."""
    try:
        sys.stdout.flush()
    except OSError:
        _forget_output()
    where = f"{error.filename}: " if error.filename else ""
    remedy = "make room, or allow more, and call again"
    return _stop(printable(f"{where}the system refuses it ({error.strerror}); {remedy}"), 2)


def _defect(error: Exception) -> int:
    told = printable(f"{type(error).__name__}: {error}".strip())
    remedy = "please report it with the output of the same call under TSAS_TRACEBACK=1"
    return _stop(f"a defect of tsas itself: {told}; {remedy}", 1)


def _open_what_is_closed() -> None:
    """Let what is printed to a closed stream be lost, and nothing else; 0 comes first."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            stream = Path(os.devnull).open(mode, encoding="utf-8")  # noqa: SIM115 # till the end
            os.set_inheritable(stream.fileno(), True)
            setattr(sys, name, stream)


def _forget_output() -> None:
    """Let what is still to be written to standard output be lost."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _speak_beyond_ascii() -> None:
    """Let units and names be printed where the language of the shell has no letters for them."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            ascii_only = stream.encoding.lower() in {"ascii", "us-ascii", "ansi_x3.4-1968"}
            stream.reconfigure(encoding="utf-8" if ascii_only else None, errors="backslashreplace")


def _was_stopped(error: BaseException | None) -> bool:
    """Say whether an error comes from a request to stop that compiled code has met."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__
    return error is not None


def _wrong_call(error: TyperException) -> str:
    """Return one line about a call that typer refuses; empty after `tsas` alone, which is help."""
    message = error.format_message().rstrip(".")
    context = getattr(error, "ctx", None)
    command = context.command_path if context else "tsas"
    return printable(f"{message}; see `{command} --help`") if message else ""


def _stop(line: str, code: int) -> int:
    if line:
        print(f"tsas: {line}", file=sys.stderr)
    return code
