"""The vocabulary of docs/words.md holds in code and text."""

import ast
import io
import re
import tokenize
from collections import Counter

import pytest

from docs.house import ROOT

NAMES = re.compile(r"(^|_)(un)?told(_|$)|sureness|likeness|obtainable", re.IGNORECASE)
PREDICTION = re.compile(r"(^|_)answers?(_|$)", re.IGNORECASE)  # but in a challenge

PHRASES = re.compile(
    r"\b(un)?told\b|sureness|likeness|obtainable|noise explains|turn(s|ed|ing) (back|round)"
    r"|\bleaning\b|bristle travel|no (rig|clock) has|there twice|what comes out",
    re.IGNORECASE,
)
PACKAGES = ("tsas_cli", "tsas_studies")
SOURCES = sorted(p for package in PACKAGES for p in (ROOT / package).rglob("*.py"))
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
EXEMPT = {"words.md"}  # which lists them


def offences(path):
    """Yield the lines of a source whose names or texts use another word."""
    source = path.read_text(encoding="utf-8")
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.NAME:
            found = NAMES.search(token.string)
            found = found or ("challenge" not in path.parts and PREDICTION.search(token.string))
        elif token.type in {tokenize.STRING, tokenize.COMMENT}:
            found = PHRASES.search(token.string)
        else:
            continue
        if found:
            yield f"{path.relative_to(ROOT)}:{token.start[0]}: {found[0]}"


@pytest.mark.parametrize("folder", PACKAGES)
def test_code_uses_the_words_of_the_field(folder):
    assert not [one for p in SOURCES if p.is_relative_to(ROOT / folder) for one in offences(p)]


@pytest.mark.parametrize("folder", PACKAGES)
def test_a_class_has_its_name_alone(folder):
    trees = (ast.parse(p.read_text(encoding="utf-8")) for p in (ROOT / folder).rglob("*.py"))
    names = Counter(n.name for tree in trees for n in tree.body if isinstance(n, ast.ClassDef))
    assert not [name for name, count in names.items() if count > 1]


@pytest.mark.parametrize("page", [p for p in PAGES if p.name not in EXEMPT], ids=lambda p: p.name)
def test_pages_use_the_words_of_the_field(page):
    lines = enumerate(page.read_text(encoding="utf-8").splitlines(), 1)
    assert not [f"{n}: {found[0]}" for n, line in lines if (found := PHRASES.search(line))]


def test_what_a_source_says_is_seen(tmp_path):
    source = ROOT / "tests" / "docs" / "test_words.py"
    assert any("told" in one for one in offences(source))
