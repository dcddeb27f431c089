import json
import re
import shutil
from html import unescape

import pytest

from tests.reporting.made_folders import make_calibration, make_check, make_dataset, make_simulation
from tsas_cli.reporting.pdf import PDF_MARK
from tsas_cli.verifying.claims import sealed


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    root = tmp_path_factory.mktemp("report")
    dataset = make_dataset(root / "dataset", ("a",), samples=400)
    make_check(dataset, root / "check")
    make_calibration(dataset, root / "calibrated")
    make_simulation(dataset, root / "simulated")
    return root


@pytest.fixture
def folder(made, tmp_path):
    return shutil.copytree(made, tmp_path / "made")


def refused(result, *words):
    code, out, err = result
    assert code == 2
    assert out == ""
    assert err.count("\n") == 1
    for word in words:
        assert word in err


def test_one_folder_of_a_stage_is_enough_and_leads_to_the_dataset(folder, here):
    code, out, err = here("report", folder / "simulated", "--out", folder / "r.html")
    assert (code, err) == (0, "")
    assert str(folder / "dataset") in out
    assert (folder / "r.html").read_text().startswith("<!DOCTYPE html>")


def test_json_names_what_was_read_and_quiet_says_nothing(folder, here):
    code, out, _ = here("report", folder / "check", "--out", folder / "r.html", "--json")
    assert code == 0
    assert json.loads(out)["read"]["check.json"] == str(folder / "check")
    assert here("report", folder / "check", "--out", folder / "q.html", "-q") == (0, "", "")


def test_an_existing_page_stays_without_force(folder, here):
    page, call = folder / "r.html", ["report", folder / "check", "--out", folder / "r.html"]
    assert here(*call)[0] == 0
    page.write_text(page.read_text() + "earlier")
    refused(here(*call), "r.html", "--force")
    assert page.read_text().endswith("earlier")
    assert here(*call, "--force")[0] == 0
    assert not page.read_text().endswith("earlier")
    page.write_text("mine")
    refused(here(*call, "--force"), "r.html", "not an earlier output")
    assert page.read_text() == "mine"


def test_a_folder_of_another_kind_is_refused_and_nothing_is_written(folder, here):
    (folder / "other").mkdir()
    result = here("report", folder / "other", "--out", folder / "r.html")
    refused(result, "other", "dataset.toml", "calibration.json", "simulation.json", "check.json")
    assert sorted(p.name for p in folder.iterdir() if "r.html" in p.name) == []


def changed(path):
    with path.open("ab") as stream:
        stream.write(b"\n# changed\n")


@pytest.mark.parametrize(
    ("shown", "spoil", "words"),
    [
        (
            "calibrated",
            lambda made: changed(made / "dataset" / "dataset.toml"),
            ("calibration.json", "dataset.toml", "has changed"),
        ),
        ("simulated", lambda made: changed(made / "dataset/runs/0.parquet"), ("0.parquet",)),
        (
            "calibrated",
            lambda made: (made / "dataset").rename(made / "elsewhere"),
            ("calibration.json", "dataset"),
        ),
        (
            "simulated",
            lambda made: (made / "simulated/runs/a.parquet").write_bytes(b"PAR1"),
            ("a.parquet",),
        ),
        (
            "check",
            lambda made: (made / "check/check.json").write_text('{"format": 1,'),
            ("check.json", "JSON"),
        ),
    ],
)
def test_what_has_changed_or_is_gone_is_refused(folder, here, shown, spoil, words):
    spoil(folder)
    refused(here("report", folder / shown, "--out", folder / "r.html"), *words)


def test_a_dataset_may_lie_elsewhere(folder, here):
    moved = [folder / "calibrated", (folder / "dataset").rename(folder / "elsewhere")]
    assert here("report", *moved, "--out", folder / "r.html")[0] == 0


def test_two_folders_of_one_kind_are_refused(folder, here):
    shutil.copytree(folder / "calibrated", folder / "second")
    pair = [folder / "calibrated", folder / "second"]
    refused(here("report", *pair, "--out", folder / "r.html"), "second", "calibration.json")
    again = [folder / "simulated"] * 2
    refused(here("report", *again, "--out", folder / "r.html"), "a second folder", "simulated")


def test_several_simulations_stand_beside_each_other_by_their_names(folder, here):
    shutil.copytree(folder / "simulated", folder / "rough")
    pair = [folder / "simulated", folder / "rough"]
    code, out, _ = here("report", *pair, "--out", folder / "r.html", "--json")
    assert code == 0
    read = json.loads(out)["read"]
    assert read["simulation.json, simulated"] == str(folder / "simulated")
    assert read["simulation.json, rough"] == str(folder / "rough")
    page = (folder / "r.html").read_text()
    assert re.search(r"RMS of the residual: simulated ([\d.]+), rough \1, noise level", page)
    commands = unescape(re.search("<pre[^>]*><code>(.*?)</code>", page, re.DOTALL)[1])
    assert commands.count("tsas simulate") == 2
    assert f"{folder / 'simulated'} {folder / 'rough'} --out report.html" in commands
    assert sealed(folder / "r.html").read[-1]["folder"] == "rough"
    (folder / "rough" / "simulation.json").write_text("{}")
    refused(here("report", *pair, "--out", folder / "s.html"), "rough")


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda content: content.pop("parameters"), "parameters is missing"),
        (lambda content: content.update(format=2), "format"),
        (lambda content: content["stiffness"][0].update(run=None), "stiffness.0.run"),
    ],
)
def test_a_stage_file_that_is_not_whole_is_refused(folder, here, spoil, message):
    path = folder / "calibrated" / "calibration.json"
    content = json.loads(path.read_text())
    spoil(content)
    path.write_text(json.dumps(content))
    refused(here("report", folder / "calibrated", "--out", folder / "r.html"), str(path), message)


def test_a_simulated_run_of_another_length_is_refused(folder, here, tmp_path):
    longer = make_dataset(tmp_path / "longer", ("a",), samples=500)
    make_simulation(longer, tmp_path / "other")
    shutil.copy(tmp_path / "other" / "runs" / "a.parquet", folder / "simulated" / "runs")
    result = here("report", folder / "simulated", "--out", folder / "r.html")
    refused(result, "a.parquet", "500 rows", "400")


@pytest.fixture
def printer(monkeypatch):
    """Print without a browser."""

    def printed(html, path):
        path.write_bytes(b"%PDF" + PDF_MARK + html[:9].encode())

    import tsas_cli.stages.report as module

    monkeypatch.setattr(module, "browser", lambda: "chromium")
    monkeypatch.setattr(module, "print_page", printed)


def test_the_pdf_stands_beside_the_page(folder, here, printer):
    code, out, _ = here("report", folder / "check", "--out", folder / "r.html", "--pdf", "--json")
    assert code == 0
    assert json.loads(out)["pdf"] == str(folder / "r.pdf")
    assert (folder / "r.pdf").read_bytes() == b"%PDF" + PDF_MARK + b"<!DOCTYPE"
    assert (folder / "r.html").is_file()
    code, out, _ = here("report", folder / "check", "--out", folder / "t.html", "--pdf")
    assert "t.pdf, 0.00 MB" in out


def test_an_existing_pdf_stays_without_force_and_no_page_is_written(folder, here, printer):
    (folder / "r.pdf").write_text("mine")
    words = ["report", folder / "check", "--out", folder / "r.html", "--pdf"]
    refused(here(*words), "r.pdf", "--force")
    assert (folder / "r.pdf").read_text() == "mine"
    assert not (folder / "r.html").exists()
    refused(here(*words, "--force"), "r.pdf", "not an earlier output")
    assert not (folder / "r.html").exists()
    (folder / "r.pdf").unlink()
    for more in ((), ("--force",)):
        assert here(*words, *more)[0] == 0
        assert (folder / "r.pdf").read_bytes().startswith(b"%PDF")


def test_the_page_may_not_have_the_name_of_the_pdf(folder, here, printer):
    words = ["report", folder / "check", "--out", folder / "r.pdf", "--pdf"]
    refused(here(*words), "r.pdf", ".html")


def test_without_a_browser_neither_page_nor_pdf_is_written(folder, here, monkeypatch):
    monkeypatch.setattr("shutil.which", lambda name: None)
    words = ["report", folder / "check", "--out", folder / "r.html", "--pdf"]
    refused(here(*words), "no Chromium", "apt install chromium")
    assert [p.name for p in folder.iterdir() if "r." in p.name] == []
