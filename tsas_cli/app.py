"""The command line: every subcommand, and the one place where an error becomes a line."""

import os
import sys

import typer

from tsas_cli import __version__
from tsas_cli.errors import InputError

app = typer.Typer(
    name="tsas",
    no_args_is_help=True,
    add_completion=False,
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


def main() -> None:
    """Run the command line; a wrong input ends with one line on stderr and exit code 2."""
    try:
        app()
    except InputError as error:
        print(f"tsas: {error.line()}", file=sys.stderr)
        sys.exit(2)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(0)
    except Exception as error:
        if os.environ.get("TSAS_TRACEBACK") == "1":
            raise
        line = str(error).splitlines()[0] if str(error) else ""
        print(
            f"tsas: a defect of tsas itself: {type(error).__name__}: {line}; "
            "please report it with the output of the same call under TSAS_TRACEBACK=1",
            file=sys.stderr,
        )
        sys.exit(1)
