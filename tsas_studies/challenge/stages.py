"""The blind benchmark: make a sealed set, let a tool answer it, score the answers."""

import re
import secrets
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from tsas_cli.records.result import Result, Table
from tsas_cli.stages.given import Named, at_least, of_kind, one_of, path_of
from tsas_cli.support import __version__
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import folder_if, stage_folder, write_json
from tsas_cli.support.limits import SEEDS
from tsas_cli.support.steps import NO_PROGRESS, Steps
from tsas_studies.challenge import cases
from tsas_studies.challenge.cases import Kind
from tsas_studies.challenge.conditions import Conditions, kind_label
from tsas_studies.challenge.make import make
from tsas_studies.challenge.run import TOOLS, case_folders, run_cases
from tsas_studies.challenge.score import score_entries
from tsas_studies.challenge.tables import tables

Tool = Literal["diagnose", "bic", "training", "sparse"]


@dataclass(frozen=True, repr=False, eq=False)
class SealedSet(Result):
    """A set of recordings with known causes, and the sealed truth beside them."""

    def tables(self) -> list[Table]:
        """Return how many cases hide what."""
        seed, seeds, kinds = self.summary["seed"], self.summary["seeds"], self.summary["cases"]
        said = f"seed {seed}" if seeds == 1 else f"seeds {seed} to {seed + seeds - 1}"
        title = f"{self.out}: {sum(kinds.values())} cases of {said}"
        return [(title, ("hidden", "cases"), [(kind, str(n)) for kind, n in kinds.items()])]


@dataclass(frozen=True, repr=False, eq=False)
class EntryResult(Result):
    """What a tool answered."""

    def tables(self) -> list[Table]:
        """Return which cases have no answer, and why."""
        answered, missing = self.summary["answered"], self.summary["no_answer"]
        title = f"{self.out}: {answered} of {answered + len(missing)} cases answered"
        return [(title, ("no answer", "reason"), list(missing.items()))]


@dataclass(frozen=True, repr=False, eq=False)
class Score(Result):
    """The answers of one or more tools against the truth."""

    def tables(self) -> list[Table]:
        """Return the figures side by side, then each entry by effect."""
        return list(tables(self.summary))


def make_set(
    *,
    out: Named,
    seed: int,
    seeds: int = 1,
    small: bool = False,
    kind: Kind | None = None,
    conditions: Conditions | None = None,
    rate_Hz: float = 200.0,
    salt: str | None = None,
    force: bool = False,
    step: Steps = NO_PROGRESS,
) -> SealedSet:
    """Make recordings with known causes, and seal the truth beside them in the folder `out`.

    There are so many seeds from the first one on. The salt, up to 32 hexadecimal digits, is fresh
    by default, so that no trying of seeds finds the answers; with it the set can be made again. A
    small set has each effect once at full size, and a few of what is none; with `kind` or
    `conditions` only such cases are made. `step` is called once for each.

    InputError: no case is left, the salt is no number, or `out` exists and `force` is not set.
    """
    first, count = at_least(0, seed, "seed"), at_least(1, seeds, "seeds", most=SEEDS)
    if salt is not None and not re.fullmatch("[0-9a-fA-F]{1,32}", of_kind((str,), salt)):
        raise InputError(f"salt is {salt!r}", expected="1 to 32 hexadecimal digits")
    grain = secrets.randbits(128) if salt is None else int(salt, 16)
    listed = [case for each in range(first, first + count) for case in cases.cases(each, grain)]
    if small:
        listed = list(cases.part(listed))
    if kind is not None:
        listed = [case for case in listed if case.kind == kind]
    if conditions is not None:
        listed = [case for case in listed if case.conditions == conditions]
    if not listed:
        raise InputError(
            "no case is of this kind, under these conditions, and in a small set",
            remedy="leave out --small, --kind or --conditions",
        )
    path = Path(out)
    with stage_folder(path, stage="challenge make", inputs=(), force=force) as folder:
        step.ahead(len(listed))
        make(folder, listed, rate_Hz=rate_Hz, step=step)
    summary = {
        "format": 1,
        "stage": "challenge make",
        "version": __version__,
        "folder": str(path),
        "seed": seed,
        "seeds": seeds,
        "rate_Hz": rate_Hz,
        "cases": dict(Counter(kind_label(case.kind, case.conditions) for case in listed)),
    }
    return SealedSet(summary, path)


def run_set(
    sealed: Named,
    *,
    out: Named,
    tool: Tool = "diagnose",
    workers: int = 1,
    force: bool = False,
    step: Steps = NO_PROGRESS,
) -> EntryResult:
    """Diagnose every case of a sealed set; the answers stay unread.

    Written are `out/ID/diagnosis.json` for each case, by this program or by a baseline. Each of the
    workers does one case at a time, in a process of its own.

    InputError: the set has no cases, the tool is unknown, nobody works, or `out` exists without
    `force`.
    """
    path, folder, many = Path(sealed), Path(out), at_least(1, workers, "workers")
    taken = TOOLS[one_of(tuple(TOOLS), tool, "tool")]
    step.ahead(len(case_folders(path)))
    log = run_cases(path, folder, workers=many, force=force, diagnose=taken, step=step)
    return EntryResult(log, folder)


def score_set(
    sealed: Named, entries: Sequence[Named], *, out: Named | None = None, force: bool = False
) -> Score:
    """Score the answers of one or more tools against the truth, side by side.

    The entries are folders with `ID/diagnosis.json`; `out` gets `score.json`.

    InputError: the set or an answer cannot be read, or `out` exists and `force` is not set.
    """
    folder, inputs = path_of(out), [Path(sealed), *map(Path, entries)]
    with folder_if(folder, stage="challenge score", inputs=inputs, force=force) as written:
        content = score_entries(inputs[0], inputs[1:])
        if written is not None:
            write_json(written / "score.json", content)
    return Score(content, folder)
