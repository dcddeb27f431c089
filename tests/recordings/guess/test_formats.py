import json

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from asammdf import MDF, Signal
from scipy.io import savemat

from tests.recordings.guess.rig_files import CHANNELS, run, sources
from tests.recordings.readers.matlab_files import controldesk, save_struct_73
from tsas_cli.recordings.guess.proposal import propose
from tsas_cli.recordings.writing import write_parquet


def bracketed(name):
    return "{} [{}]".format(*name.rsplit("_", 1))


def named(by):
    return {by(name): values for name, values in run().items()}


def save_json(path):
    log = {"columns": CHANNELS, "rows": np.transpose([*run().values()]).tolist()}
    path.write_text(json.dumps({"rig": "bench", "log": log}))


def save_capture(path):
    clock, *channels = run().items()
    listed = [(f'"{n}"', values, n.rsplit("_", 1)[1], 1) for n, values in channels]
    savemat(path, {"capture": controldesk([clock[1]], listed)})


def save_mdf(path):
    clock, *channels = run().items()
    with MDF(version="4.10") as file:
        file.append([Signal(values, clock[1], name=n[:-2]) for n, values in channels[2:]])
        other = clock[1] + 1e-4
        file.append([Signal(values, other, name=n[:-3], unit="mm") for n, values in channels[:2]])
        file.save(path, overwrite=True)


@pytest.mark.parametrize(
    ("suffix", "save", "source"),
    [
        (".parquet", lambda p: write_parquet(p, pa.table(run())), "{}".format),
        # As another tool names columns.
        (".parquet", lambda p: pq.write_table(pa.table(named(bracketed)), p), bracketed),
        (".json", save_json, "{}".format),
        (".mat", lambda p: savemat(p, {"gains": np.arange(3.0), "log": run()}), "log.{}".format),
        (".mat", lambda p: save_struct_73(p, "log", run()), "log.{}".format),
        (".mat", save_capture, lambda name: name.replace("time_s", "time")),
    ],
)
def test_every_format_is_opened(tmp_path, suffix, save, source):
    path = tmp_path / f"a{suffix}"
    save(path)
    assert sources(path) == {name: source(name) for name in CHANNELS}
    assert propose([path]).questions == {}


def test_channels_of_two_clocks_are_resampled(tmp_path):
    save_mdf(tmp_path / "a.mf4")
    proposal, found = propose([tmp_path / "a.mf4"]), sources(tmp_path / "a.mf4")
    assert (found["f_out_N"], found["time_s"]) == ("f_out", "time")
    assert proposal.read["resample"][0] is True
    assert len(proposal.questions) == 2
