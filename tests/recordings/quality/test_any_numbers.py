"""Whatever numbers a recording holds, the checks end with sentences."""

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.quality import check_dataset
from tsas_studies.challenge.rig.recordings import Run, write_dataset

NAMES = ("x_in_mm", "x_out_mm", "f_in_N", "f_out_N", "motor_speed_rpm")
RAW = {
    "noise": lambda rng, n: rng.standard_normal(n),
    "walk": lambda rng, n: np.cumsum(rng.standard_normal(n)),
    "sine": lambda rng, n: 10.0 * np.sin(np.arange(n) / 7.0),
    "steps": lambda rng, n: np.round(rng.standard_normal(n)),
    "constant": lambda rng, n: np.full(n, 3.0),
    "ramp": lambda rng, n: np.linspace(0.0, 1.0, n),
    "holes": lambda rng, n: np.where(rng.random(n) < 0.5, np.nan, rng.standard_normal(n)),
    "huge": lambda rng, n: 1e300 * rng.standard_normal(n),
    "empty": lambda rng, n: np.full(n, np.nan),
}


@settings(
    max_examples=settings.default.max_examples * 6 // 10,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(
    shapes=st.tuples(*[st.sampled_from(sorted(RAW))] * len(NAMES)),
    rows=st.sampled_from([2, 3, 17, 60, 300]),
    load=st.sampled_from(["spring", "force", "displacement"]),
    ordered=st.booleans(),
    seed=st.integers(0, 2**32 - 1),
)
def test_the_checks_never_fail(tmp_path_factory, shapes, rows, load, ordered, seed):
    rng = np.random.default_rng(seed)
    time = np.arange(rows) * 0.01 if ordered else rng.standard_normal(rows)
    data = {name: RAW[shape](rng, rows) for name, shape in zip(NAMES, shapes, strict=True)}
    run = Run("a", {"time_s": time} | data, {"load": load})
    folder = write_dataset(tmp_path_factory.mktemp("any"), [run], data_sheet={})
    report = check_dataset(read_dataset(folder))
    assert all(np.isfinite(f.first_s) for f in report.findings if f.first_s is not None)
    assert not any(word in f.sentence for f in report.findings for word in ("nan", " inf"))
