import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
INDEX = re.compile(r"pypi\.|pythonhosted|/simple\b|--(extra-)?index-url|--find-links")
BYTES = ("tests/fuzz/corpus/", "tests/fuzz/found/")  # of any kind


@pytest.fixture(scope="module")
def texts() -> dict[str, str]:
    """Return every text file that the repository keeps, by its path."""
    listed = subprocess.run(
        ["git", "ls-files"],  # noqa: S607 # whichever git is installed
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    if listed.returncode:
        pytest.skip("not a git repository")
    found = {}
    for name in listed.stdout.splitlines():
        content = (ROOT / name).read_bytes() if (ROOT / name).is_file() else b"\0"
        if b"\0" not in content and not name.startswith(BYTES):
            found[name] = content.decode("utf-8")
    return found


def test_no_file_names_a_package_index(texts: dict[str, str]) -> None:
    here = Path(__file__).relative_to(ROOT).as_posix()
    assert [n for n, text in texts.items() if n != here and INDEX.search(text)] == []
