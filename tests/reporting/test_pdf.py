import os
import re

import pytest

from tests.processes import alive
from tests.refusals import refusal
from tests.reporting.made_folders import page_from
from tests.reporting.pages import pipeline
from tsas_cli.reporting import pdf
from tsas_cli.support.errors import InputError


@pytest.fixture
def only(tmp_path, monkeypatch):
    """Return a function that makes a program the only browser of this machine."""
    folder = tmp_path / "bin"
    folder.mkdir()

    def make(name, script):
        program = folder / name
        program.write_text(f"#!/bin/sh\n{script}\n")
        program.chmod(0o755)
        return program

    monkeypatch.setenv("PATH", str(folder))
    return make


def test_the_first_browser_that_is_there_prints(only, tmp_path):
    only("microsoft-edge", "exit 1")
    chosen = only("chromium-browser", 'for o; do case $o in --print-to-pdf=*) printf %s "%PDF-1.4 $*" > "${o#*=}";; esac; done')  # fmt: skip  # noqa: E501
    pdf.print_page("<p>x", tmp_path / "page.pdf")
    call = (tmp_path / "page.pdf").read_text()
    assert pdf.browser() == str(chosen)
    assert "--no-pdf-header-footer" in call
    assert re.search(r"file:///\S+/page\.html$", call)
    assert ("--no-sandbox" in call) is (os.geteuid() == 0)


def unprinted(folder):
    """Return why a page is not printed, and nothing is written."""
    line = refusal(pdf.print_page, "<p>x", folder / "page.pdf")
    assert not (folder / "page.pdf").exists()
    return line


@pytest.mark.usefixtures("only")
def test_without_a_browser_it_is_said_which_would_do(tmp_path):
    assert re.search("chromium.*google-chrome.*apt install chromium", unprinted(tmp_path))


def test_a_browser_that_fails_is_quoted(only, tmp_path):
    only("chromium", "echo first >&2; echo no display >&2; exit 1")
    assert "chromium: made no PDF (no display)" in unprinted(tmp_path)


def test_a_browser_that_hangs_is_ended_with_all_that_it_started(only, tmp_path, monkeypatch):
    monkeypatch.setattr(pdf, "_LONGEST_S", 2.0)
    only("chromium", f"/bin/sleep 60 & echo $! > {tmp_path}/child; wait")
    assert "not done after 2 s" in unprinted(tmp_path)
    assert alive({int((tmp_path / "child").read_text())}) == set()


@pytest.fixture(scope="module")
def printed(tmp_path_factory):
    """Return the bytes of a page that the machine's own browser has printed."""
    try:
        pdf.browser()
    except InputError as error:
        pytest.skip(f"nothing to print with: {error}")
    root = tmp_path_factory.mktemp("pdf")
    pdf.print_page(page_from(*pipeline(root, samples=400)), root / "page.pdf")
    return (root / "page.pdf").read_bytes()


def test_it_is_on_a4_with_a_title_an_outline_and_structure(printed):
    sizes = re.findall(rb"/MediaBox\s*\[0 0 ([\d.]+) ([\d.]+)\]", printed)
    assert len(sizes) > 3
    assert {(round(float(w)), round(float(h))) for w, h in sizes} == {(595, 842)}
    assert b"/Outlines" in printed
    assert b"/StructTreeRoot" in printed
    assert b"/Title (bench: recordings" in printed
    assert b"/Dest" in printed  # links lead within the document …
    assert b"/URI" not in printed  # … and nowhere else


def test_the_same_page_is_printed_as_the_same_bytes(printed, tmp_path, monkeypatch):
    monkeypatch.setenv("TZ", "Asia/Kolkata")
    pages = []
    for name in ("first", "second"):
        late = "<script>document.body.append('late', performance.now())</script>"
        pdf.print_page(f"<title>x</title><h1>x</h1>{late}", tmp_path / name)
        pages.append((tmp_path / name).read_bytes())
    assert pages[0] == pages[1]
    for made in (printed, pages[0]):
        assert b"Date (" not in made
        assert pdf.PDF_MARK in made[:4096]


def test_dates_go_and_all_else_stays_in_its_place():
    about = b"%PDF-1.4\n1 0 obj\n<</Title (a \\(b\\))\n/CreationDate (D:20260101120000+00'00')\n"
    other = b">>\nendobj\n2 0 obj\n(/ModDate (D:2))\nendobj\n%%EOF"
    kept = pdf._without_dates(about + b"/ModDate (D:20260101120000Z)" + other)
    assert len(kept) == len(about) + 28 + len(other)
    assert kept.startswith(b"%PDF-1.4\n1 0 obj\n<</Title (a \\(b\\))\n" + pdf.PDF_MARK + b"   ")
    assert kept.endswith(other)
    assert kept.count(b"Date (") == 1
