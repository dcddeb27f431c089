import pytest

from tsas_cli.reporting.colours import STAND_IN, schemes

SCHEMES = schemes()
TEXT = {"ink", "muted", "link"}


def luminance(colour):
    """Relative luminance of WCAG 2.2."""
    channels = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(a, b):
    dark, light = sorted((luminance(a), luminance(b)))
    return (light + 0.05) / (dark + 0.05)


@pytest.mark.parametrize("scheme", SCHEMES, ids=["light", "dark"])
def test_text_and_curves_stand_out_from_the_paper_and_text_from_the_surface_of_code(scheme):
    assert set(STAND_IN) == set(scheme) > TEXT
    for role in set(scheme) - {"paper", "line", "surface", "shade"}:
        assert contrast(scheme[role], scheme["paper"]) >= (4.5 if role in TEXT else 3.0), role
    for role in ("ink", "link"):
        assert contrast(scheme[role], scheme["surface"]) >= 4.5, role
