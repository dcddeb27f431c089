import pytest

from tsas_studies.challenge.rates import Rate, rate


@pytest.mark.parametrize(
    ("hits", "cases", "low", "high"),
    [
        (81, 263, 0.2553, 0.3662),
        (15, 148, 0.0624, 0.1605),
        (0, 20, 0.0000, 0.1611),
        (1, 29, 0.0061, 0.1718),
    ],
)
def test_the_interval_is_the_published_one(hits, cases, low, high):
    """Newcombe, Statistics in Medicine 17 (1998) 857, Table I, method 3."""
    assert Rate(hits, cases).interval() == pytest.approx((low, high), abs=5.1e-5)


def test_hits_and_misses_mirror_each_other():
    low, high = Rate(3, 10).interval()
    assert Rate(7, 10).interval() == pytest.approx((1 - high, 1 - low))


def test_without_a_case_there_is_no_share():
    assert (Rate(0, 0).share, Rate(0, 0).interval()) == (None, None)


def test_it_counts_what_is_true():
    assert rate([True, False, False]) == Rate(1, 3)
