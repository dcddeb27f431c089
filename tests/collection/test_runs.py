import os
import shutil
from datetime import UTC, datetime
from pathlib import Path

import pytest

import tsas_cli as tsas
from tests.collection.collected import ROWS, RATE_Hz, write
from tests.counted import Counted
from tests.reporting.made_diagnoses import make_diagnosis
from tsas_cli.collection import COLUMNS, query
from tsas_cli.collection.entries import entry_of
from tsas_cli.collection.query import connected
from tsas_cli.support.errors import InputError


@pytest.fixture
def cache(tmp_path_factory, monkeypatch):
    folder = tmp_path_factory.mktemp("cache")
    monkeypatch.setenv("TSAS_CACHE_DIR", str(folder))
    return folder


@pytest.fixture(autouse=True)
def rigs(tmp_path, monkeypatch, cache):
    """Stand in a folder with two datasets."""
    write(
        tmp_path / "one" / "a",
        {"total_bend_rad": 3.5, "started": "2026-02-03T10:00:00", "operator": "bo"},
        {"total_bend_rad": 1.0, "started": "2025-12-31T23:00:00-02:00", "load": "force"},
    )
    write(tmp_path / "two", {"total_bend_rad": 4.0, "preload_N": 25.0}, channels=("f_in_N",))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def found(*call, **options):
    rows = tsas.runs(*call, **options).summary["runs"]
    return [(row["folder"], row["run"]) for row in rows]


def test_a_query_is_a_condition_over_all_runs():
    assert found() == [("one/a", "r0"), ("one/a", "r1"), ("two", "r0")]
    assert found("total_bend_rad > 3") == [("one/a", "r0"), ("two", "r0")]
    assert found("total_bend_rad > 3 and 'f_out_N' in channels") == [("one/a", "r0")]
    both = "load = 'force' or preload_N between 20 and 30"
    assert found(both) == [("one/a", "r1"), ("two", "r0")]
    assert found("tags['operator'] = 'bo'") == [("one/a", "r0")]


def test_what_is_reported_of_a_run(rigs):
    row, other, _ = tsas.runs().summary["runs"]
    assert tuple(row) == COLUMNS
    assert (row["dataset"], row["kind"], row["load"], row["gear_ratio"]) == (
        "a", "measured", "spring", 5.0
    )  # fmt: skip
    assert (row["rows"], row["channels"], row["tags"]) == (
        ROWS, ["x_in_mm", "f_out_N"], {"operator": "bo"}
    )  # fmt: skip
    assert row["duration_s"] == pytest.approx((ROWS - 1) / RATE_Hz)
    assert row["rate_Hz"] == pytest.approx(RATE_Hz)
    assert row["bytes"] == (rigs / "one/a/runs/r0.parquet").stat().st_size
    assert row["verdict"] is row["causes"] is row["diagnosed"] is None
    assert (row["started"], other["started"]) == ("2026-02-03T10:00:00", "2026-01-01T01:00:00")


def test_dates_and_channels_need_no_quotes():
    assert found("started >= 2026-01-02 and f_out in channels") == [("one/a", "r0")]
    assert found("started < 2026-02") == [("one/a", "r1")]
    assert found("f_in NOT IN channels") == [("one/a", "r0"), ("one/a", "r1")]


def test_verdicts_are_those_of_the_latest_diagnosis_of_the_same_manifest(rigs):
    old = make_diagnosis(rigs / "two", rigs / "results" / "old", "named")
    make_diagnosis(rigs / "two", rigs / "results" / "new", "sufficient")
    os.utime(old / "diagnosis.json", (1, 1))
    make_diagnosis(rigs / "one" / "a", rigs / "one" / "a" / "d", "named", chosen=["r1"])
    rows = tsas.runs(columns=["verdict", "causes"]).summary["runs"]
    assert [(row["verdict"], row["causes"]) for row in rows] == [
        (None, None), ("named", ["free_tendon"]), ("sufficient", [])
    ]  # fmt: skip
    assert found("'free_tendon' in causes") == [("one/a", "r1")]
    manifest = rigs / "two" / "dataset.toml"
    manifest.write_text(manifest.read_text() + "\n# mended\n")
    assert found("verdict = 'sufficient'") == []


def test_only_what_has_changed_is_read_again(rigs):
    first, again, changed = Counted(), Counted(), Counted()
    tsas.runs(step=first)
    tsas.runs(step=again)
    manifest = rigs / "two" / "dataset.toml"
    manifest.write_text(manifest.read_text().replace("4.0", "0.5"))
    assert found("total_bend_rad = 0.5", step=changed) == [("two", "r0")]
    assert (first.done, again.done, changed.done) == (2, 0, 1)
    for path in (manifest, rigs / "one" / "a" / "dataset.toml"):
        path.write_text(path.read_text() + "\n# changed\n")
    assert len(found(step=changed)) == 3
    assert changed.done == 1 + 2


def test_new_datasets_come_in_and_deleted_ones_go(rigs):
    tsas.runs()
    shutil.rmtree(rigs / "two")
    assert found() == [("one/a", "r0"), ("one/a", "r1")]
    write(rigs / "one" / "b", {})
    assert found() == [("one/a", "r0"), ("one/a", "r1"), ("one/b", "r0")]
    shutil.rmtree(rigs / "one")
    assert found() == []


def test_a_wrong_call_reads_nothing():
    read = Counted()
    with pytest.raises(InputError, match="expected str"):
        tsas.runs(5, step=read)
    assert read.done == 0


def test_a_wrong_manifest_is_reported_and_the_rest_is_answered(rigs):
    (rigs / "bad").mkdir()
    (rigs / "bad" / "dataset.toml").write_text("format = 2")
    (rigs / "two" / "runs" / "r0.parquet").write_bytes(b"no")
    for _ in range(2):  # from the files, and from the index
        result = tsas.runs()
        assert len(result.summary["runs"]) == 3
        about_bad, about_two = result.summary["problems"]
        assert about_bad.startswith("bad/dataset.toml: format: input should be 1, got 2")
        assert about_two.startswith("two/dataset.toml: runs/r0.parquet: ")
        assert "bad/dataset.toml" in repr(result)
    assert result.summary["runs"][2]["rows"] is None


@pytest.mark.parametrize("every", [11, pytest.param(1, marks=pytest.mark.large)])
def test_a_damaged_footer_is_reported_or_taken_and_ends_nothing(tmp_path, every):
    folder = write(tmp_path / "a[1] *", {}, {})
    path = folder / "runs" / "r0.parquet"
    whole = path.read_bytes()
    connection = connected()
    (run, other) = entry_of(connection, folder, "dataset.toml")["runs"]
    assert run["duration_s"] == other["duration_s"] == pytest.approx((ROWS - 1) / RATE_Hz)
    faults = 0
    footer = range(len(whole) - 8 - int.from_bytes(whole[-8:-4], "little"), len(whole))
    for place in footer[::every]:
        for bits in (1, 48):  # 48: some column has a lowest value and no highest one
            path.write_bytes(whole[:place] + bytes([whole[place] ^ bits]) + whole[place + 1 :])
            entry = entry_of(connection, folder, "dataset.toml")
            faults += len(entry["problems"])
            assert entry["runs"][1] == other
    assert faults > 100 / every


def test_folders_are_named_as_they_were_given(rigs):
    assert found(folders="two") == [("two", "r0")]
    assert found(folders=[rigs / "one", "two"]) == [
        (f"{rigs}/one/a", "r0"), (f"{rigs}/one/a", "r1"), ("two", "r0")
    ]  # fmt: skip
    assert tsas.runs(folders="one").paths == ("one/a",)


def test_hidden_folders_and_links_are_left_alone(rigs):
    shutil.copytree(rigs / "two", rigs / ".two.tmp")
    (rigs / "loop").symlink_to(rigs)
    assert len(found()) == 3


def test_sorting_limit_and_columns():
    result = tsas.runs(sort=["-total_bend_rad"], columns=["total_bend_rad"], limit=2)
    assert result.summary["runs"] == [{"total_bend_rad": 4.0}, {"total_bend_rad": 3.5}]
    assert (result.summary["fitting"], result.summary["all_runs"]) == (3, 3)
    assert result.tables()[0][0] == "3 of 3 runs, the first 2 of them"
    assert result.paths == ("two", "one/a")
    first = tsas.runs(sort=["preload_N"], limit=1)  # what is missing comes last
    assert first.summary["runs"][0]["preload_N"] == 25.0


def test_the_frame_has_a_row_for_each_run():
    frame = tsas.runs("folder = 'one/a'").frame()
    assert list(frame.columns) == list(COLUMNS)
    assert frame["total_bend_rad"].tolist() == [3.5, 1.0]
    assert frame["started"].dt.month.tolist() == [2, 1]
    assert frame["diagnosed"].isna().all()


@pytest.mark.parametrize(
    ("query", "line"),
    [
        ("rows > 1 and bend > 3", "the query, character 14, at 'bend > 3': there is no column be"),
        ("started > 2026-01 and rows >> and 3", "the query, character 31, at 'and 3': syntax"),
        ("f_uot in channels", "the query: no run has a channel f_uot; did you mean f_out_N?"),
        ("one", "the query, character 1, at 'one': there is no column one; name folders with --in"),
        ("a" * 300, "the query, character 1, at 'aaaaaaaaaaaaaaaaaaaa': there is no column aaa"),
        ("run > 3", "the query: Cannot compare values"),
        ("started > 2026-13", "the query: timestamp field value out of range"),
        ("rows > 1) union select (1", "the query, character 9, at ') union select (1'"),
        ("true; drop table runs", "the query: Cannot have any modifiers"),
        ("run in (select content from read_text('/etc/hostname'))", "the query: Cannot access"),
        ("run in (select file from glob('*'))", "the query: Cannot access"),
        ("run in (select file from entries)", "the query: Table with name entries does not exist"),
        ("sum(rows) > 3", "the query: WHERE clause cannot contain aggregates"),
        ({"columns": ["bend"]}, "there is no column 'bend'"),
        ({"sort": ["-row"]}, "there is no column 'row'; did you mean rows?"),
        ({"folders": "nowhere"}, "nowhere: is no folder"),
        ({"limit": -1}, "limit is -1"),
    ],
)
def test_a_wrong_call_is_one_line_that_points_at_the_place(query, line):
    options = query if isinstance(query, dict) else {"query": query}
    with pytest.raises(InputError) as caught:
        tsas.runs(**options)
    assert caught.value.line().startswith(line)
    assert "\n" not in caught.value.line()


def test_an_index_that_is_damaged_is_made_again(rigs, cache):
    want = tsas.runs().summary
    (index,) = (cache / "runs").glob("*.parquet")
    (beside,) = (cache / "runs").glob("*.sha256")
    whole = index.read_bytes()
    flipped = [
        whole[:at] + bytes([whole[at] ^ 16]) + whole[at + 1 :] for at in range(7, len(whole), 997)
    ]
    for damaged in [b"", b"damaged", whole[:-1], *flipped]:
        index.write_bytes(damaged)
        assert tsas.runs().summary == want
        assert index.read_bytes() == whole
    for damaged in (b"", b"\xff"):
        beside.write_bytes(damaged)
        assert tsas.runs().summary == want
    again = Counted()
    tsas.runs(step=again)
    assert again.done == 0


def test_an_odd_manifest_is_reported_and_the_rest_is_answered(rigs):
    manifest = rigs / "two" / "dataset.toml"
    whole = manifest.read_text()
    digits = "holds a value that cannot be represented (an integer has thousands of digits)"
    for line, why in (
        (
            "started = 0001-01-01T00:00:00+12:00",
            "run.r0.started: is no date such as 2026-03-02 or ",
        ),
        (f"operator = 0x{'f' * 6000}", digits),
    ):
        manifest.write_text(whole.replace("id = ", f"{line}\nid = ", 1))
        result = tsas.runs()
        assert [row["folder"] for row in result.summary["runs"]] == ["one/a", "one/a"]
        (problem,) = result.summary["problems"]
        assert problem.startswith(f"two/dataset.toml: {why}")


@pytest.mark.parametrize("year", [1600, 2400])
def test_a_file_of_another_century_is_answered(rigs, year):
    at = int((datetime(year, 1, 1, tzinfo=UTC) - datetime(1970, 1, 1, tzinfo=UTC)).total_seconds())
    os.utime(rigs / "two" / "dataset.toml", (at, at))
    assert len(found()) == 3


def test_a_folder_whose_name_is_no_text_is_reported_and_the_rest_is_answered(rigs):
    latin = Path(os.fsdecode(b"caf\xe9"))
    shutil.copytree(rigs / "two", latin / "two")
    result = tsas.runs(folders=[latin, "one"])
    assert len(result.summary["runs"]) == 2
    assert "its name is not UTF-8; rename it" in result.summary["problems"][0]


def test_an_index_that_cannot_be_kept_is_held_in_memory(rigs, monkeypatch):
    (rigs / "file").write_text("")
    monkeypatch.setenv("TSAS_CACHE_DIR", str(rigs / "file"))
    result = tsas.runs("total_bend_rad > 3")
    assert len(result.summary["runs"]) == 2
    assert result.summary["problems"][0].endswith("to a folder that you may write to")
    assert "--out" not in result.summary["problems"][0]


def test_a_folder_without_datasets_has_no_runs(tmp_path):
    (tmp_path / "empty").mkdir()
    result = tsas.runs(folders=tmp_path / "empty")
    assert result.summary["runs"] == []
    assert result.tables()[0][0] == "0 of 0 runs"


def test_a_query_without_an_end_is_ended(monkeypatch):
    monkeypatch.setattr(query, "LONGEST_S", 0.3)
    counted = (
        "with recursive t(i) as (select 1 union all select i + 1 from t) select count(*) from t"
    )
    with pytest.raises(InputError, match=r"the query takes longer than 0\.3 s"):
        tsas.runs(f"({counted}) > 0")
