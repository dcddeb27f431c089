"""Learn from public recordings, predict others, and write the errors into docs/measured.md.

A split of `sources.toml` whose files are missing, or are not those that it was made for, is skipped
by name.
"""

import argparse
import sys
from pathlib import Path

from benchmarks.real.learning import learn
from benchmarks.real.splits import HERE, splits
from benchmarks.real.table import lines_of, with_lines
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import own_file

PAGE = HERE.parents[1] / "docs" / "measured.md"


def main() -> int:
    """Run the splits that are asked for; return the exit code."""
    known = {split.name: split for split in splits()}
    parser = argparse.ArgumentParser(prog="python -m benchmarks.real", description=__doc__)
    parser.add_argument("names", nargs="*", help=f"of {', '.join(known)}, or of a source; or all")
    parser.add_argument("--data", type=Path, required=True, help="the folder of the clones")
    parser.add_argument("--out", type=Path, required=True, help="the folder of the results")
    call = parser.parse_args()
    asked = [n for n in known if not call.names or {n, n.split("/")[0]} & set(call.names)]
    if not asked:
        parser.error(f"no split {' '.join(call.names)}; there are {', '.join(known)}")
    failed = False
    for name in asked:
        split = known[name]
        faults = split.faults(call.data)
        if faults:
            print(f"{name} is skipped: {faults[0]}; {len(faults)} in all", file=sys.stderr)
            continue
        try:
            lines = lines_of(split, learn(split, call.data, call.out / name))
        except InputError as error:
            print(f"{name}: {error.line()}", file=sys.stderr)
            failed = True
            continue
        print("\n".join(lines), flush=True)
        page = with_lines(PAGE.read_text(encoding="utf-8"), name, lines, list(known))
        with own_file(PAGE) as path:
            path.write_text(page, encoding="utf-8")
    return 2 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
