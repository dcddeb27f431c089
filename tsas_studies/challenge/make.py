"""Write a sealed set: recordings that say nothing of what is hidden in them, and the answers."""

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from tsas_studies.challenge.bench import (
    RUNS,
    SENSORS,
    Bench,
    data_sheet,
    drawn_bench,
    recorded,
    rig_of,
)
from tsas_studies.challenge.cases import Case
from tsas_studies.challenge.conditions import drawn_nuisance
from tsas_studies.challenge.near import MIXED
from tsas_studies.challenge.recording_faults import RECORDING_FAULTS
from tsas_studies.challenge.rig.recording import recorded_with
from tsas_studies.challenge.rig.recordings import DATA_SHEET, Run, conditions, write_dataset
from tsas_studies.challenge.sums import CASES, DATASET, sealed_id, sums_of
from tsas_studies.challenge.truth import BEYOND, FILE

RECORDINGS, NUISANCE = 1, 2  # streams of chance
CHANNELS = ("x_in_mm", "x_out_mm", "f_in_N", "f_out_N")
DESCRIPTION = "Simulated, not measured: a case of the blind benchmark."


def make(
    out: Path,
    cases: Sequence[Case],
    *,
    rate_Hz: float = 200.0,
    step: Callable[[], None] = lambda: None,
) -> None:
    """Write `cases/ID/dataset` for each case, and `answers.json` beside them, into an empty folder.

    The same cases, of one or more seeds and one salt, give the same files, byte for byte. An id is
    a checksum of salt and answer (`sums.sealed_id`), and the folders' order is theirs, so that
    neither tells a case's place in the list. `step` is called after each case.

    ValueError: there are no cases.
    """
    seeds = sorted({case.seed for case in cases})
    if not seeds:
        raise ValueError("no cases to make a set of")
    salt = f"{cases[0].salt:032x}"
    drawn = {}
    for case in cases:
        rng = np.random.default_rng([case.chance, case.number, RECORDINGS])
        # A stream of chance that the same case under clean conditions does not have.
        own = np.random.default_rng([case.chance, case.number, NUISANCE, NUISANCE])
        nuisance = drawn_nuisance(case.conditions, RUNS, own)
        bench = replace(drawn_bench(rng), nuisance=nuisance)
        drawn[sealed_id(salt, answer(case, bench))] = case, bench, rng
    answers = {}
    for name, (case, bench, rng) in sorted(drawn.items()):
        dataset = out / CASES / name / DATASET
        _write(dataset, case, bench, rate_Hz, rng)
        answers[name] = answer(case, bench) | {"sums": sums_of(dataset)}
        step()
    sealed = {
        "format": 1,
        "stage": "challenge make",
        "kind": "challenge-answers",
        "seed": seeds[0] if len(seeds) == 1 else seeds,
        "salt": salt,
        "rate_Hz": rate_Hz,
        "cases": answers,
    }
    text = json.dumps(sealed, indent=2, allow_nan=False)
    (out / FILE).write_text(text + "\n", encoding="utf-8")


def _write(
    folder: Path, case: Case, bench: Bench, rate_Hz: float, rng: np.random.Generator
) -> None:
    of_recording = case.kind == "recording"
    runs = {}
    for run in RUNS:
        seed = int(rng.integers(2**32))
        hidden = () if of_recording else case.hidden
        columns = recorded(bench, hidden, run, rate_Hz=rate_Hz, seed=seed)
        stated = conditions(rig_of(bench, run)) | {"preload_N": data_sheet()["preload_N"]}
        runs[run] = Run(run, columns, {"started": bench.started[run]} | stated)
    for fault in case.hidden if of_recording else ():
        function = RECORDING_FAULTS[fault.cause].function
        runs = dict(recorded_with(runs, function, fault.parameters, rng))
    write_dataset(
        folder,
        list(runs.values()),
        name="case",
        description=DESCRIPTION,
        data_sheet=DATA_SHEET,
        license="CC0-1.0",
    )


def answer(case: Case, bench: Bench) -> dict[str, Any]:
    """Return what is hidden in a case, and what else its rig is like."""
    causes = [{"effect": h.cause, "parameters": dict(h.parameters)} for h in case.hidden]
    beyond = case.kind in BEYOND
    parts = {cause["effect"]: cause["parameters"] for cause in causes}
    one = len(causes) == 1
    return {
        "name": case.name,
        "seed": case.seed,
        "kind": case.kind,
        "size": case.size,
        "conditions": case.conditions,
        "hidden": [] if beyond else causes,
        "unknown": (causes[0]["effect"] if one else MIXED) if beyond else None,
        "unknown_parameters": (causes[0]["parameters"] if one else parts) if beyond else {},
        "nominal": dict(bench.nominal),
        "bend_profile": bench.bend_profile,
        "noise": {channel: getattr(SENSORS, channel).noise for channel in CHANNELS},
        "jitter_s": SENSORS.jitter_s,
        "nuisance": asdict(bench.nuisance),
    }
