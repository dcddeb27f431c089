"""What got slower between two runs of the benchmarks is found, and noise is not."""

import json
import subprocess
import sys
from dataclasses import asdict

import pytest

from benchmarks.compare import compare
from benchmarks.row import Row
from benchmarks.timing import Times, times
from benchmarks.yardstick import yardstick
from tsas_cli.support.errors import InputError

QUIET = (0.020, 0.0204, 0.022)  # of the yardstick [s]


def timed(name="chain", least=2.0, usual=1.02, unit="ms", **more):
    """Return a row that was timed often."""
    return Row(name, least, unit, spread=(least, usual * least, 2.0 * least), **more)


def write(path, *rows, yardstick=QUIET, version=1):
    """Write what `make bench` would."""
    told = [asdict(row) | {"kind": row.compared_as, "holds": row.holds} for row in rows]
    found = {"lugre": {"yardstick_s": yardstick, "rows": told}}
    content = {"format": 2, "machine": {}, "yardstick": version, "benchmarks": found}
    path.write_text(json.dumps(content), encoding="utf-8")
    return path


@pytest.fixture
def of(tmp_path):
    """Return a function that compares rows of an old and a new run."""

    def call(old, new, **more):
        paths = write(tmp_path / "old.json", *old), write(tmp_path / "new.json", *new, **more)
        return compare(*paths)

    return call


def verdicts(comparison):
    return [change.verdict for change in comparison.changes]


def test_a_real_slowdown_is_found_and_so_is_what_got_faster(of):
    assert verdicts(of([timed()], [timed(least=2.6)])) == ["SLOWER"]
    assert verdicts(of([timed(least=2.6)], [timed()])) == ["faster"]
    (change,) = of([timed()], [timed(least=2.6)]).slower
    assert (change.name, change.old, change.new) == ("chain", 100.0, 130.0)
    assert change.by == pytest.approx(1.3)


def test_noise_is_not(of):
    assert verdicts(of([timed()], [timed(least=2.2)])) == [""]
    restless = [timed(least=2.6, usual=1.2)]  # its own repeats differ as much
    assert verdicts(of([timed()], restless)) == [""]
    assert verdicts(of([timed()], [timed(least=2.6)], yardstick=(0.02, 0.025, 0.03))) == [""]
    assert verdicts(of([Row("once", 2.0, "s")], [Row("once", 2.9, "s")])) == [""]
    assert verdicts(of([Row("once", 2.0, "s")], [Row("once", 3.2, "s")])) == ["SLOWER"]


def test_a_machine_that_is_half_as_fast_made_nothing_slower(of):
    slow = tuple(2.0 * t for t in QUIET)
    assert verdicts(of([timed()], [timed(least=4.0)], yardstick=slow)) == [""]
    assert verdicts(of([timed()], [timed(least=2.0)], yardstick=slow)) == ["faster"]
    rate = [Row("CSV", 100.0, "MB/s", spread=(98.0, 99.0, 100.0))]
    assert verdicts(of(rate, [Row("CSV", 50.0, "MB/s")], yardstick=slow)) == [""]
    assert verdicts(of(rate, [Row("CSV", 50.0, "MB/s")])) == ["SLOWER"]


@pytest.mark.parametrize(
    ("row", "worse"),
    [
        (Row("over one", 36.0, "", at_most=40.0), 60.0),
        (Row("LSODA, times slower", 33.0, "", at_least=30.0), 20.0),
        (Row("overhead", 3.0, "%", kind="cost"), 6.0),
    ],
)
def test_ratios_within_a_run_need_no_yardstick(of, row, worse):
    slow = tuple(2.0 * t for t in QUIET)
    other = Row(**(asdict(row) | {"value": worse}))
    assert verdicts(of([row], [row], yardstick=slow)) == [""]
    assert verdicts(of([row], [other])) == ["SLOWER"]
    assert verdicts(of([other], [row])) == ["faster"]


def test_what_is_no_speed_is_not_compared(of):
    figures = [
        Row("error", 0.03, "%", at_most=0.05),
        Row("memory", 40.0, "MB"),
        Row("not finite", 0.0, "", at_most=0),
        Row("no such solver", float("nan"), "s"),
    ]
    worse = [Row(**(asdict(row) | {"value": 10.0 * row.value + 1.0})) for row in figures]
    assert of(figures, worse[:3] + figures[3:]).changes == ()


def test_rows_of_one_run_alone_are_named(of):
    found = of([timed("a"), timed("b")], [timed("b"), timed("c")])
    assert found.missing == ("lugre · a",)
    assert found.added == ("lugre · c",)
    titles = [title for title, _, _ in found.tables()]
    assert titles == ["0 slower, 0 faster, 1 alike", "only in the old run", "only in the new"]


def test_other_files_are_refused(tmp_path):
    good = write(tmp_path / "good.json", timed())
    for text, said in (("[]", "format None"), ('{"format": 1}', "format 1"), ("{", "not JSON")):
        other = tmp_path / "other.json"
        other.write_text(text)
        with pytest.raises(InputError, match=said):
            compare(good, other)
    with pytest.raises(InputError, match="another yardstick"):
        compare(good, write(tmp_path / "later.json", timed(), version=2))


def test_the_command_tells_by_its_exit_code(tmp_path):
    old, new = write(tmp_path / "a.json", timed()), write(tmp_path / "b.json", timed(least=3.0))

    def call(*files):
        line = [sys.executable, "-m", "benchmarks", "compare", *map(str, files)]
        return subprocess.run(line, capture_output=True, text=True, check=False)

    assert call(old, old).returncode == 0
    slower = call(old, new)
    assert slower.returncode == 1
    assert "chain" in slower.stdout
    assert "1.50 times" in slower.stdout
    missing = call(old, tmp_path / "none.json")
    assert (missing.returncode, missing.stderr.count("\n")) == (2, 1)


def test_repeats_keep_their_spread():
    took = Times((3.0, 1.0, 2.0, 9.0))
    assert (took.least, took.median, took.largest) == (1.0, 2.5, 9.0)
    row = Row.timed("x", took, "ms", per_s=1e3, at_most=5.0)
    assert (row.value, row.spread, row.holds) == (1000.0, (1000.0, 2500.0, 9000.0), False)
    calls = []
    assert len(times(lambda: calls.append(1), 4).seconds) == 4
    assert len(calls) == 5  # the first one compiles


def test_the_yardstick_takes_long_enough_to_be_timed():
    assert yardstick().least > 1e-3
