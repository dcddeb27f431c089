"""The subcommands of the studies: importing this adds them to the command line."""

from tsas_cli.app import app
from tsas_studies.commands.challenge import challenge
from tsas_studies.commands.reproduce import reproduce

__all__ = ["app"]

app.command("reproduce")(reproduce)
app.add_typer(challenge)
