import numpy as np
import pyarrow.parquet as pq
import pytest

from tsas_cli.recordings.dataset import read_dataset
from tsas_studies.challenge.rig.motions import through
from tsas_studies.challenge.rig.recordings import Run, conditions, record, write_dataset
from tsas_studies.challenge.rig.tendon import Rig

MOTION = through([2.0, 0.0])


def test_the_product_reads_what_the_rig_writes(tmp_path):
    rig = Rig(preload_N=31.0)
    columns = record(rig, MOTION, seed=4)
    columns["f_in_N"][7] = np.nan
    write_dataset(tmp_path / "d", [Run("one", columns, conditions(rig))], license="CC0-1.0")
    dataset = read_dataset(tmp_path / "d")
    assert dataset.manifest.kind == "simulated"
    assert dataset.manifest.license == "CC0-1.0"
    assert dataset.manifest.rig.tendon_modulus_GPa == 60.0
    (recording,) = dataset
    assert recording.run.preload_N == 31.0
    assert recording.run.total_bend_rad == pytest.approx(np.pi)
    for name, values in columns.items():
        np.testing.assert_array_equal(recording.columns[name], values)


def test_units_and_gaps_are_in_the_file(tmp_path):
    columns = record(Rig(), MOTION)
    columns["f_out_N"][3] = np.nan
    write_dataset(tmp_path, [Run("one", columns)])
    table = pq.read_table(tmp_path / "runs" / "one.parquet")
    assert table.schema.field("x_out_mm").metadata == {b"unit": b"mm"}
    assert table.column("f_out_N").null_count == 1
    assert table.column("f_in_N").null_count == 0
