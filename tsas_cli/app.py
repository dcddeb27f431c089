"""The command line: its subcommands, and the conversion of errors to a line and an exit code."""

import errno
import io
import os
import sys
from collections.abc import Callable
from pathlib import Path

import typer
from typer.exceptions import TyperException

from tsas_cli.commands.looking import effects, explain, report, view
from tsas_cli.commands.models import (
    calibrate,
    compare,
    diagnose,
    export,
    identify_harmonic_drive,
    plan,
    predict,
    simulate,
)
from tsas_cli.commands.recordings import check, ingest, runs, upload, verify
from tsas_cli.commands.setup import doctor, init
from tsas_cli.commands.sweep import sweep
from tsas_cli.commands.track import track
from tsas_cli.support import __version__
from tsas_cli.support.errors import NO_MEMORY, InputError, printable, shortened
from tsas_cli.support.limits import loadable
from tsas_cli.support.stopping import EXIT_CODE

# What to do at an error of the system, by its number.
_ROOM = "free disk space or raise the limit, and repeat the call"
_ROOMLESS = ("ENOSPC", "EDQUOT", "EFBIG", "EROFS", "EIO", "EMFILE", "ENFILE")
REFUSALS = {getattr(errno, name): _ROOM for name in _ROOMLESS} | {
    errno.EACCES: "ask its owner for permission, or copy it",
    errno.EPERM: "ask its owner for permission, or copy it",
    errno.ENAMETOOLONG: "name a shorter path",
    errno.ELOOP: "a link leads back to itself: remove it",
}

app = typer.Typer(
    name="tsas",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="Calibrate and diagnose models of tendon-sheath mechanisms (Bowden cables, cable-conduit "
    "mechanisms) from recordings.",
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
    if "--help" not in sys.argv:
        loadable()


# Panels of `tsas --help`, in this order; `tsas_studies` adds its commands to that of the studies.
STUDIES = "Studies"
PANELS: dict[str, tuple[Callable[..., None], ...]] = {
    "Pipeline": (
        ingest,
        check,
        calibrate,
        identify_harmonic_drive,
        simulate,
        diagnose,
        predict,
        track,
        report,
    ),
    "Understanding a recording or a model": (view, compare, plan, effects, explain, verify),
    "Many datasets and other programs": (runs, sweep, upload, export),
    "Setup": (init, doctor),
    STUDIES: (),
}
for panel, commands in PANELS.items():
    for command in commands:
        app.command(command.__name__.replace("_", "-"), rich_help_panel=panel)(command)


def run() -> None:
    """Run the command line; an error becomes one line on stderr and an exit code."""
    if os.environ.get("COLUMNS") == "0":  # no width, as `shutil.get_terminal_size` has it
        del os.environ["COLUMNS"]
    _open_closed_streams()
    _use_utf_8()
    try:
        code = app(prog_name="tsas", standalone_mode=False)  # a stop becomes an exit code there
        sys.stdout.flush()
    except InputError as error:
        code = _stop(error.line(), 2)
    except TyperException as error:
        code = _stop(_invalid_call(error), 2)
    except KeyboardInterrupt:  # after typer has returned
        code = EXIT_CODE
    except (BrokenPipeError, SystemExit):  # the reader of the output has ended
        _discard_output()
        code = 0
    except MemoryError:
        code = _stop(NO_MEMORY, 2)
    except Exception as error:
        if os.environ.get("TSAS_TRACEBACK") == "1":
            raise
        if _was_stopped(error):
            sys.exit(EXIT_CODE)
        if isinstance(error, RuntimeError) and "Symlink loop" in str(error):  # of Path.resolve
            error = OSError(errno.ELOOP, str(error))
        if isinstance(error, OSError) and error.errno in REFUSALS:
            code = _refused(error)
        else:
            code = _defect(error)
    try:
        sys.stdout.flush()
    except OSError:  # as the error has said
        _discard_output()
    sys.exit(code)


def _refused(error: OSError) -> int:
    """Report an error of the system."""
    where = f"{error.filename}: " if error.filename else ""
    remedy = REFUSALS[error.errno or 0]
    return _stop(printable(f"{where}the system refuses the call ({error.strerror}); {remedy}"), 2)


def _defect(error: Exception) -> int:
    description = printable(f"{type(error).__name__}: {error}".strip())
    remedy = "please report it with the output of the same call under TSAS_TRACEBACK=1"
    return _stop(f"a defect of tsas itself: {description}; {remedy}", 1)


def _open_closed_streams() -> None:
    """Connect closed standard streams to the null device, stdin first."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            stream = Path(os.devnull).open(mode, encoding="utf-8")  # noqa: SIM115 # till the end
            os.set_inheritable(stream.fileno(), True)
            setattr(sys, name, stream)


def _discard_output() -> None:
    """Discard what is still to be written to standard output."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _use_utf_8() -> None:
    """Print units and names in UTF-8 if the encoding of the shell is ASCII."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            ascii_only = stream.encoding.lower() in {"ascii", "us-ascii", "ansi_x3.4-1968"}
            stream.reconfigure(encoding="utf-8" if ascii_only else None, errors="backslashreplace")


def _was_stopped(error: BaseException | None) -> bool:
    """Return whether an error is caused by a stop signal inside compiled code."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__
    return error is not None


def _invalid_call(error: TyperException) -> str:
    """Return one line about a call that typer refuses; empty for `tsas` alone, which is help."""
    message = error.format_message().rstrip(".")
    context = getattr(error, "ctx", None)
    command = context.command_path if context else "tsas"
    return printable(f"{shortened(message)}; see `{command} --help`") if message else ""


def _stop(line: str, code: int) -> int:
    if line:
        try:
            print(f"tsas: {line}", file=sys.stderr, flush=True)
        except OSError:  # nobody can read it
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno())
    return code
