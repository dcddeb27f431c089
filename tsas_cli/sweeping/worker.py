"""A worker of the local pool, `python -m tsas_cli.sweeping.worker MODULE:FUNCTION`.

Reads one task per line and writes one outcome per line, until its input ends. All other output goes
to standard error.
"""

import os
import sys

from tsas_cli.sweeping.outcome import run_task


def main() -> None:
    """Run one task after the other."""
    outcomes = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    for line in sys.stdin:
        outcomes.write(run_task(sys.argv[1], line) + "\n")
        outcomes.flush()


if __name__ == "__main__":
    main()
