"""Every stage of the main job in one process: `python stages.py`, in a folder with what they read.

One process, since ten would spend most of their time on imports.
"""

import sys
from pathlib import Path

STAGES = (
    "ingest raw --map map.toml --out dataset",
    "check dataset --out check",
    "calibrate dataset --out calibrate --rrd",
    "simulate dataset --model calibrate/model.toml --out simulate --rrd",
    "diagnose dataset --runs a --out diagnose --rrd",
    "track --model diagnose/model-extended.toml --settings track.toml --seeds 2 --out track --rrd",
    "identify-harmonic-drive drive --out identify --rrd",
    "report dataset check calibrate simulate diagnose --out report.html",
    "report track --out track.html",
    "report drive identify --out drive.html",
)


def main() -> None:
    """Run the stages; what a stage prints is kept beside its folder."""
    from tsas_cli.app import app

    for number, stage in enumerate(STAGES):
        with Path(f"printed-{number}.txt").open("w", encoding="utf-8") as stream:
            sys.stdout = stream
            try:
                app(stage.split(), prog_name="tsas", standalone_mode=False)
            finally:
                sys.stdout = sys.__stdout__


if __name__ == "__main__":
    main()
