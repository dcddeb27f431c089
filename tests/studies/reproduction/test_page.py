"""The page of the reproduction."""

import re
from html import unescape

import numpy as np
import pytest

from tests.reporting.test_page import Outline, headings
from tsas_cli.paper import yang2025
from tsas_studies.reproduction.group import Figure, Group, Line
from tsas_studies.reproduction.page import reproduction_page
from tsas_studies.reproduction.verdicts import holds, to_the_digit, undetermined

PAPER = yang2025()
X = np.linspace(0.0, 1.0, 50)
CURVE = Figure("one", "A curve.", ("x [mm]", "f [N]"), (Line("model", X, X**2, "simulated"),))
DOT = Line("P", X[:1], X[:1], "ink", mark="o")
GROUPS = [
    Group(
        "first",
        "First <part>",
        ("What it is.",),
        (
            to_the_digit("km", PAPER["stiffness.theory.km_dead_band"], 175.0, because="of a cause"),
            holds("fits", "Table 1", true=True, criterion="with room", unit="1", paper=1.0),
        ),
        (CURVE,),
        ("What follows.",),
    ),
    Group(
        "second",
        "Second",
        rows=(
            undetermined("P", "Fig. 4", because="none is printed", unit="rpm s^3/mm", ours=57.396),
        ),
        figures=(
            Figure("two", "Folded.", ("x [mm]", "f [N]"), (*CURVE.lines, DOT), part="Group a"),
        ),
    ),
]


@pytest.fixture(scope="module")
def whole():
    return reproduction_page(PAPER, GROUPS)


def test_it_is_well_formed_and_leads_to_every_group(whole):
    outline = Outline(whole)
    assert len(outline.ids) == len(set(outline.ids))
    assert headings(whole, 2) == ["What is compared", "First <part>", "Second"]
    assert len(outline.pictures) == 2
    assert all(picture["aria-label"] for picture in outline.pictures)


def test_it_needs_nothing_from_elsewhere_and_escapes_what_it_shows(whole):
    assert not re.search(r'(src|href)="(?!#|data:,")', whole)
    assert "First &lt;part&gt;" in whole


def test_the_same_rows_make_the_same_page(whole):
    assert reproduction_page(PAPER, GROUPS) == whole


def test_each_row_shows_both_values_verdict_reason_and_source(whole):
    text = unescape(re.sub(r"\s+", " ", re.sub("<[^>]+>", " ", whole)))
    assert "km 175.1 N/mm 175.0 N/mm 0.9994 differs Differs (not to the last digit" in text
    assert "± 0.05), because of a cause. [Table 3]" in text
    assert "fits 1 – – agrees Agrees with room. [Table 1]" in text
    assert (
        "57.40 rpm s³/mm cannot tell Cannot be determined, because none is printed. [Fig. 4]"
        in text
    )


def test_the_counts_stand_on_top(whole):
    assert "Of 3 numbers and statements of the paper 1 agree with ours, 1 differ" in whole
    assert PAPER.citation["doi"] in whole
