"""What the stage writes beside the diagnosis: both models, and what they answer."""

from itertools import pairwise

import numpy as np
import pyarrow.parquet as pq
import pytest

from tests.rigs import dataset_of, recorded
from tsas_cli.diagnosis.diagnose import Diagnosis
from tsas_cli.diagnosis.proof import FoundCause
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model
from tsas_cli.identification.model_file import read_fitted_to, read_model
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.stages import diagnose as diagnose_stage
from tsas_studies.challenge.rig.tendon import Rig

TRUE = Rig(proximal_length_mm=150.0, cells=60)
LENGTH = Estimate("free_tendon.proximal_length_mm", 150.0, "mm", "fitted")


def diagnosing(patch, folder, found, **options):
    """Diagnose a run whose search finds what a function makes of the stated values."""
    dataset = read_dataset(dataset_of(TRUE, folder / "dataset", a=recorded(TRUE)))
    patch.setattr(diagnose_stage, "diagnose_runs", lambda _, stated, *__, **___: found(stated))
    return dataset, diagnose_stage.diagnose(dataset, **options)


@pytest.fixture(scope="module")
def diagnosed(tmp_path_factory):
    """A run whose recordings are known to need a free length, which the nominal model lacks."""

    def known(stated):
        return Diagnosis("named", "known", model=Model((LENGTH,)).over(stated), nominal=stated)

    folder = tmp_path_factory.mktemp("diagnosed")
    with pytest.MonkeyPatch.context() as patch:
        (recording,), result = diagnosing(patch, folder, known, out=folder / "out")
    return recording, result, folder / "out"


def test_each_model_answers_under_its_own_name(diagnosed):
    recording, _, out = diagnosed
    table = pq.read_table(out / "runs" / "a.parquet")
    assert (table.column("time_s").to_numpy() == recording.time_s).all()
    rmse = {
        name: np.sqrt(np.mean((recording.columns["f_in_N"] - table.column(name).to_numpy()) ** 2))
        for name in ("f_in_N", "f_in_nominal_N")
    }
    assert rmse["f_in_N"] < 0.2
    assert rmse["f_in_nominal_N"] > 0.8
    others = {"x_in_mm", "f_out_N", "x_out_mm", "f_out_nominal_N", "x_out_nominal_mm"}
    assert others <= set(table.column_names)
    cleaned = table.column("x_in_mm").to_numpy() - recording.columns["x_in_mm"]
    assert 0.0 < np.abs(cleaned).max() < 0.05


def test_the_models_differ_by_what_is_named(diagnosed):
    *_, out = diagnosed
    extended, nominal = (
        {(e.name, e.run): e.value for e in read_model(out / name).estimates}
        for name in ("model-extended.toml", "model-nominal.toml")
    )
    assert extended.keys() - nominal.keys() == {(LENGTH.name, None)}
    assert nominal.items() <= extended.items()


def test_each_model_says_the_ranges_that_it_was_fitted_to(diagnosed):
    recording, _, out = diagnosed
    extended, nominal = (read_fitted_to(out / f"model-{n}.toml") for n in ("extended", "nominal"))
    assert extended == nominal
    assert extended.ranges["total_bend_rad"] == (recording.run.total_bend_rad,) * 2
    low, high = extended.ranges["f_in_N"]
    f_in_N = recording.columns["f_in_N"]
    assert np.mean((f_in_N >= low) & (f_in_N <= high)) == pytest.approx(0.99, abs=1e-3)


def test_the_phases_follow_each_other_over_the_whole_run(diagnosed):
    recording, result, _ = diagnosed
    segments = result.summary["segments"]["a"]
    assert segments[0]["start_s"] == recording.time_s[0]
    assert segments[-1]["end_s"] == recording.time_s[-1]
    assert all(a["end_s"] == b["start_s"] for a, b in pairwise(segments))
    assert {"contraction", "loosening", "dead_band_down"} <= {s["phase"] for s in segments}


def test_what_contradicts_the_data_sheet_is_said_beside_the_causes(tmp_path, monkeypatch):
    """Both forces at half: a compliant sheath is named, and had no rival."""
    half = [
        Estimate("load_stiffness_N_per_mm", 0.79, "N/mm", "fitted", None, 0.01, 0.77, 0.81),
        Estimate("preload_N", 12.5, "N", "fitted", "a", 0.1, 12.3, 12.7),
    ]
    cause = FoundCause("sheath_compression", (), (), 40.0, (30.0, 50.0))

    def found(stated):
        model = Model(tuple(half)).over(stated)
        return Diagnosis("named", "known", model=model, nominal=stated, causes=(cause,))

    (said,) = diagnosing(monkeypatch, tmp_path, found)[1].summary["cannot_tell"]
    assert said.startswith("A common factor of f_in and f_out of 0.5")
    assert said.endswith("Either would be a rival of sheath_compression.")


@pytest.mark.parametrize("proven", [True, False])
def test_what_gains_and_is_not_proven_has_a_model_of_its_own(tmp_path, monkeypatch, proven):
    gains = FoundCause("free_tendon", (), (LENGTH,), 40.0, (30.0, 50.0), ("may be zero",))

    def found(stated):
        whole = Model((LENGTH,)).over(stated)
        if proven:
            return Diagnosis("named", "known", model=whole, nominal=stated)
        return Diagnosis(
            "stand_in", "", model=stated, nominal=stated, stand_ins=(gains,), stand_in_model=whole
        )

    _, result = diagnosing(monkeypatch, tmp_path, found, out=tmp_path / "out")
    model = tmp_path / "out" / "model-stand-in.toml"
    assert model.exists() != proven
    assert bool(result.summary["stand_ins"]) != proven
    if not proven:
        assert read_model(model).value(LENGTH.name) == 150.0
        assert read_model(tmp_path / "out" / "model-extended.toml").value(LENGTH.name) is None
