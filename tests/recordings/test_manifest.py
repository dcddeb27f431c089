import datetime as dt
import tomllib
from pathlib import Path

import pytest

from tests.commands.documented import DOCS, documented
from tests.refusals import refusal as refused
from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.recordings.manifest import (
    Manifest,
    RigSheet,
    Run,
    check_run_name,
    colliding_names,
    read_manifest,
    write_manifest,
)
from tsas_cli.recordings.validation import parse
from tsas_cli.support.errors import InputError

SHA = "0123456789abcdef" * 4
STARTED = "started = 2026-03-02T09:30:00"
TEXT = f"""
format = 1
name = "bench-42"
kind = "measured"
license = "CC-BY-4.0"

[rig]
tendon_diameter_mm = 1.2
load_stiffness_N_per_mm = 1.579

[[run]]
id = "a"
file = "runs/a.parquet"
sha256 = "{SHA}"
started = 2026-03-02T09:30:00
sheath_length_mm = 785.4
preload_N = 25.0

[[run]]
id = "b"
file = "runs/b.parquet"
sha256 = "{SHA}"
load = "force"
"""


def read(folder, text):
    (folder / "dataset.toml").write_text(text, encoding="utf-8")
    return read_manifest(folder)


def refusal(folder, text):
    return refused(read, folder, text).removeprefix(f"{folder / 'dataset.toml'}: ")


def test_a_manifest_says_what_was_written_by_hand(tmp_path):
    manifest = read(tmp_path, TEXT)
    stated = (manifest.name, manifest.kind, manifest.license)
    assert stated == ("bench-42", "measured", "CC-BY-4.0")
    assert manifest.rig.tendon_diameter_mm == 1.2
    assert manifest.rig.friction_coefficient is None
    a, b = manifest.run
    assert (a.id, a.file, a.sheath_length_mm, a.preload_N) == ("a", "runs/a.parquet", 785.4, 25.0)
    assert a.started == dt.datetime.fromisoformat("2026-03-02T09:30:00")
    assert (a.load, b.load) == ("spring", "force")


@pytest.mark.parametrize("day", ["2024-01-31", '"2024-01-31"', '"20240131"', '"20240131T00:00"'])
def test_a_day_is_a_date_with_dashes_and_without(tmp_path, day):
    manifest = read(tmp_path, TEXT.replace(STARTED, f"started = {day}"))
    assert manifest.run[0].started == dt.datetime.fromisoformat("2024-01-31")


def test_writing_and_reading_gives_the_same_manifest_and_words_of_ones_own_stay(tmp_path):
    lab = '\n[lab]\nroom = "3.14"\nheated = true\nnumbers = [true, 1]\n'
    manifest = read(tmp_path, TEXT + lab)
    own = {"room": "3.14", "heated": True, "numbers": [True, 1]}
    assert manifest.model_extra == {"lab": own}
    write_manifest(tmp_path, manifest)
    assert read_manifest(tmp_path) == manifest


def test_an_unknown_key_travels_along_and_names_its_nearest(tmp_path):
    manifest = read(tmp_path, TEXT.replace("preload_N", "preload_n"))
    assert manifest.run[0].unknown_keys() == {"preload_n": "did you mean preload_N?"}
    assert manifest.run[1].unknown_keys() == {}


def test_a_closed_table_names_the_nearest_key_and_its_place():
    class Inner(Manifest):
        model_config = Manifest.model_config | {"extra": "forbid"}

    run = {"id": "a", "file": "a.parquet", "sha256": SHA}
    content = {"format": 1, "name": "x", "kind": "measured", "licence": "MIT", "run": [run]}
    with pytest.raises(InputError, match=r"map\.toml: unknown key licence .*mean license\?"):
        parse(Inner, content, Path("map.toml"))


def test_all_errors_come_at_once_with_their_places(tmp_path):
    text = TEXT.replace('kind = "measured"', 'kind = "guessed"')
    text = text.replace("tendon_diameter_mm = 1.2", "tendon_diameter_mm = -1.2")
    text = text.replace('id = "b"\n', "").replace("preload_N = 25.0", 'preload_N = "tight"')
    line = refusal(tmp_path, text)
    for part in ("kind: ", "'guessed'", "rig.tendon_diameter_mm: ", "-1.2", "run.1.id is missing"):
        assert part in line
    assert "run.a.preload_N: " in line


def test_an_error_of_many_runs_is_said_once(tmp_path):
    line = refusal(tmp_path, TEXT.replace(SHA, "abc"))
    assert line.startswith("run.a.sha256: ")
    assert line.endswith("got 'abc' (and 1 more alike)")


@pytest.mark.parametrize(
    "file",
    ["../a.parquet", "runs/../../a.parquet", "/etc/passwd", "C:/a.parquet", "C:a.parquet",
     r"..\\a.parquet", r"\\\\server\\share\\a.parquet", r"C:\\a.parquet"],
)  # fmt: skip
def test_a_file_outside_the_folder_is_refused(tmp_path, file):
    line = refusal(tmp_path, TEXT.replace("runs/a.parquet", file))
    assert line.startswith("run.a.file: must stay inside the dataset's folder")


def test_a_path_written_on_windows_works(tmp_path):
    manifest = read(tmp_path, TEXT.replace("runs/a.parquet", r"runs\\a.parquet"))
    assert manifest.run[0].file == "runs/a.parquet"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("format = 1", "format = 2", "format: .*1.*got 2"),
        ("format = 1\n", "", "format is missing"),
        ('id = "b"', 'id = "a"', "duplicate run id 'a'"),
        (SHA, "abc", "run.a.sha256: "),
        (SHA, "g" * 64, "run.a.sha256: "),
        ('load = "force"', 'load = "weight"', "run.b.load: .*'spring', 'force' or 'displacement'"),
        ("preload_N = 25.0", "preload_N = nan", "run.a.preload_N: .*finite"),
        ("preload_N = 25.0", "preload_N = inf", "run.a.preload_N: .*finite"),
        ("1.579", "0", "rig.load_stiffness_N_per_mm: .*expected 1e-09 to 1e\\+09 N/mm, got 0"),
        ("[[run]]", "[[runs]]", "run is missing"),
        ("preload_N = 25.0", 'preload_N = "25"', "run.a.preload_N: text is no number, got '25'"),
        ("= 1.2\n", '= "1.2"\n', "rig.tendon_diameter_mm: text is no number, .* without quotes"),
        ('name = "bench-42"', 'name = ""', "name: .*at least 1 character"),
        ("[rig]\n", "[rig]\nantagonist_f_in_share = 7\n", "f_in_share: expected -0.5 to 1.5"),
        ("format = 1", "format = true", "format: true and false are no numbers"),
        ("preload_N = 25.0", "total_bend_rad = true", "run.a.total_bend_rad: true and false are"),
        ("1.579", "true", "rig.load_stiffness_N_per_mm: true and false are no numbers"),
        (STARTED, "started = 0001-01-01T00:00:00+14:00", "run.a.started: is no date"),
        (STARTED, 'started = "2200-01-01"', "run.a.started: is no date"),
        (STARTED, "started = 20240101", "run.a.started: is no date such as .* got 20240101"),
        *(
            (STARTED, f"started = {day}", "run.a.started: is no date")
            for day in ('"1704067200"', "1.5", "true", '"01.02.2024"')
        ),
        (STARTED, 'started = "20240230"', "run.a.started: .* day value"),
    ],
)
def test_what_format_1_does_not_allow_is_refused(tmp_path, old, new, message):
    with pytest.raises(InputError, match=message):
        read(tmp_path, TEXT.replace(old, new))


def test_a_folder_without_manifest_says_how_to_make_one(tmp_path):
    with pytest.raises(InputError, match=r"no dataset\.toml here.*tsas ingest"):
        read_manifest(tmp_path)


@pytest.mark.parametrize(
    "name",
    ["a", "bend180_0.5Hz", "2026-03-02T09:30:00", ".hidden", "--help", "a.", "力", "console",
     "a:b", "<b>", 'a"', "a|b", "a?", "a*"],  # marks that other systems do not allow
)  # fmt: skip
def test_names_that_name_a_file(name):
    check_run_name(name)


NONE = ["", ".", "..", "../x", "a/b", "a\\b", "a\0", "a\n", "\x1b[2J", "a\u202eb", " ", " a", "a ",
        "x" * 248, "力" * 83, "\ud800"]  # fmt: skip
DEVICES = ["con", "CON", "Nul", "com1", "LPT9.csv", "aux.a.b"]


@pytest.mark.parametrize(
    ("name", "message"),
    [
        *((name, "file name|surrogates") for name in NONE),
        *((name, "is a device on Windows") for name in DEVICES),
    ],
)
def test_names_that_name_none(name, message):
    with pytest.raises(ValueError, match=message):
        check_run_name(name)


def test_names_that_are_one_file_elsewhere():
    assert colliding_names(["a", "b", "c"]) is None
    assert colliding_names(["a", "b", "A"]) == ("a", "A")
    assert colliding_names(["\u00e9", "e\u0301"]) == ("\u00e9", "e\u0301")
    assert colliding_names(["stra\u00dfe", "STRASSE"]) == ("stra\u00dfe", "STRASSE")


def test_every_key_and_column_of_a_dataset_is_documented():
    keys = {key for table in (Manifest, RigSheet, Run) for key in table.model_fields}
    assert documented("dataset.toml") == keys | set(BY_NAME)


def test_the_documented_manifest_is_one():
    page = (DOCS / "formats.md").read_text(encoding="utf-8")
    manifest = Manifest.model_validate(tomllib.loads(page.split("```toml\n")[1].split("```")[0]))
    assert not manifest.unknown_keys()
    assert not manifest.rig.unknown_keys() | manifest.run[0].unknown_keys()
