"""What the main job reads, small: two runs of the independent rig as CSV, a drive, settings."""

import numpy as np

from tests.drives import LAGGING, drive_dataset
from tsas_studies.challenge.rig.motions import nested
from tsas_studies.challenge.rig.recordings import record
from tsas_studies.challenge.rig.sensors import Sensors
from tsas_studies.challenge.rig.tendon import Rig

RATE_HZ = 30.0
RIG = Rig(friction_coefficient=0.14, proximal_length_mm=400.0, cells=30)
MAP = """
[dataset]
name = "bench-42"
description = "Zwei Läufe, 60 °C"

[rig]
tendon_diameter_mm = 1.2
tendon_modulus_GPa = 60.0
friction_coefficient = 0.125
load_stiffness_N_per_mm = 1.579

[run]
preload_N = 25.0
sheath_length_mm = {length}
total_bend_rad = {bend}

[run.table.a]
started = 2026-03-02T09:30:00
[run.table.b]
started = 2026-03-02T09:40:00+05:30
"""
COLUMN = '[columns.{0}]\nsource = "{0}"\nunit = "{1}"\n'
UNITS = {"time_s": "s", "x_in_mm": "mm", "x_out_mm": "mm", "f_in_N": "N", "f_out_N": "N"}
TRACK = """
[reference]
angular_frequency_rad_per_s = 3.0
duration_s = 2.0
mean_N = 44.0

[sensor]
rate_Hz = 500.0

[loop]
nodes = 8
"""


def make(folder):
    """Write the files of two runs, their map, a dataset of a drive, and settings."""
    (folder / "raw").mkdir(parents=True)
    for seed, (name, speed) in enumerate({"a": 10.0, "b": 16.0}.items()):
        columns = record(
            RIG,
            nested(speed_mm_s=speed, rate_Hz=2.0 * RATE_HZ),
            sensors=Sensors(rate_Hz=RATE_HZ),
            seed=seed,
        )
        rows, header = np.column_stack(list(columns.values())), ",".join(columns)
        path = folder / "raw" / f"{name}.csv"
        np.savetxt(path, rows, delimiter=",", header=header, comments="")
    columns = "".join(COLUMN.format(*item) for item in UNITS.items())
    text = MAP.format(length=RIG.sheath_length_mm, bend=RIG.total_bend_rad) + columns
    (folder / "map.toml").write_text(text, encoding="utf-8")
    (folder / "track.toml").write_text(TRACK, encoding="utf-8")
    drive_dataset(folder / "drive", LAGGING, duration_s=4.0, only=("chirp", "sines"))
