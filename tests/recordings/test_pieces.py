"""A recording that is read in pieces: every row once, and a small part of it in memory."""

import numpy as np
import pyarrow as pa
import pytest

from tests.recordings.rewritten import rewrite
from tsas_cli.recordings import pieces as reading
from tsas_cli.recordings.run_files import open_run
from tsas_cli.support.errors import InputError

GROUP, GROUPS = 4096, 60


def test_every_row_is_read_and_a_small_part_is_held(dataset, monkeypatch):
    rng = np.random.default_rng(1)
    values = {name: rng.standard_normal(GROUP * GROUPS) for name in ("x_in_mm", "f_in_N")}
    table = pa.table({"time_s": np.arange(GROUP * GROUPS) / 100.0} | values)
    run = rewrite(dataset, table, row_group_size=GROUP)
    monkeypatch.setattr(reading, "MOST_ROWS", GROUP)
    before, allocated, seen = pa.total_allocated_bytes(), [], []
    for piece in reading.pieces(open_run(dataset, run), table.column_names):
        allocated.append(pa.total_allocated_bytes() - before)
        seen.append(piece.columns["f_in_N"])
    assert (np.concatenate(seen) == values["f_in_N"]).all()
    assert max(allocated) < (dataset / run.file).stat().st_size / 10


def test_a_value_that_no_rig_has_is_named_with_its_row_in_the_run(dataset, monkeypatch):
    values = np.ones(3000)
    values[2100] = 1e10
    table = pa.table({"time_s": np.arange(3000) / 100.0, "x_in_mm": values, "f_in_N": values})
    monkeypatch.setattr(reading, "MOST_ROWS", 1000)
    opened = open_run(dataset, rewrite(dataset, table))
    with pytest.raises(InputError, match=r"row 2100: x_in_mm is 1e\+10; expected"):
        list(reading.pieces(opened, table.column_names))
    assert len(list(reading.pieces(opened, table.column_names, strict=False))) == 3


@pytest.mark.parametrize(("pause_s", "refused"), [(100.0, False), (1e5, True)])
def test_a_pause_in_the_last_few_rows_is_one_beside_the_whole_run(
    dataset, monkeypatch, pause_s, refused
):
    """The last piece has two rows, 0.02 s without the pause; the run has 30 s."""
    time_s = np.arange(3002) / 100.0 + pause_s * (np.arange(3002) == 3001)
    values = np.ones(time_s.size)
    table = pa.table({"time_s": time_s, "x_in_mm": values, "f_in_N": values})
    monkeypatch.setattr(reading, "MOST_ROWS", 1000)
    opened = open_run(dataset, rewrite(dataset, table))
    if refused:
        with pytest.raises(InputError, match="row 3001: the recording pauses for"):
            list(reading.pieces(opened, table.column_names))
    else:
        assert sum(p.rows for p in reading.pieces(opened, table.column_names)) == time_s.size
