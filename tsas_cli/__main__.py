"""What the command `tsas` calls, and `python -m tsas_cli`."""

import sys

from tsas_cli.stopping import EXIT_CODE


def main() -> None:
    """Run the command line; Ctrl-C ends it quietly while it is still being loaded, too."""
    try:
        from tsas_cli.app import main as answer

        answer()
    except KeyboardInterrupt:
        sys.exit(EXIT_CODE)


if __name__ == "__main__":
    main()
