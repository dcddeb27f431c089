import re
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.drawing import picture, shortened


def draw(figure):
    axes = figure.add_subplot()
    axes.plot(np.arange(5.0), color=STAND_IN["contraction"], label="$a$ <b> 😀")
    axes.axhspan(1, 2, color=STAND_IN["measured"], alpha=0.5)
    figure.legend(loc="outside upper left")


@pytest.fixture(scope="module")
def svg():
    return str(picture(draw, key="one", alt="A line that <rises>\x1b", caption="").svg)


def test_the_picture_is_well_formed_and_says_what_it_shows(svg):
    root = ET.fromstring(svg)  # noqa: S314  our own output
    assert root.attrib["aria-label"] == "A line that <rises>\\x1b"
    assert "$a$ <b> 😀" in "".join(root.itertext())


def test_ids_are_those_of_the_picture_and_every_reference_has_its_target(svg):
    ids = re.findall(r'\bid="([^"]+)"', svg)
    assert len(ids) == len(set(ids))
    assert all(one.startswith("one-") for one in ids)
    references = re.findall(r'url\(#([^)]+)\)|href="#([^"]+)"', svg)
    assert references
    assert {a or b for a, b in references} <= set(ids)


def test_every_colour_is_a_variable_of_the_page_and_nothing_holds_for_all_of_it(svg):
    assert "var(--contraction)" in svg
    assert "var(--measured)" in svg
    assert not re.search(r"#[0-9a-fA-F]{6}\b", svg)
    assert set(re.findall(r"var\(--([\w-]+)\)", svg)) <= set(STAND_IN)
    assert "<style" not in svg
    assert "http" not in svg  # nor is a network asked


def test_long_names_leave_room_for_the_plot_and_keep_their_ends():
    def long(figure):
        axes = figure.add_subplot()
        axes.plot([0.0, 1.0], [0.0, 1.0], label="l" + 99 * "o" + "ng")
        axes.set(title="t" + 99 * "o" + "ng", ylabel="y" + 99 * "o" + "ng [mm]")
        axes.set_yticks([0.0, 1.0], ["short", "n" + 99 * "o" + "ne"])
        figure.legend(loc="outside upper left")

    root = ET.fromstring(str(picture(long, key="one", alt="", caption="").svg))  # noqa: S314
    shown = ["".join(text.itertext()) for text in root.iter("text")]
    assert "short" in shown
    cut = [text for text in shown if "…" in text]
    assert sorted(text[0] for text in cut) == ["l", "n", "t", "y"]
    assert max(map(len, cut)) == 48
    assert "looooo" in next(text for text in cut if text[0] == "l")
    assert next(text for text in cut if text[0] == "y").endswith("ng [mm]")
    assert len(next(text for text in cut if text[0] == "n")) == 22


@pytest.mark.parametrize(("most", "said"), [(6, "abcdef"), (5, "ab…ef"), (4, "ab…f")])
def test_what_is_too_long_loses_its_middle(most, said):
    assert shortened("abcdef", most) == said
