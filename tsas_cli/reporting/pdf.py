"""A page as PDF, printed by the Chromium that this machine has."""

import os
import re
import shutil
import signal
import subprocess
import tempfile
from pathlib import Path

from tsas_cli.support.errors import InputError

BROWSERS = (
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
    "microsoft-edge",
)
_LONGEST_S = 120.0
PDF_MARK = b"/Maker (tsas)"  # in the first object, which describes the document
_SCRIPT = re.compile("<script>.*?</script>", re.DOTALL)  # what it adds, and when, is in the bytes
_DATE = re.compile(rb"/(?:Creation|Mod)Date \(D:[^()]*\)")
_OPTIONS = (
    "--headless",
    "--disable-gpu",
    "--no-first-run",
    "--disable-extensions",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--host-resolver-rules=MAP * ~NOTFOUND",
    "--no-pdf-header-footer",
    "--generate-pdf-document-outline",
)


def browser() -> str:
    """Return the path of the first of `BROWSERS` that is there.

    InputError: none is.
    """
    for name in BROWSERS:
        if path := shutil.which(name):
            return path
    raise InputError(
        "no Chromium to print with",
        expected=f"one of {', '.join(BROWSERS)} on the PATH",
        remedy="install one (Debian: apt install chromium), or print the page from your browser",
    )


def print_page(html: str, pdf: Path) -> None:
    """Print a page into a file, on A4, with its headings as the outline.

    InputError: no browser is there, or it fails.
    """
    program = browser()
    with tempfile.TemporaryDirectory(prefix="tsas-pdf-", ignore_cleanup_errors=True) as name:
        folder = Path(name)
        page, made = folder / "page.html", folder / "page.pdf"
        page.write_text(_SCRIPT.sub("", html), encoding="utf-8")
        call = [program, *_OPTIONS, f"--user-data-dir={folder / 'profile'}"]
        if os.geteuid() == 0:
            call.append("--no-sandbox")  # as root Chromium starts in no other way
        output = _run([*call, f"--print-to-pdf={made}", page.as_uri()])
        if not made.is_file() or not made.read_bytes().startswith(b"%PDF"):
            last = output.strip().splitlines()[-1:] or ["it said nothing"]
            raise InputError(
                f"made no PDF ({last[0]})",
                where=program,
                remedy="print the page from your browser",
            )
        pdf.write_bytes(_without_dates(made.read_bytes()))


def _without_dates(pdf: bytes) -> bytes:
    """Return a PDF that does not say when it was printed: the same page makes the same bytes.

    The dates of its first object, which describes the document, become `PDF_MARK`, filled up with
    spaces, so that all else stays in its place.
    """
    about, end, rest = pdf.partition(b"endobj")
    marked = _DATE.sub(lambda date: PDF_MARK.ljust(len(date[0])), about, count=1)
    return _DATE.sub(lambda date: b" " * len(date[0]), marked) + end + rest


def _run(call: list[str]) -> str:
    """Run the browser to its end, or end it with all its processes; return what it said."""
    with subprocess.Popen(  # noqa: S603  our own options, and files that we have named
        call,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
        start_new_session=True,
    ) as process:
        try:
            return process.communicate(timeout=_LONGEST_S)[1]
        except subprocess.TimeoutExpired:
            return f"not done after {_LONGEST_S:g} s"
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
