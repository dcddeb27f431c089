"""A worker of the local pool, `python -m tsas_cli.sweeping.worker MODULE:FUNCTION`.

Reads one task a line and writes one answer a line, until its input ends. Whatever else is printed
goes to standard error.
"""

import os
import sys

from tsas_cli.sweeping.answer import called


def main() -> None:
    """Answer one task after the other."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    for line in sys.stdin:
        answers.write(called(sys.argv[1], line) + "\n")
        answers.flush()


if __name__ == "__main__":
    main()
