"""Write the recordings of docs/tutorial.md: `python -m docs.bench_recordings FOLDER`.

With a name that ends in .csv, the first of them under that name.

They are the four shipped runs of datasets/paper-groups as another laboratory would have recorded
them: as text, with other names and units.
"""

import sys
from pathlib import Path

import numpy as np
import pandas as pd

RUNS = {
    "a": "L785_bend180_slow",
    "b": "L785_bend180_fast",
    "c": "L628_bend180_slow",
    "d": "L314_bend90_slow",
}
SHIPPED = Path(__file__).parent.parent / "datasets" / "paper-groups" / "runs"
TURNTABLE_MM = 27.1
LBF_N = 4.4482216152605


def as_text(run: str) -> str:
    """Return a shipped run as CSV."""
    given = pd.read_parquet(SHIPPED / f"{run}.parquet")
    table = pd.DataFrame(
        {
            "Time [ms]": (1e3 * given["time_s"]).round(3),
            "Turntable [deg]": np.degrees(given["x_in_mm"] / TURNTABLE_MM).round(4),
            "Load [mm]": given["x_out_mm"].round(3),
            "Cell drive [lbf]": (given["f_in_N"] / LBF_N).round(3),
            "Cell load [N]": given["f_out_N"].round(3),
        }
    )
    return table.to_csv(index=False)


def write(folder: Path, runs: dict[str, str] = RUNS) -> None:
    """Write runs into a folder, each under its name."""
    folder.mkdir(parents=True, exist_ok=True)
    for run, name in runs.items():
        (folder / f"{name}.csv").write_text(as_text(run), encoding="utf-8")


if __name__ == "__main__":
    out = Path(sys.argv[1])
    write(out.parent, {"a": out.stem}) if out.suffix == ".csv" else write(out)
