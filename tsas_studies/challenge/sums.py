"""What seals a case: an id that is a checksum of its answer, and those of its recordings."""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tsas_cli.support.errors import InputError
from tsas_cli.support.files import read_json, sha256_of
from tsas_studies.challenge.truth import FILE, Truth

_ID = 32  # hexadecimal digits, 128 bits
CASES, DATASET = "cases", "dataset"  # in the folder of a set, and in that of a case


def sums_of(dataset: Path) -> dict[str, str]:
    """Return the SHA-256 of every file of a dataset, by its path in it."""
    files = sorted(path for path in dataset.rglob("*") if path.is_file())
    return {path.relative_to(dataset).as_posix(): sha256_of(path) for path in files}


def sealed_id(salt: str, answer: Mapping[str, Any]) -> str:
    """Return a case's id: a checksum of the set's salt and of the answer, but for its `sums`."""
    said = {key: value for key, value in answer.items() if key != "sums"}
    text = json.dumps([salt, said], sort_keys=True, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()[:_ID]


def check_answers(sealed: Path) -> None:
    """Refuse answers of a set that are not those from which its cases have their ids.

    A set without a salt is of another tool, or was made before there were any.
    """
    path = sealed / FILE
    content = read_json(path)
    if "salt" not in content:
        return
    for name, answer in content["cases"].items():
        if name != sealed_id(content["salt"], answer):
            raise InputError(
                f"cases.{name} is not the answer that was sealed for this case",
                where=path,
                remedy="make the set again with `tsas challenge make`, of its seed and salt",
            )


def check_recordings(sealed: Path, answers: Truth) -> None:
    """Refuse a set whose recordings are not those that were sealed.

    Recordings that are not beside the answers any more are not looked at, nor those of a set that
    was made without checksums.
    """
    for name, case in answers.cases.items():
        dataset = sealed / CASES / name / DATASET
        if case.sums and dataset.is_dir():
            there = sums_of(dataset)
            for file, digest in case.sums.items():
                if there.get(file) != digest:
                    raise InputError(
                        "is not the recording that was sealed for this case",
                        where=dataset / file,
                        remedy="make the set again with `tsas challenge make`, of its seed and "
                        "salt",
                    )


def check_said(said: object, sums: Mapping[str, str], where: Path) -> None:
    """Refuse a diagnosis that names the checksums of other recordings than those of its case."""
    source = said.get("dataset") if isinstance(said, dict) else None
    hashes = source.get("hashes") if isinstance(source, dict) else None
    if not sums or not isinstance(hashes, dict):
        return
    for file, digest in hashes.items():
        if str(digest).lower() != sums.get(file):
            raise InputError(
                f"was made of another {file} than that of this case",
                where=where,
                remedy="run the tool on the set's own recordings",
            )
