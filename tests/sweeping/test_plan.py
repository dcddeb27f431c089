"""The plan: what may stand in it, and the points that it asks for."""

import math
from itertools import pairwise

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tsas_cli.stages.sweep import options_of
from tsas_cli.support.errors import InputError
from tsas_cli.sweeping.plan import points_of, read_plan
from tsas_cli.sweeping.values import sorted_values

SIMULATE = {"stage": "simulate", "datasets": "rigs/*"}


def points(tmp_path, **more):
    plan, _ = read_plan(SIMULATE | more)
    return points_of(plan, tmp_path)


def test_a_plan_from_a_file_begins_its_paths_there(tmp_path):
    (tmp_path / "plan.toml").write_text('stage = "simulate"\ndatasets = "rigs/*"\n')
    plan, base = read_plan(tmp_path / "plan.toml")
    assert (plan.stage, plan.datasets, base) == ("simulate", ("rigs/*",), tmp_path)


def test_a_grid_takes_every_combination_the_last_axis_first_and_a_zip_goes_side_by_side(tmp_path):
    assert points(tmp_path) == [{}]
    vary = {"preload_N": [1, 2], "nodes": [10, 20]}
    found = [tuple(point.values()) for point in points(tmp_path, vary=vary)]
    assert found == [(1, 10), (1, 20), (2, 10), (2, 20)]
    found = points(tmp_path, vary=vary, combine="zip")
    assert found == [{"preload_N": 1, "nodes": 10}, {"preload_N": 2, "nodes": 20}]


def test_a_range_has_both_ends_and_equal_distances_or_ratios(tmp_path):
    linear = points(tmp_path, vary={"preload_N": {"from": 10, "to": 40, "steps": 4}})
    assert [p["preload_N"] for p in linear] == [10.0, 20.0, 30.0, 40.0]
    log = {"from": 0.01, "to": 10.0, "steps": 4, "scale": "log"}
    found = [p["nodes"] for p in points(tmp_path, vary={"nodes": log})]
    assert (found[0], found[-1]) == (0.01, 10.0)
    assert all(math.isclose(b / a, 10.0) for a, b in pairwise(found))


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_a_table_of_sets_is_taken_row_by_row(tmp_path, suffix):
    (tmp_path / "sets.csv").write_text("preload_N,nodes\n20,10\n25,\n30,30\n")
    table = pa.table({"preload_N": [20.0, 25.0, 30.0], "nodes": [10, None, 30]})
    pq.write_table(table, tmp_path / "sets.parquet")
    found = points(tmp_path, sets=f"sets.{suffix}", vary={"fit_own": [True, False]})
    assert len(found) == 6
    assert found[0] == {"preload_N": 20, "nodes": 10, "fit_own": True}
    assert found[3] == {"preload_N": 25, "fit_own": False}


def test_a_set_that_says_nan_is_no_set_without_the_value(tmp_path):
    (tmp_path / "sets.csv").write_text("preload_N,model\n20,\nnan,m.toml\n")
    first, second = points(tmp_path, sets="sets.csv")
    assert first == {"preload_N": 20.0}
    with pytest.raises(InputError, match="preload_N is nan; expected a finite number"):
        sorted_values({"preload_N": second["preload_N"]}, options_of("simulate"), tmp_path)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"stage": "report"}, "stage: input should be"),
        ({"datasets": []}, "datasets is missing: simulate needs at least one"),
        ({"stage": "track"}, "track has no datasets"),
        ({"varied": {}}, "unknown key varied .did you mean vary"),
        ({"vary": {"nodes": []}}, "vary.nodes"),
        (
            {"vary": {"nodes": {"from": 0, "to": 1, "steps": 1}}},
            r"[^;]*vary.nodes.steps: input should be greater than or equal to 2, got 1$",
        ),
        ({"vary": {"nodes": "x"}}, r"[^;]*vary.nodes: input should be a list, got"),
        ({"vary": {"nodes": {"from": 0, "to": 1, "steps": 3, "scale": "log"}}}, "positive ends"),
        ({"vary": {"a": [1], "b": [1, 2]}, "combine": "zip"}, "differ in length: a 1, b 2"),
        ({"vary": {"nodes": [1]}, "options": {"nodes": 2}}, "nodes is in options and in vary"),
        ({"each_run": True, "options": {"runs": ["a"]}}, "leave out runs"),
        ({"vary": {"a": list(range(2000)), "b": list(range(2000))}}, "4000000 points; expected at"),
        ({"sets": "none.csv"}, r"none.csv: cannot be read"),
    ],
)
def test_what_is_wrong_with_a_plan_is_reported(tmp_path, more, message):
    with pytest.raises(InputError, match=message):
        points(tmp_path, **more)


def test_a_name_in_the_table_and_in_the_plan_is_refused(tmp_path):
    (tmp_path / "sets.csv").write_text("nodes\n10\n")
    with pytest.raises(InputError, match=r"nodes is in the plan and in sets\.csv"):
        points(tmp_path, sets="sets.csv", vary={"nodes": [10]})
    (tmp_path / "none.csv").write_text("nodes\n")
    with pytest.raises(InputError, match="0 rows"):
        points(tmp_path, sets="none.csv")
