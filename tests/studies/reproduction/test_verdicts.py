"""A verdict follows from the numbers and the tolerance, never from the words beside it."""

import pytest

from tsas_cli.paper import Printed
from tsas_studies.reproduction.verdicts import NOT_KNOWN, holds, to_the_digit, undetermined, within

KM = Printed(2.338, "N/mm", "Table 3")


@pytest.mark.parametrize(
    ("ours", "verdict"),
    [(2.3384, "agrees"), (2.3376, "agrees"), (2.3386, "differs"), (-2.338, "differs")],
)
def test_to_the_digit(ours, verdict):
    row = to_the_digit("km", KM, ours, because="of a spring")
    assert row.verdict == verdict
    assert (row.paper, row.unit, row.source) == (2.338, "N/mm", "Table 3")
    assert row.because == ("of a spring" if verdict == "differs" else "")


def test_within_takes_percent_of_the_papers_value():
    paper = Printed(100.0, "N", "text")
    assert within("f", paper, 105.0, percent=5.0).verdict == "agrees"
    assert within("f", paper, 105.1, percent=5.0).verdict == "differs"
    assert within("f", Printed(105.1, "N", "text"), 100.0, percent=5.0).verdict == "agrees"


def test_what_differs_says_why_or_that_nobody_knows():
    row = within("f", KM, 3.0, percent=1.0)
    assert row.words == f"differs (not within 1 %), because {NOT_KNOWN}"
    assert row.ratio == pytest.approx(3.0 / 2.338)


def test_a_statement_holds_or_not():
    row = holds("it fits", "Table 1", true=True, criterion="with room", because="it is thick")
    assert (row.verdict, row.words, row.ratio) == ("agrees", "agrees with room", None)
    row = holds("it fits", "Table 1", true=False, criterion="with room", because="it is thick")
    assert (row.verdict, row.words) == (
        "differs",
        "differs (not with room), because it is thick",
    )


def test_what_cannot_be_told_keeps_its_reason():
    row = undetermined("P", "Fig. 4", because="nothing is printed", unit="N", ours=57.4)
    assert row.verdict == "cannot tell"
    assert row.words == "cannot be determined, because nothing is printed"
    assert row.as_json()["ours"] == 57.4
