"""The nine contradictions: each is there, and goes where the paper would say something else."""

import re
from functools import cache

import pytest

from tsas_cli.paper import yang2025
from tsas_studies.reproduction.contradictions import contradictions
from tsas_studies.reproduction.contradictions_of_model import speed_limit

PAPER = yang2025()


@cache
def rows():
    return contradictions(PAPER).rows


def numbered(of, number):
    return [row for row in of if row.what.startswith(f"{number}. ")]


@pytest.mark.parametrize("number", range(1, 10))
def test_each_of_the_nine_is_there_with_evidence(number):
    found = numbered(rows(), number)
    assert any(row.verdict == "differs" for row in found)
    for row in found:
        assert re.search(r"\d", row.evidence)
    assert {int(row.what.split(".")[0]) for row in rows()} == set(range(1, 10))


@pytest.mark.parametrize(
    ("number", "changes"),
    [
        (1, {"stiffness.theory.kr_contraction": 0.0553}),
        (2, {"rig.sheath_inner_diameter": 1.4}),
        (4, {"adaptation.phi1.lower": 1e-4, "adaptation.phi2.lower": 1.2}),
        (5, {"feedforward.lead": 1.284}),
        (
            6,
            {
                "tracking.disturbed.rmse_pid": 1.6,
                "tracking.disturbed.rmse_sliding_mode": 0.9,
                "tracking.disturbed.rmse_adaptive_sliding_mode": 0.7,
            },
        ),
        (7, {"stiffness.measured.km_c_e": 102.0}),
        (8, {"stiffness.theory.km_dead_band": 140.0}),
        (9, {"groups.b.angular_frequency": 1.5}),
    ],
)
def test_it_goes_where_the_paper_says_something_else(number, changes):
    paper = PAPER
    for name, value in changes.items():
        paper = paper.with_value(name, value)
    (differing,) = {row.verdict for row in numbered(rows(), number)[:1]}
    first = numbered(contradictions(paper).rows, number)
    if number == 9:
        assert {row.verdict for row in first} == {"agrees"}
    else:
        assert differing == "differs"
        assert first[0].verdict == "agrees"


def test_the_last_lump():
    (row,) = numbered(rows(), 3)
    k = 67858.4 * 50 / 785.0
    assert row.paper == pytest.approx(-2.0 * k, rel=1e-6)
    assert row.ours == pytest.approx(-(k + 1.579), rel=1e-6)
    clamped, right = k / 51.0, 1.0 / (785.0 / 67858.4 + 1.0 / 1.579)
    assert f"{clamped:.1f} N/mm" in row.evidence
    assert row.evidence.count(f"{right:.4f}") == 2


def test_the_bounds_exclude_the_first_two_only():
    assert [row.verdict for row in numbered(rows(), 4)] == ["differs", "differs", "agrees"]
    assert [row.ours for row in numbered(rows(), 4)] == pytest.approx(
        [1.43e-4, 1.284, 5.7e-3], rel=5e-3
    )


def test_the_missing_reaction_of_the_drive():
    without, with_it = numbered(rows(), 5)
    assert without.ours == pytest.approx(1.28, abs=5e-3)
    assert with_it.ours == pytest.approx(43.57, abs=5e-3)
    assert "42.2847" in with_it.evidence
    assert (without.verdict, with_it.verdict) == ("differs", "agrees")


def test_the_errors_of_table_5():
    assert [(round(row.paper, 2), round(row.ours, 2)) for row in numbered(rows(), 6)] == [
        (0.61, 1.37),
        (0.82, 1.14),
        (0.91, 1.54),
    ]


def test_the_free_length():
    bands, x_out = numbered(rows(), 7)
    assert "278 mm" in bands.evidence
    assert bands.ours == pytest.approx(101.96, abs=1e-6)
    assert bands.verdict == "differs"
    assert -0.4 < x_out.ours < -0.1


def test_the_bias_of_the_line():
    up, down = numbered(rows(), 8)
    assert up.ours == pytest.approx(147.1, rel=3e-3)
    assert down.ours == pytest.approx(133.6, rel=3e-3)
    assert "104.5" in up.evidence
    assert "70.6" in down.evidence


def test_the_limit_of_stable_sliding():
    """17.7 mm/s at 40 N was found with other tools, to within a few tenths."""
    assert speed_limit(PAPER, "b") == pytest.approx(17.7, abs=0.3)
    assert [row.verdict for row in numbered(rows(), 9)] == ["agrees", "differs"]
    critical = PAPER.with_value("rig.micro_damping", 0.004)
    assert speed_limit(critical, "b") is None
