"""What to do with a file of a format that is not read: one line for the shell."""

import json
import shlex
from pathlib import Path

_PANDAS = 'python -c "import pandas, sys; pandas.{}(sys.argv[1]).to_parquet(sys.argv[2])" {} {}'
_ARCHIVES = {
    ".tar": "mkdir -p {folder} && tar -xf {file} -C {folder}",
    ".7z": "7z x {file} -o{folder}",
    ".rar": "unrar x {file} {folder}/",
}
_PANDAS_READERS = {
    ".orc": "read_orc",
    ".pkl": "read_pickle",  # runs code of the file
    ".pickle": "read_pickle",
    ".sav": "read_spss",
    ".dta": "read_stata",
    ".sas7bdat": "read_sas",
}
_R = "write.csv(readRDS({file}), {made}, row.names = FALSE)"
_COPIES = {".nc": ".h5", ".nc4": ".h5", ".log": ".txt", ".out": ".txt", ".prn": ".txt"}


def way_to_convert(path: Path) -> str:
    """Return the sentence with the command that makes a readable file, or which formats to use."""
    suffixes = [suffix.lower() for suffix in path.suffixes]
    last = suffixes[-1] if suffixes else ""
    made = path.with_name(path.name.split(".")[0] or "data")
    file, folder = shlex.quote(str(path)), shlex.quote(str(made))
    if ".tar" in suffixes or last in (".tgz", ".tbz", ".txz"):
        last = ".tar"
    if last in _ARCHIVES:
        command = _ARCHIVES[last].format(file=file, folder=folder)
        return f"unpack it and ingest the folder {folder}: {command}"
    if last in _PANDAS_READERS:
        target = shlex.quote(f"{made}.parquet")
        command = _PANDAS.format(_PANDAS_READERS[last], file, target)
        trust = " (only if you trust it: the file may run code)" if "pickle" in command else ""
        return f"convert it{trust}: {command}"
    if last == ".rds":
        said = _R.format(file=json.dumps(str(path)), made=json.dumps(f"{made}.csv"))
        return f"convert it: Rscript -e {shlex.quote(said)}"
    if last in _COPIES:
        return f"copy it: cp {file} {shlex.quote(f'{made}{_COPIES[last]}')}"
    return "export it from the program that has written it, as CSV or Parquet"
