"""What the stages have written, as the page, the comparison and the benchmark read it."""

import json
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from tests.fuzz.documents import after_a_byte, json_document
from tests.fuzz.rules import Scratch, answer
from tests.reporting import made_diagnoses, made_loops
from tests.reporting import made_folders as made
from tsas_cli.comparing.sides import STAGES as COMPARED
from tsas_cli.comparing.sides import read_side
from tsas_cli.comparing.tracked import compare_tracked
from tsas_cli.records.tracking import TrackingFile
from tsas_cli.reporting.inputs import STAGES, read_inputs, read_stage
from tsas_studies.challenge import entry, truth

SHARE = 4
MOST_BYTES = 8000
mutate = after_a_byte(json_document)
FILES = (*(kind.FILE for kind in STAGES), truth.FILE, entry.FILE)
MODEL = b'format = 1\n[parameters.friction_coefficient]\nvalue = 0.1\nunit = "1"\n'
_scratches = [Scratch() for _ in FILES]
for _scratch in _scratches:
    for _name in ("model.toml", "model-extended.toml"):
        _scratch.file(_name, MODEL)


def one(data):
    """The first byte chooses which file it is, the rest is its content."""
    which = data[0] % len(FILES) if data else 0
    path = _scratches[which].file(FILES[which], data[1:])
    if which == len(STAGES):
        answer(truth.read_truth, path.parent)
    elif which > len(STAGES):
        answer(entry.read_diagnosis, path, {"dataset.toml": "0" * 64})
    else:
        kind = STAGES[which]
        answer(read_stage, kind, path.parent)
        answer(read_inputs, [path.parent])
        if kind in COMPARED:
            answer(read_side, path.parent)
        if kind is TrackingFile:
            answer(compare_tracked, path.parent, path.parent)


def seeds():
    with TemporaryDirectory() as name:
        folder = Path(name)
        data = made.make_dataset(folder / "data", samples=400)
        made.make_check(data, folder / "check")
        made.make_calibration(data, folder / "calibrate")
        made.make_simulation(data, folder / "simulate")
        made_diagnoses.make_diagnosis(data, folder / "diagnose", "named")
        made.make_prediction(data, folder / "predict")
        made_loops.make_tracking(folder / "track")
        made_loops.make_closing(folder / "close")
        for path in sorted(folder.glob("*/*.json")):
            content = json.dumps(_short(json.loads(path.read_text(encoding="utf-8"))))
            yield bytes([FILES.index(path.name)]) + content.encode()
    curve = {"frequency_Hz": [1.0], "magnitude": [1.0], "phase_deg": [-90.0]}
    drive = {
        "format": 1,
        "stage": "identify-harmonic-drive",
        "version": "0.1.0",
        "dataset": {"name": "a", "hashes": {}},
        "structure": {"name": "stiff", "equation": "K/s"},
        "parameters": [],
        "kinematics": {"fitted_lead_rpm_s_per_mm": 1.0},
        "frequency_response": {
            "band_Hz": [0.1, 1.0],
            "measured": curve | {"coherence": [1.0], "excited": [True]},
            "fitted": curve,
        },
        "fit": {"converged": True},
        "diagnosis": {"verdict": "sufficient", "reason": "r"},
    }
    yield bytes([FILES.index("drive.json")]) + json.dumps(drive).encode()
    hidden = {"effect": "free_tendon", "parameters": {"proximal_length_mm": 100.0}}
    case = {"kind": "one", "size": 1.0, "hidden": [hidden]}
    sealed = {"format": 1, "kind": "challenge-answers", "seed": 3, "cases": {"a": case}}
    yield bytes([FILES.index(truth.FILE)]) + json.dumps(sealed).encode()
    found = {"format": 1, "verdict": "named", "named": [], "remainder": {"unexplained": False}}
    yield bytes([len(FILES) - 1]) + json.dumps(found).encode()


def _short(content: Any) -> Any:
    if isinstance(content, dict):
        return {key: _short(value) for key, value in list(content.items())[:40]}
    return [_short(value) for value in content[:2]] if isinstance(content, list) else content
