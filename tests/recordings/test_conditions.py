import math
import re
import signal
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from tests.refusals import refusal
from tsas_cli.recordings.ingest_map import RunMap, at_most, run_conditions
from tsas_cli.support.errors import InputError

PATH = Path("/rig/L_4/bend180_0,5Hz.csv")
NAME = {"pattern": r"bend(?P<bend>\d+)_(?P<frequency_Hz>[\d,]+)Hz"}


def conditions(header=(), path=PATH, **content):
    return run_conditions(path, header, RunMap.model_validate(content))


BEND = {"total_bend_rad": {"from": "bend", "unit": "deg"}}
STARTED = {"pattern": "run_(?P<started>.*)[.]"}


@pytest.mark.parametrize(
    ("name", "said", "expected"),
    [
        (PATH.name, {}, {}),
        (
            PATH.name,
            {"from_file_name": NAME, "conditions": BEND},
            {"total_bend_rad": pytest.approx(math.pi), "frequency_Hz": 0.5},
        ),
        # Underscores between digits, and dates, are no numbers.
        *((f"run_{text}.csv", {"from_file_name": STARTED}, {"started": text})
          for text in ("1_2", "20240101")),
        (PATH.name, {"id": "{folder}-{stage}-{stem}", "from_file_name": {
            "pattern": r"^L_(?P<stage>\d)/bend"}}, {"id": "L_4-4-bend180_0,5Hz", "stage": 4}),
    ],
)  # fmt: skip
def test_groups_of_the_file_name_become_conditions(name, said, expected):
    """Else the id is the name, and the load is a spring."""
    path = PATH.with_name(name)
    assert conditions(path=path, **said) == {"id": path.stem, "load": "spring"} | expected


def test_a_comma_before_three_digits_is_a_decimal_mark_where_the_map_says_so():
    rules = RunMap.model_validate({"from_header": {"pattern": r"(?P<preload_N>[\d,]+) N"}})
    assert run_conditions(PATH, ["0,250 N"], rules)["preload_N"] == 0.25
    assert run_conditions(PATH, ["1,250 N"], rules, ",")["preload_N"] == 1.25
    with pytest.raises(InputError, match=r"preload_N is 1,250: .* set decimal = \",\""):
        run_conditions(PATH, ["1,250 N"], rules)


def test_the_header_wins_over_the_name_and_the_table_over_both():
    content = {
        "preload_N": 1.0,
        "load": "force",
        "from_file_name": {"pattern": r"bend(?P<preload_N>\d+)"},
        "from_header": {"pattern": r"preload (?P<preload_N>[\d.]+)"},
    }
    header = ("a rig", "preload 25.5 N")
    assert conditions(header, **content)["preload_N"] == 25.5
    content["table"] = {"bend180_0,5Hz": {"preload_N": 30.0}, "other": {"preload_N": 99.0}}
    found = conditions(header, **content)
    assert (found["preload_N"], found["load"]) == (30.0, "force")


def of_preload(group, unit, **name):
    return {
        "from_file_name": name or NAME,
        "conditions": {"preload_N": {"from": group, "unit": unit}},
    }


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ({"from_file_name": {"pattern": "curl(?P<a>.)"}}, "does not match 'L_4/bend180_0,5Hz.csv'"),
        ({"from_header": {"pattern": "x"}}, "does not match"),
        ({"id": "{steam}"}, "did you mean stem?"),
        (of_preload("bond", "N"), "did you mean bend?"),
        (
            of_preload("bend", "deg"),
            "run.conditions.preload_N of the map: unit 'deg' is not convertible to N",
        ),
        (of_preload("w", "N", pattern="(?P<w>bend)"), "group w is 'bend'; expected a number"),
    ],
)
def test_what_is_wrong_is_reported(content, message):
    assert message in refusal(conditions, **content)


def test_a_pattern_that_would_look_for_ever_is_given_up(monkeypatch):
    monkeypatch.setattr("tsas_cli.recordings.ingest_map.SEARCH_TIMEOUT_S", 0.2)
    endless = {"pattern": r"(?P<no>(a|aa|a)+)\d$"}
    with pytest.raises(InputError, match=r"not finished searching .rig/a+. after 0.2 s; nested"):
        conditions(path=Path(f"/rig/{'a' * 40}"), from_file_name=endless)


def test_what_is_late_is_ended_and_what_is_not_goes_on():
    before = signal.getsignal(signal.SIGALRM)
    with pytest.raises(TimeoutError), at_most(0.05):
        re.search("(a|aa)+b", 99 * "a")
    with at_most(1.0):
        pass
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)
    assert signal.getsignal(signal.SIGALRM) == before


def test_beside_the_main_thread_there_is_no_limit():
    def work():
        with at_most(0.01):
            time.sleep(0.05)
            return True

    with ThreadPoolExecutor(1) as pool:
        assert pool.submit(work).result()
