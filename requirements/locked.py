"""What requirements/lock.txt holds: each version with its marker, its hashes, and who needs it."""

import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
LOCK = ROOT / "requirements" / "lock.txt"
PROJECT = ROOT / "pyproject.toml"
BLOCK = re.compile(r"\n(?=[A-Za-z0-9])")
HASH = re.compile(r"--hash=sha256:([0-9a-f]{64})\b")
ASKED_BY = re.compile(r"^ {4}#(?: via)? +([A-Za-z0-9][\w.-]*)", flags=re.MULTILINE)
RUN, EXTRA, DEVELOPMENT = "run", "extra", "development"


@dataclass(frozen=True)
class Locked:
    """One version of one package; some have another version for another Python."""

    requirement: Requirement
    hashes: tuple[str, ...]
    asked_by: tuple[str, ...]

    @property
    def name(self) -> str:
        """The package's name, as the index spells it."""
        return canonicalize_name(self.requirement.name)

    @property
    def version(self) -> str | None:
        """The version, None where the lock leaves a choice."""
        pins = list(self.requirement.specifier)
        exact = len(pins) == 1 and pins[0].operator == "==" and "*" not in pins[0].version
        return pins[0].version if exact else None


def locked() -> list[Locked]:
    """Return all that the lock holds."""
    return [_locked(block) for block in BLOCK.split(LOCK.read_text(encoding="utf-8"))]


def _locked(block: str) -> Locked:
    line = block.split("\\", 1)[0].split("\n", 1)[0]
    return Locked(Requirement(line), tuple(HASH.findall(block)), tuple(ASKED_BY.findall(block)))


def asked() -> dict[str, list[Requirement]]:
    """Return what pyproject.toml asks for: to run, for extras, and to develop."""
    content = tomllib.loads(PROJECT.read_text(encoding="utf-8"))
    project = content["project"]
    extras = [line for lines in project["optional-dependencies"].values() for line in lines]
    groups = [line for lines in content["dependency-groups"].values() for line in lines]
    listed = {RUN: project["dependencies"], EXTRA: extras, DEVELOPMENT: groups}
    return {
        use: [r for r in map(Requirement, lines) if r.name != project["name"]]
        for use, lines in listed.items()
    }


def uses(packages: Sequence[Locked]) -> dict[str, str]:
    """Return for each package the first of the uses that needs it, directly or by another one."""
    found: dict[str, str] = {}
    for use, requirements in asked().items():
        waiting = [canonicalize_name(r.name) for r in requirements]
        while waiting:
            name = waiting.pop()
            if name not in found:
                found[name] = use
                waiting += [p.name for p in packages if name in p.asked_by]
    return found
