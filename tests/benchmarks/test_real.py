"""The benchmark on public recordings: its splits, its regression, its table."""

import numpy as np
import pytest

from benchmarks.real.__main__ import PAGE
from benchmarks.real.learning import MAPS, Learned
from benchmarks.real.ridge import ridge_errors
from benchmarks.real.splits import SUMS, Split, splits
from benchmarks.real.table import BEGIN, END, lines_of, with_lines


@pytest.mark.parametrize("split", list(splits()), ids=lambda split: split.name)
def test_a_split_predicts_what_it_has_not_learned(split):
    assert split.learned
    assert not set(split.learned) & set(split.predicted)
    assert split.predicted or split.said["drive"]
    assert (MAPS / split.said["map"]).is_file()
    assert {"repository", "commit", "licence", "reference"} <= set(split.said)


def test_every_checksum_is_of_a_split():
    assert set(SUMS) == {name for s in splits() for name in (*s.learned, *s.predicted)}


def test_files_that_are_missing_or_other_ones_are_named(tmp_path):
    name = next(iter(SUMS))
    split = Split("a/b", (name,), (), {})
    assert split.faults(tmp_path) == [f"{name} is missing"]
    (tmp_path / name).parent.mkdir(parents=True)
    (tmp_path / name).write_text("1, 2")
    assert split.faults(tmp_path) == [f"{name} is another file"]


def test_a_regression_finds_a_play_under_a_load():
    def run(load, offset):
        t = np.arange(0.0, 20.0, 0.01)
        x, play = 5.0 * np.sin(t), np.empty(t.size)
        at = 0.0
        for i, place in enumerate(x):
            at = min(max(at, place - 0.625), place + 0.625)  # an eighth of the stroke
            play[i] = at
        f_out = np.full(t.size, load)
        return {
            "time_s": t,
            "x_in_mm": x,
            "f_out_N": f_out,
            "f_in_N": load * (1.0 + x - play) + offset,
        }

    errors = ridge_errors([run(10.0, 0.0), run(20.0, 3.0)], [run(15.0, -7.0)], "f_in_N", 2.0)
    assert len(errors) == 1
    assert errors[0].size == 2000
    assert np.sqrt(np.mean(errors[0][200:] ** 2)) < 0.02 * 15.0 * 0.6


def test_a_run_replaces_its_own_lines_of_the_page():
    page = f"before\n{BEGIN}\n{END}\nafter\n"
    split = Split("a/b", (), (), {"published": {"f_in_N": "0.5"}})
    errors = {"nominal": [1.0, 2345.6], "extended": [0.5] * 5, "repeatability": [None, 0.25]}
    lines = lines_of(split, Learned("named", "It lacks play.", {"f_in_N": errors}))
    assert lines == [
        "| a/b | f_in_N | 1 / 2350 | 0.5 (0.5 to 0.5) |  | 0.5 | 0.25 |",
        "- a/b: `named`. It lacks play.",
    ]
    order = ["a", "a/b", "c"]
    for name, new in (("c", ["| c | x |", "- c: z"]), ("a/b", ["| a/b | old |"]), ("a/b", lines)):
        page = with_lines(page, name, new, order)
    table = page.split("|---|\n")[1]
    assert table == f"{lines[0]}\n| c | x |\n\n{lines[1]}\n- c: z\n{END}\nafter\n"
    assert page.startswith(f"before\n{BEGIN}\n| split | channel | nominal |")


def test_the_page_has_a_place_for_it():
    page = PAGE.read_text(encoding="utf-8")
    assert page.count(BEGIN) == page.count(END) == 1
