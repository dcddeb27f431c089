"""The subcommands of the studies: importing this adds them to the command line."""

from tsas_cli.app import STUDIES, app
from tsas_studies.commands.challenge import challenge
from tsas_studies.commands.close_loop import close_loop
from tsas_studies.commands.reproduce import reproduce

__all__ = ["app"]

app.command("close-loop", rich_help_panel=STUDIES)(close_loop)
app.command("reproduce", rich_help_panel=STUDIES)(reproduce)
app.add_typer(challenge, rich_help_panel=STUDIES)
