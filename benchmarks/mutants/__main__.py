"""Judge a sample of the mutants of physics/, identification/, diagnosis/ and the quality checks."""

import argparse
import json
import random
from pathlib import Path

from benchmarks.mutants import children
from benchmarks.mutants.judge import BENCHES, Reached, Workshop
from benchmarks.mutants.mutations import sample
from benchmarks.mutants.verdicts import lines

ROOT = Path(__file__).parents[2]


def main() -> None:
    """Read the call, draw, judge and print; what is judged already is not judged again."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.mutants", description=__doc__)
    parser.add_argument("--size", type=int, default=200, help="how many mutants")
    parser.add_argument("--seed", type=int, default=1, help="which ones")
    parser.add_argument("--out", type=Path, default=ROOT / "reports" / "mutants", metavar="DIR")
    call = parser.parse_args()

    out = call.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    shop = Workshop(ROOT, out)
    shop.copy()
    of = {path: bench for bench in BENCHES for path in bench.sources(ROOT)}
    drawn = sample(ROOT, list(of), call.size, call.seed)
    log = out / f"verdicts-{call.seed}.jsonl"
    known = [json.loads(line) for line in log.read_text().splitlines()] if log.exists() else []
    judged = {verdict["mutant"]: verdict for verdict in known}
    children.load()
    reached = {bench: Reached(shop.look(bench), shop.tree) for bench in BENCHES}
    # By chance, so that a run that is broken off is a sample too.
    for mutant in random.Random(call.seed).sample(drawn, len(drawn)):  # noqa: S311 # no secret
        if mutant.name not in judged:
            bench = of[mutant.path]
            outcome, why = shop.judge(bench, mutant, reached[bench])
            before, after = mutant.change(ROOT)
            verdict = {"mutant": mutant.name, "path": mutant.path, "outcome": outcome}
            verdict |= {"before": before, "after": after, "why": why}
            judged[mutant.name] = verdict
            with log.open("a") as file:
                file.write(json.dumps(verdict) + "\n")
    print("\n".join(lines([judged[mutant.name] for mutant in drawn])))


if __name__ == "__main__":
    main()
