"""`python -m docs.manual --out FOLDER` builds the site of the documentation."""

import argparse
import shutil
import sys
import tempfile
from pathlib import Path

from docs.manual.build import build
from tsas_cli.support.files import stage_folder, write_json


def main() -> int:
    """Build the site and put it where it is wanted, whole or not at all."""
    parser = argparse.ArgumentParser(prog="python -m docs.manual")
    parser.add_argument("--out", type=Path, required=True, help="the folder of the site")
    out = parser.parse_args().out
    with tempfile.TemporaryDirectory() as work:
        try:
            site = build(Path(work))
        except (RuntimeError, ValueError) as error:
            print(error, file=sys.stderr)
            return 1
        with stage_folder(out, stage="docs", inputs=(), force=True) as folder:
            shutil.copytree(site, folder, dirs_exist_ok=True)
            write_json(folder / "site.json", {"stage": "docs"})
    print(f"{out}/index.html")
    return 0


if __name__ == "__main__":
    sys.exit(main())
