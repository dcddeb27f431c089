"""Run the command line with `python -m tsas_cli`."""

from tsas_cli.app import main

main()
