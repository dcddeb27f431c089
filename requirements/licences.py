"""The licence of every locked package, from what it says of itself: `make licences`.

Apache-2.0, the licence of this project, may be combined with permissive licences without more. Of
those with a copyleft the weak ones are allowed where their code stays a package of its own that
the user installs: in an extra, or as a tool of development. None may be needed to run.
"""

import re
import sys
from importlib import metadata
from pathlib import Path

from requirements.locked import DEVELOPMENT, EXTRA, ROOT, RUN, Locked, locked, uses

PAGE = ROOT / "requirements" / "licences.md"
PERMISSIVE = frozenset({
    "0BSD", "Apache-2.0", "Apache-2.0 WITH LLVM-exception", "BSD-2-Clause", "BSD-3-Clause",
    "CC0-1.0", "ISC", "MIT", "MIT-0", "MIT-CMU", "PSF-2.0", "Zlib",
})  # fmt: skip
WEAK = frozenset({"LGPL-2.1-only", "LGPL-3.0-only", "LGPL-3.0-or-later", "MPL-2.0"})
ALLOWED = {RUN: PERMISSIVE, EXTRA: PERMISSIVE | WEAK, DEVELOPMENT: PERMISSIVE | WEAK}
# What older packages write in place of an SPDX expression; "BSD" alone is the one of three clauses.
SPELLINGS = {
    "Apache 2.0": "Apache-2.0",
    "Apache Software License": "Apache-2.0",
    "BSD": "BSD-3-Clause",
    "BSD 2-Clause License": "BSD-2-Clause",
    "BSD 3-Clause License": "BSD-3-Clause",
    "BSD License": "BSD-3-Clause",
    "GNU Lesser General Public License v3 or later (LGPLv3+)": "LGPL-3.0-or-later",
    "ISC License (ISCL)": "ISC",
    "LGPLv3+": "LGPL-3.0-or-later",
    "MIT License": "MIT",
    "Mozilla Public License 2.0 (MPL 2.0)": "MPL-2.0",
    "Python Software Foundation License": "PSF-2.0",
}
# Those whose metadata say nothing or too little, by the text that comes with them.
READ = {
    "apsw": "Zlib",
    "atheris": "Apache-2.0",
    "axe-playwright-python": "MIT",
    "canmatrix": "BSD-2-Clause",
    "colorama": "BSD-3-Clause",  # on Windows only
    "lz4": "BSD-3-Clause",
    "numba": "BSD-2-Clause",
    "protobuf": "BSD-3-Clause",
    "yattag": "LGPL-2.1-only",
    "tzdata": "Apache-2.0",  # on Windows only
    "zstd": "BSD-2-Clause",
}
TITLES = {
    RUN: "Needed to run",
    EXTRA: "Needed by an extra (`tsas[mat]`, `tsas[mdf]`, …)",
    DEVELOPMENT: "Needed to develop and document",
}


class UnknownLicenceError(Exception):
    """A package does not say its licence in any way that is known here."""


def licence(name: str) -> str:
    """Return a package's licence as an SPDX expression.

    Raises
    ------
    UnknownLicenceError
        Neither it nor `READ` says one.
    """
    if name in READ:
        return READ[name]
    try:
        told = metadata.metadata(name)
    except metadata.PackageNotFoundError as error:
        raise UnknownLicenceError(f"{name} is not installed: run make setup") from error
    if expression := told.get("License-Expression"):
        return str(expression)
    free = (told.get("License") or "").strip()
    classified = [line.split(" :: ")[-1] for line in told.get_all("Classifier", [])]
    for said in (free, *classified):
        if (spelled := SPELLINGS.get(said, said)) in PERMISSIVE | WEAK:
            return spelled
    raise UnknownLicenceError(f"{name} says {free[:60]!r}: read its licence, and add it to READ")


def refused(expression: str, use: str) -> list[str]:
    """Return the licences of an expression that must hold and are not allowed for a use."""
    every = [part.strip(" ()") for part in re.split(r"\bAND\b", expression)]
    return [
        part
        for part in every
        if not any(choice.strip(" ()") in ALLOWED[use] for choice in re.split(r"\bOR\b", part))
    ]


def page() -> str:
    """Return the list as Markdown: by use, each package with its locked versions and licence."""
    packages = locked()
    used = uses(packages)
    lines = [
        "# Licences of what tsas is installed with",
        "",
        "Made by `make licences` from the metadata of the packages that `requirements/lock.txt`",
        "holds; a test fails when it is not current, and when a licence is not one that Apache-2.0",
        "may be combined with. Wheels of numpy, scipy and others also hold libraries of their own",
        "(OpenBLAS, the run-time libraries of GCC under its exception); what applies to those",
        "stands in the files beside their metadata.",
    ]
    for use, title in TITLES.items():
        lines += ["", f"## {title}", "", "| package | version | licence |", "|---|---|---|"]
        names = sorted({p.name for p in packages if used.get(p.name) == use})
        lines += [f"| {n} | {_versions(n, packages)} | {licence(n)} |" for n in names]
    return "\n".join(lines) + "\n"


def _versions(name: str, packages: list[Locked]) -> str:
    return ", ".join(str(p.version) for p in packages if p.name == name)


def main() -> int:
    """Write the list; return 1 where a licence is unknown."""
    try:
        text = page()
    except UnknownLicenceError as error:
        print(f"licences: {error}", file=sys.stderr)
        return 1
    Path(PAGE).write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
