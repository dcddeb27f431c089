import pytest

from tsas_cli.reporting.content import anchor

ODD = ["a b", "a.20b", "a%20b", "a-b", "ä", '">', "a/b", ""]


def test_words_that_are_names_already_stay():
    assert anchor("diagnosis", "free_tendon") == "diagnosis-free_tendon"


@pytest.mark.parametrize("word", ODD)
def test_an_address_holds_no_letter_that_means_something_in_html_css_or_urls(word):
    assert not set(anchor("x", word)) & set(" %\"'<>&#()/?;:")


def test_other_names_have_other_addresses():
    assert len({anchor("x", word) for word in ODD}) == len(ODD)
