"""Kill every stage, and whole pipelines, again and again: `python -m tests.torture`."""

import argparse
import json
import os
import random
import shutil
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import tsas_cli.app
import tsas_studies.commands  # noqa: F401 # adds theirs
from tests.torture.bench import STAGES, Stage, make_inputs
from tests.torture.pipelines import try_pipelines
from tests.torture.trials import Trials, Tried
from tsas_cli.support.text_table import table_text

# How often each stage is ended, of 100 that are; what is quick is ended more often.
SHARES = {
    "init": 14, "ingest": 15, "check": 15, "calibrate": 10, "simulate": 16, "diagnose": 6,
    "identify-harmonic-drive": 1, "track": 13, "close-loop": 1, "report": 4, "compare": 4,
    "predict": 4, "make": 1,
}  # fmt: skip


def main() -> None:
    """Run the trials; a finding is exit code 1."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=600, help="how many calls are ended")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--stages", default=",".join(SHARES))
    parser.add_argument("--out", type=Path, help="write the table as JSON too")
    told = parser.parse_args()
    os.environ["TSAS_THREADS"] = "1"  # a child of this process has none of its threads
    wanted = told.stages.split(",")
    shares = {name: share for name, share in SHARES.items() if name in wanted}
    wholly = sum(shares.values())
    chance = random.Random(told.seed)  # noqa: S311  no secret
    home = Path(tempfile.mkdtemp(prefix="tsas-torture-"))
    try:
        done = []
        for name, n in {s: max(2, told.kills * k // wholly) for s, k in shares.items()}.items():
            if not done:
                stages = tuple(stage for stage in STAGES if stage.name in wanted)
                _prepared(home, stages)
            done.append(_tried(home, name, n, chance))
            _say(done[-1])
    finally:
        shutil.rmtree(home, ignore_errors=True)
    _show(done)
    if told.out:
        told.out.parent.mkdir(parents=True, exist_ok=True)
        told.out.write_text(json.dumps([asdict(one) for one in done], indent=2) + "\n")
    sys.exit(1 if any(one.findings for one in done) else 0)


def _prepared(home: Path, stages: tuple[Stage, ...]) -> None:
    """Make the inputs here, and run every stage once, so that all is loaded before the trials.

    Without streams: Rerun works in threads, which a child of this process would lack.
    """
    before = Path.cwd()
    os.chdir(home)
    try:
        make_inputs(home, stages, _tsas)
        for stage in stages:
            assert _tsas(*(word for word in stage.call if word != "--rrd")) == 0, stage.name
    finally:
        os.chdir(before)
    import tsas_cli.reporting.stream  # noqa: F401


def _tsas(*words: str) -> int:
    """Run the command line in this process."""
    sys.argv = ["tsas", *words]
    try:
        tsas_cli.app.run()
    except SystemExit as stopped:
        return int(stopped.code or 0)


def _tried(home: Path, name: str, n: int, chance: random.Random) -> Tried:
    if name == "make":
        return try_pipelines(home, n, chance)
    trials = Trials(home, next(stage for stage in STAGES if stage.name == name))
    for k, moment in enumerate(trials.moments(n, chance)):
        trials.try_at(moment, old=k // 2 % 2 == 1)
    return trials.tried


def _say(tried: Tried) -> None:
    print(f"{tried.stage}: {tried.ended} ended, {len(tried.findings)} findings", flush=True)
    for finding in tried.findings:
        print(f"  {finding}", flush=True)


def _show(done: Sequence[Tried]) -> None:
    header = ("stage", "seconds", "file operations", "killed at one", "at a time", "stopped")
    more = ("done before", "left temporaries", "findings")
    rows = [
        (one.stage, f"{one.took_s:.2f}", *map(str, (
            one.operations, one.killed_at_operation, one.killed_at_time, one.stopped,
            one.ended_before, one.left_temporaries, len(one.findings),
        )))
        for one in done
    ]  # fmt: skip
    total = sum(one.ended for one in done)
    for line in table_text(f"{total} calls ended", (*header, *more), rows):
        print(line)


if __name__ == "__main__":
    main()
