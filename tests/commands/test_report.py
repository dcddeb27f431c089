import json
import re
import shutil

import pytest

import tsas_cli.stages.report as report_stage
from tests.reporting import made_folders as by_hand
from tests.reporting.test_page import commands_of
from tsas_cli.reporting.pdf import PDF_MARK
from tsas_cli.verifying.claims import claims_of


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    root = tmp_path_factory.mktemp("report")
    dataset = by_hand.make_dataset(root / "dataset", ("a",), samples=400)
    by_hand.make_check(dataset, root / "check")
    by_hand.make_calibration(dataset, root / "calibrated")
    by_hand.make_simulation(dataset, root / "simulated")
    return root


@pytest.fixture
def folder(made, tmp_path):
    return shutil.copytree(made, tmp_path / "made")


@pytest.fixture
def refused(refused_here, folder):
    """Call the command, which refuses in one line that holds some words."""

    def call(*arguments, says, out="r.html"):
        line = refused_here("report", *arguments, "--out", folder / out)
        assert [word for word in says if word not in line] == []

    return call


def test_one_folder_of_a_stage_is_enough_and_leads_to_the_dataset(folder, here):
    code, out, err = here("report", folder / "simulated", "--out", folder / "r.html")
    assert (code, err) == (0, "")
    assert str(folder / "dataset") in out
    assert (folder / "r.html").read_text().startswith("<!DOCTYPE html>")


def test_an_existing_page_stays_without_force(folder, here, refused):
    page, check = folder / "r.html", folder / "check"
    assert here("report", check, "--out", page)[0] == 0
    whole = page.read_text()
    refused(check, says=["r.html", "--force"])
    for edited, why in ((f"{whole}edited", "has changed since"), ("mine", "not an earlier output")):
        page.write_text(edited)
        refused(check, "--force", says=["r.html", why])
        assert page.read_text() == edited
    page.write_text(whole)
    assert here("report", check, "--out", page, "--force")[0] == 0
    assert page.read_text() == whole


def test_a_folder_of_another_kind_is_refused_and_nothing_is_written(folder, refused):
    (folder / "other").mkdir()
    kinds = ["dataset.toml", "calibration.json", "simulation.json", "check.json"]
    refused(folder / "other", says=["other", *kinds])
    assert [p.name for p in folder.iterdir() if "r.html" in p.name] == []
    refused(folder / "nowhere", says=["nowhere: does not exist", *kinds])


@pytest.mark.parametrize(
    ("shown", "file", "content", "says"),
    [
        ("calibrated", "dataset/dataset.toml", None, ["calibration.json", "toml", "has changed"]),
        ("simulated", "dataset/runs/0.parquet", None, ["0.parquet"]),
        ("simulated", "simulated/runs/a.parquet", b"PAR1", ["a.parquet"]),
        ("check", "check/check.json", b'{"format": 1,', ["check.json", "JSON"]),
    ],
)
def test_what_has_changed_is_refused(folder, refused, shown, file, content, says):
    path = folder / file
    path.write_bytes(path.read_bytes() + b"\n# changed\n" if content is None else content)
    refused(folder / shown, says=says)


def test_a_simulation_of_another_length_is_refused(folder, refused):
    other = by_hand.make_dataset(folder / "longer", ("a",), samples=500)
    simulated = by_hand.make_simulation(other, folder / "other")
    shutil.copy(simulated / "runs" / "a.parquet", folder / "simulated" / "runs")
    refused(folder / "simulated", says=["a.parquet", "500 rows", "400"])


def test_a_dataset_may_lie_elsewhere_where_it_is_named(folder, here, refused):
    moved = folder / "calibrated", (folder / "dataset").rename(folder / "elsewhere")
    refused(moved[0], says=["calibration.json", "dataset"])
    assert here("report", *moved, "--out", folder / "r.html")[0] == 0


def test_two_folders_of_one_kind_are_refused(folder, refused):
    shutil.copytree(folder / "calibrated", folder / "second")
    refused(folder / "calibrated", folder / "second", says=["second", "calibration.json"])
    refused(*[folder / "simulated"] * 2, says=["a second folder", "simulated"])


def test_several_simulations_stand_beside_each_other_by_their_names(folder, here, refused):
    shutil.copytree(folder / "simulated", folder / "rough")
    pair = [folder / "simulated", folder / "rough"]
    code, out, _ = here("report", *pair, "--out", folder / "r.html", "--json")
    assert code == 0
    read = json.loads(out)["read"]
    assert read["simulation.json, simulated"] == str(folder / "simulated")
    assert read["simulation.json, rough"] == str(folder / "rough")
    page = (folder / "r.html").read_text()
    assert re.search(r"RMS of the residual: simulated ([\d.]+), rough \1, noise level", page)
    commands = commands_of(page)
    assert commands.count("tsas simulate") == 2
    assert f"{folder / 'simulated'} {folder / 'rough'} --out report.html" in commands
    *_, last = claims_of(folder / "r.html")
    assert last.path == folder / "rough" / "simulation.json"
    (folder / "rough" / "simulation.json").write_text("{}")
    refused(*pair, out="s.html", says=["rough"])


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda content: content.pop("parameters"), "parameters is missing"),
        (lambda content: content.update(format=2), "format"),
        (lambda content: content["stiffness"][0].update(run=None), "stiffness.0.run"),
    ],
)
def test_a_stage_file_that_is_not_whole_is_refused(folder, refused, spoil, message):
    path = folder / "calibrated" / "calibration.json"
    with by_hand.edited(path) as content:
        spoil(content)
    refused(folder / "calibrated", says=[str(path), message])


@pytest.fixture
def printer(monkeypatch):
    """Print without a browser."""

    def printed(html, path):
        path.write_bytes(b"%PDF" + PDF_MARK + html[:9].encode())

    monkeypatch.setattr(report_stage, "browser", lambda: "chromium")
    monkeypatch.setattr(report_stage, "print_page", printed)


@pytest.mark.usefixtures("printer")
def test_the_pdf_stands_beside_the_page(folder, here):
    code, out, _ = here("report", folder / "check", "--out", folder / "r.html", "--pdf", "--json")
    assert code == 0
    assert json.loads(out)["pdf"] == str(folder / "r.pdf")
    assert (folder / "r.pdf").read_bytes() == b"%PDF" + PDF_MARK + b"<!DOCTYPE"
    assert (folder / "r.html").is_file()
    code, out, _ = here("report", folder / "check", "--out", folder / "t.html", "--pdf")
    assert "t.pdf, 0.00 MB" in out


@pytest.mark.usefixtures("printer")
def test_an_existing_pdf_stays_without_force_and_no_page_is_written(folder, here, refused):
    (folder / "r.pdf").write_text("mine")
    words = [folder / "check", "--pdf"]
    refused(*words, says=["r.pdf", "--force"])
    refused(*words, "--force", says=["r.pdf", "not an earlier output"])
    assert (folder / "r.pdf").read_text() == "mine"
    assert not (folder / "r.html").exists()
    (folder / "r.pdf").unlink()
    for more in ((), ("--force",)):
        assert here("report", *words, "--out", folder / "r.html", *more)[0] == 0
        assert (folder / "r.pdf").read_bytes().startswith(b"%PDF")


@pytest.mark.usefixtures("printer")
def test_the_page_may_not_have_the_name_of_the_pdf(folder, refused):
    refused(folder / "check", "--pdf", out="r.pdf", says=["r.pdf", ".html"])


def test_without_a_browser_neither_page_nor_pdf_is_written(folder, refused, monkeypatch):
    monkeypatch.setattr("shutil.which", lambda name: None)
    refused(folder / "check", "--pdf", says=["no Chromium", "apt install chromium"])
    assert [p.name for p in folder.iterdir() if "r." in p.name] == []
