"""What the command `tsas` calls, and `python -m tsas_cli`."""

import sys

from tsas_cli.support.stopping import EXIT_CODE, stopped_once


def main() -> None:
    """Run the command line; Ctrl-C ends it quietly while it is still being loaded, too."""
    stopped_once()
    try:
        import tsas_studies.commands  # noqa: F401 # adds the studies to the command line
        from tsas_cli.app import run

        run()
    except KeyboardInterrupt:
        sys.exit(EXIT_CODE)


if __name__ == "__main__":
    main()
