"""How often the 95 % intervals of `calibrate` hold the true value, over many noise seeds.

The recordings are the four groups of paper-groups on the independent rig, twice: with the free
lengths of tendon told in the data sheet, so that the model can be right, and as shipped, where
the model lacks them, says so, and widens its intervals by what a missing effect would do.
"""

import os
from collections.abc import Iterable, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import cache, partial
from multiprocessing import get_context

import numpy as np

from benchmarks.row import Row
from tsas_cli.identification.calibration import calibrate_runs
from tsas_cli.identification.prepared import prepare
from tsas_cli.recordings.manifest import Manifest, Run
from tsas_cli.recordings.recording import Recording
from tsas_studies.challenge.rig.make_datasets import GROUPS, RIG, SENSORS
from tsas_studies.challenge.rig.motions import sine
from tsas_studies.challenge.rig.recordings import DATA_SHEET, conditions
from tsas_studies.challenge.rig.sensors import measure as measured
from tsas_studies.challenge.rig.tendon import CleanRun, Rig, simulate

SEEDS = int(os.environ.get("TSAS_COVERAGE_SEEDS", "200"))
FIRST_SEED = 50_000  # apart from the shipped data's and the tests' seeds
FREE_TENDON = {
    "proximal_length_mm": RIG.proximal_length_mm,
    "distal_length_mm": RIG.distal_length_mm,
}
TRUTH = {
    "friction_coefficient": 0.125,
    "load_stiffness_N_per_mm": 1.579,
    "preload_N": 25.0,
    "tendon_stiffness_N": Rig().axial_stiffness,
    "x_in_zero_mm": 0.0,
}


def rig(group: str) -> Rig:
    """Return the rig of one group of Table 2 (Yang 2025)."""
    _, radius, bend = GROUPS[group]
    return replace(RIG, total_bend_rad=bend, sheath_length_mm=radius * bend)


@cache
def clean(group: str) -> CleanRun:
    """Return the group's run without sensor errors."""
    return simulate(rig(group), sine(omega_rad_s=GROUPS[group][0]))


def held(seed: int, *, told: bool) -> Mapping[str, list[tuple[bool, float]]]:
    """Return for each parameter whether its intervals hold the truth, and their half widths."""
    sheet = DATA_SHEET | (FREE_TENDON if told else {})
    entries, runs = [], []
    for k, group in enumerate(GROUPS):
        columns = measured(clean(group), SENSORS, seed=len(GROUPS) * seed + k)
        entry = Run(id=group, file=f"{group}.parquet", sha256="0" * 64, **conditions(rig(group)))
        entries.append(entry)
        runs.append(prepare(Recording(entry, columns)))
    manifest = Manifest.model_validate(
        {"format": 1, "name": "", "kind": "simulated", "rig": sheet, "run": entries}
    )
    out: dict[str, list[tuple[bool, float]]] = {}
    for e in calibrate_runs(manifest, runs).model.estimates:
        if e.name in TRUTH and e.interval_low is not None and e.interval_high is not None:
            inside = e.interval_low <= TRUTH[e.name] <= e.interval_high
            half = 0.5 * (e.interval_high - e.interval_low)
            out.setdefault(e.name, []).append((inside, half))
    return out


def measure() -> Iterable[Row]:
    """Yield the share of intervals that hold the truth, and their mean half width."""
    seeds = range(FIRST_SEED, FIRST_SEED + SEEDS)
    with ProcessPoolExecutor(os.cpu_count(), mp_context=get_context("spawn")) as pool:
        for told, label in ((True, "lengths told"), (False, "as shipped")):
            answers = list(pool.map(partial(held, told=told), seeds, chunksize=5))
            for name in TRUTH:
                pairs = np.array([p for answer in answers for p in answer.get(name, [])])
                if pairs.size:
                    share = 100.0 * float(pairs[:, 0].mean())
                    yield Row(f"{name}, {label}: covered", share, "%", at_most=99.0, at_least=85.0)
                    yield Row(f"{name}, {label}: half width", float(pairs[:, 1].mean()), "")
