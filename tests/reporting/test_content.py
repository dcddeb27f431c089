from tsas_cli.reporting.content import anchor

ODD = ["a b", "a.20b", "a%20b", "a-b", "ä", '">', "a/b", ""]


def test_an_address_holds_no_letter_that_means_something_in_html_css_or_urls():
    assert anchor("diagnosis", "free_tendon") == "diagnosis-free_tendon"
    addresses = {anchor("x", word) for word in ODD}
    assert len(addresses) == len(ODD)
    assert not set("".join(addresses)) & set(" %\"'<>&#()/?;:")
