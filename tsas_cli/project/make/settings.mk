# From the files in raw/ to a page: `make`. A step runs again when what it reads, or what it is told
# here, has changed; `make -n` shows which ones would. A step that fails leaves what it made before.

# Your files, and the map that says what they hold.
RAW = raw
MAP = bench.toml

# What is made of them.
DATASET = dataset
OUT = result

# The program, and its own files, for those who develop it.
TSAS = tsas
PROGRAM =

# What steps are told besides: DIAGNOSE = --runs bend90,bend180 leaves the other runs out; CALIBRATE
# and SIMULATE take --dynamics lugre.
STAGE = --rrd --force
CALIBRATE =
SIMULATE =
DIAGNOSE =
