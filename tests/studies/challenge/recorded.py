"""Recordings of one case of the blind benchmark."""

from pathlib import Path

import pytest

from tsas_studies.challenge.make import make


def recordings(folder: Path, case, *, rate_Hz: float, runs="abcd") -> Path:
    """Write the dataset of one case, of these runs alone; return its folder."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("tsas_studies.challenge.make.RUNS", runs)
        make(folder, [case], rate_Hz=rate_Hz)
    (dataset,) = (folder / "cases").glob("*/dataset")
    return dataset
