# From the files in raw/ to a report: `make`. A step runs again if its inputs or its settings here
# have changed; `make -n` shows these steps. A step that fails keeps its earlier output.

# The raw files, and the map of their columns.
RAW = raw
MAP = bench.toml

# The outputs.
DATASET = dataset
OUT = result

# The program, and its source files for developers.
TSAS = tsas
PROGRAM =

# Further options of the steps: DIAGNOSE = --runs bend90,bend180 leaves the other runs out; CALIBRATE
# and SIMULATE accept --dynamics lugre; CALIBRATE and DIAGNOSE accept --despite CODE for an error that
# `tsas check` finds.
STAGE = --rrd --force
CALIBRATE =
SIMULATE =
DIAGNOSE =
