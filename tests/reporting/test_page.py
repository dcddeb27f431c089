import base64
import hashlib
import re
import shutil
from html import unescape
from html.parser import HTMLParser
from importlib.resources import files
from itertools import pairwise
from pathlib import Path

import pytest

from tests.reporting import made_folders as by_hand
from tsas_cli.reporting.inputs import read_inputs
from tsas_cli.reporting.page import SECTIONS
from tsas_cli.support.errors import InputError

VOID = {"meta", "link", "br", "hr", "img", "input"}
FINDING = {"code": "time-jitter", "severity": "warning", "run": "a", "column": "time_s"}
FINDING["sentence"] = "Steps <vary>\x07 by 12 %."


class Outline(HTMLParser):
    """Checks tags, order of headings, ids, addresses and what pictures say; collects them."""

    def __init__(self, text):
        super().__init__()
        self.open, self.headings, self.ids, self.addresses, self.pictures = [], [], [], [], []
        self.tags, self.attributes, self.text = set(), [], []
        self.feed(text)
        assert self.open == []
        assert self.headings[0] == 1 not in self.headings[1:]
        assert max(b - a for a, b in pairwise(self.headings)) == 1
        assert len(self.ids) == len(set(self.ids))
        assert {a[1:] for a in self.addresses if a.startswith("#")} <= set(self.ids)
        self.labels = [svg["aria-label"] for svg in self.pictures]
        assert all(len(label) > 40 for label in self.labels)
        assert len(set(self.labels)) == len(self.labels)

    def handle_starttag(self, tag, attrs):
        self.handle_startendtag(tag, attrs)
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.tags.add(tag)
        self.attributes += attrs
        attrs = dict(attrs)
        self.headings += [int(tag[1])] if re.fullmatch("h[1-6]", tag) else []
        self.ids += [attrs["id"]] if "id" in attrs else []
        if tag != "link":
            self.addresses += [attrs[name] for name in ("src", "href") if name in attrs]
        self.pictures += [attrs] if tag in {"svg", "img"} else []

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)


def headings(text, level):
    """Return the headings of a level in order; each is a link to itself, or opens a fold."""
    found = re.findall(rf'id="([^"]+)">\n<h{level}><a href="#([^"]+)">', text)
    assert all(own == address for own, address in found)
    titles = re.findall(rf'<h{level}>(?:<a href="#[^"]+">)?(.*?)(?:</a>)?</h{level}>', text)
    return [unescape(title) for title in titles]


def commands_of(text):
    """Return the commands that repeat a page, one a line."""
    return unescape(re.search("<pre[^>]*><code>(.*?)</code>", text, re.DOTALL)[1])


def rows(text):
    """Return the cells of each row of the tables in a text."""
    found = re.findall(r"<tr>(.*?)</tr>", text, re.DOTALL)
    return [[unescape(c) for c in re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row)] for row in found]


def cells(text, caption):
    """Return the rows of one table."""
    return rows(text[text.index(f"<caption>{caption}") :].partition("</table>")[0])


def script_of(text):
    (script,) = re.findall("<script>(.*?)</script>", text, re.DOTALL)
    return script


def without_script(text):
    """Return a page without its one script, which is our own and the one that it allows."""
    allowed = re.search("script-src 'sha256-(.*?)'", text)[1]
    script = script_of(text)
    source = (files("tsas_cli.reporting") / "templates" / "figures.js").read_text(encoding="utf-8")
    assert script == source
    assert base64.b64encode(hashlib.sha256(script.encode()).digest()).decode() == allowed
    return text.replace(f"<script>{script}</script>", "")


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    root = tmp_path_factory.mktemp("report")
    dataset = by_hand.make_dataset(root / "dataset", ("a", "<script>$x$"), name="bench & <b>")
    return {
        "dataset": dataset,
        "check": by_hand.make_check(dataset, root / "check", [FINDING]),
        "calibration": by_hand.make_calibration(dataset, root / "cal", ["The <sheath> is silent."]),
        "simulation": by_hand.make_simulation(dataset, root / "sim"),
    }


@pytest.fixture(scope="module")
def whole(folders):
    return by_hand.page_from(*folders.values())


def test_the_contents_lead_to_every_section(whole):
    contents = re.search("<nav.*?</nav>", whole, re.DOTALL)[0]
    anchors = re.findall('href="#([^"]+)"', contents)
    assert len(anchors) == len(SECTIONS) - 4  # nothing tracked or predicted, no drive identified
    assert anchors == re.findall('<section id="([^"]+)"', whole)


def test_every_plot_is_there_and_says_what_it_shows(whole):
    labels = Outline(whole).labels
    assert len(labels) == 4 + 2 * 2 + 2 * 2  # phases; two loops and two channels of two runs
    assert all(len(re.findall(r"\d", label)) > 5 for label in labels)


def test_nothing_is_asked_from_the_network(whole):
    assert all(address.startswith("#") for address in Outline(whole).addresses)
    icon = '<link rel="icon" href="data:,">'  # which is none, so that no browser asks for one
    assert re.findall("<link.*?>", whole) == [icon]
    assert not re.search(r"https?:|@import|url\((?!#)|<script", without_script(whole))
    assert not re.search(r"https?:|import|fetch|XMLHttp|eval|innerHTML", script_of(whole))


def test_the_numbers_of_the_stages_stand_on_the_page(whole):
    for text in ("2.338", "2.291 to 2.385", "0.1251", "0.1230 to 0.1272", "0.993", "data sheet"):
        assert f">{text}</td>" in whole


def test_each_phase_is_drawn_in_its_own_colour(whole):
    pictures = re.findall(r"<svg.*?</svg>", whole, re.DOTALL)
    (loop,) = (p for p in pictures if 'aria-label="Loop of run a: tension at the drive' in p)
    for colour in ("contraction", "loosening", "dead-band-up", "dead-band-down"):
        assert f"stroke: var(--{colour})" in loop


@pytest.mark.usefixtures("undrawn")
def test_a_dataset_alone_makes_a_page_that_says_what_is_missing(folders):
    alone = by_hand.page_from(folders["dataset"])
    Outline(alone)
    assert "No calibration was given" in alone
    assert "No simulation was given" in alone
    assert alone.count("<svg") == 4


@pytest.mark.usefixtures("undrawn")
def test_of_many_findings_of_one_kind_the_first_are_shown_and_the_others_named(folders, tmp_path):
    findings = [FINDING | {"run": f"r{n}", "sentence": f"`x` in r{n}"} for n in range(9)]
    alone = FINDING | {"severity": "error", "sentence": "broken"}
    check = by_hand.make_check(folders["dataset"], tmp_path / "check", [*findings, alone])
    text = by_hand.page_from(check)
    assert "<code>x</code> in r3<" in text
    assert "in r4<" not in text
    assert ">r4, r5, r6, r7, r8<" in text
    assert text.index(">broken<") < text.index("in r0<")
    assert "1 error, 9 warnings" in text


def test_every_section_is_on_the_page():
    root = Path(str(files("tsas_cli.reporting")))
    made = {path for path in root.rglob("*.py") if "\ndef section(inputs: " in path.read_text()}
    assert {Path(section.__code__.co_filename) for section in SECTIONS} == made


@pytest.mark.usefixtures("undrawn")
def test_a_note_says_for_which_rows_it_holds_and_missing_values_are_dashes(folders, tmp_path):
    calibrated = by_hand.make_calibration(folders["dataset"], tmp_path)
    missing = dict.fromkeys(("value", "interval_low", "interval_high"))
    with by_hand.edited(calibrated / "calibration.json") as content:
        content["stiffness"][0] |= {"note": "few samples", "expected_N_per_mm": None}
        content["stiffness"][0]["km"] |= missing
    text = by_hand.page_from(calibrated)
    Outline(text)
    assert "<li>few samples: a contraction</li>" in text
    assert ["a", "contraction", "–", "2.338", "2"] in [row[:2] + row[-3:] for row in rows(text)]
    with by_hand.edited(calibrated / "calibration.json") as content:
        for row in content["stiffness"]:
            row["expected_N_per_mm"] = None
            row["km"] |= missing
    text = by_hand.page_from(calibrated)
    Outline(text)
    assert ["run", "phase", "theory", "strokes"] in rows(text)


@pytest.mark.parametrize("same", [True, False])
@pytest.mark.usefixtures("undrawn")
def test_the_commands_name_the_calibrated_model_only_where_it_was_simulated(
    folders, tmp_path, same
):
    calibrated = shutil.copytree(folders["calibration"], tmp_path / "cal")
    (calibrated / "model.toml").write_text("mine" if same else "another")
    simulated = shutil.copytree(folders["simulation"], tmp_path / "sim")
    digest = hashlib.sha256(b"mine").hexdigest()
    with by_hand.edited(simulated / "simulation.json") as content:
        content["model"] = {"file": "model.toml", "sha256": digest}
    text = by_hand.page_from(folders["dataset"], calibrated, simulated)
    assert (f"--model {calibrated}/model.toml" in text) is same
    assert digest in text


def test_a_simulation_of_the_data_sheet_is_repeated_without_a_model(whole):
    assert "They lack" not in whole
    (command,) = re.findall(r"tsas simulate .*", whole.partition("<pre")[2])
    assert "--dynamics static" in command
    assert "--model" not in command


@pytest.mark.usefixtures("undrawn")
def test_conditions_that_were_told_are_those_of_the_page_and_no_command_repeats_them(
    folders, tmp_path
):
    told = shutil.copytree(folders["simulation"], tmp_path / "sim")
    with by_hand.edited(told / "simulation.json") as content:
        content["conditions"] = {"total_bend_rad": 1.5}
    given = [folders["dataset"], told]
    assert {run.total_bend_rad for run in read_inputs(given).dataset.runs} == {1.5}
    assert "They lack what was handed over" in by_hand.page_from(*given)
    with pytest.raises(InputError, match="was given other conditions of the runs than"):
        read_inputs([*given, folders["calibration"]])
