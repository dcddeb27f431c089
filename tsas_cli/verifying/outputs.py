"""The files that a stage writes into its folder, as its JSON names them."""

from pathlib import Path

from tsas_cli.recordings.manifest import MANIFEST_FILE
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import read_json

# Each stage's JSON, and what is always beside it.
BESIDE: dict[str, tuple[str, ...]] = {
    "calibration.json": ("model.toml",),
    "check.json": (),
    "closing.json": (),
    "compare.json": (),
    "diagnosis.json": ("model-extended.toml", "model-nominal.toml"),
    "drive.json": ("drive.toml",),
    "plan.json": (),
    "predict.json": (),
    "simulation.json": ("model.toml",),
    "tracking.json": (MANIFEST_FILE,),
}
_RUNS = {
    "diagnosis.json": "segments",
    "drive.json": "runs",
    "predict.json": "channels",
    "simulation.json": "runs",
    "tracking.json": "results",
}  # the key that names the runs whose series are in the folder


def outputs_of(path: Path) -> list[str]:
    """Return the files that a stage's JSON names in its folder, itself first; else none."""
    if path.name not in BESIDE:
        return []
    try:
        content = read_json(path)
    except InputError:
        return []
    if not isinstance(content, dict) or not {"format", "stage"} <= content.keys():
        return []
    named = content.get(_RUNS.get(path.name))  # runs are the keys, or a list's entries name them
    if isinstance(named, list):
        named = dict.fromkeys(str(one.get("run")) for one in named if isinstance(one, dict))
    runs = named if isinstance(named, dict) else ()
    return [path.name, *BESIDE[path.name], *(f"runs/{run}.parquet" for run in runs)]
