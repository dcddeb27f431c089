"""Names from files that look like markup, code or commands are shown as text, everywhere."""

import json
import re
import shlex
from html import unescape
from html.parser import HTMLParser

import pyarrow as pa
import pytest

from tests.reporting.made_folders import (
    CASES,
    make_calibration,
    make_check,
    make_closing,
    make_dataset,
    make_diagnosis,
    make_simulation,
    make_tracking,
)
from tests.reporting.pages import chromium
from tests.reporting.test_page import without_script
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.writing import write_dataset
from tsas_cli.reporting.content import Fact, Glance, Picture, Section, Table, anchor, rendered
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.inputs import read_inputs
from tsas_cli.reporting.page import page

RUN = "\"><img src=x onerror=hit()> '`$(touch x)`;&amp; $x$"  # a run's id cannot hold a slash
EVIL = (
    f"</title></style></script></svg><script>hit()</script>{RUN}\x07\u202e\nnext\ud800{{{{7*7}}}}"
)
SHOWN = "</title></style></script></svg><script>hit()</script>"
TAGS = """
a body br caption clippath code dd defs details div dl dt figcaption figure footer g h1 h2 h3 h4
head header html li link main meta nav ol p path pre rect section span strong style summary svg
table tbody td text th thead title tr tspan ul use
"""


class Strict(HTMLParser):
    """Collects tags, attributes and text; knows nothing of our own markup."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.attributes, self.text = set(), [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        self.attributes += attrs

    def handle_data(self, data):
        self.text.append(data)


def harmless(text):
    """Assert that a page holds nothing but what our templates write; return its text."""
    text = without_script(text)
    seen = Strict(text)
    assert seen.tags <= set(TAGS.split())
    assert not [name for name, _ in seen.attributes if name.startswith("on")]
    addresses = [value for name, value in seen.attributes if name in {"href", "src", "xlink:href"}]
    ids = [value for name, value in seen.attributes if name == "id"]
    assert {a for a in addresses if not a.startswith("#")} <= {"data:,"}
    assert {a[1:] for a in addresses if a.startswith("#")} <= set(ids)
    assert len(ids) == len(set(ids))
    assert all(re.fullmatch(r"[\w.-]+", name) for name in ids)
    styles = [value for name, value in seen.attributes if name == "style"]
    assert not [style for style in styles if re.search(r"url\((?!#)|hit", style)]
    text.encode("utf-8")
    return "".join(seen.text)


def spoiled(value, keys):
    """Return JSON content with every text under one of the keys replaced."""
    if isinstance(value, dict):
        return {
            k: EVIL if k in keys and isinstance(v, str) else spoiled(v, keys)
            for k, v in value.items()
        }
    if isinstance(value, list):
        return [spoiled(one, keys) for one in value]
    return value


def spoil(path, keys, more=None):
    content = spoiled(json.loads(path.read_text()), keys)
    if more:
        more(content)
    path.write_text(json.dumps(content))
    return path.parent


@pytest.fixture(scope="module")
def hostile(tmp_path_factory):
    """A page whose dataset, runs, columns, units, files and sentences are all hostile."""
    root = tmp_path_factory.mktemp("hostile") / "$(touch x) '<i>"
    dataset = make_dataset(root / "data <b> & 'x'", (RUN, "plain"), samples=400)
    read = read_dataset(dataset)
    (root / "again").mkdir()
    text = EVIL.replace("\ud800", "")  # which TOML cannot hold
    manifest = read.manifest.model_copy(
        update={"name": text, "description": text, "license": text, "source": text}
    )
    tables = {
        r.run.id: pa.table({**{k: r.columns[k] for k in r.columns}, text: r.time_s}) for r in read
    }
    write_dataset(root / "again", manifest, tables)
    dataset = root / "again"
    check = make_check(
        dataset,
        root / "check",
        [
            {
                "code": EVIL,
                "severity": "error",
                "run": EVIL,
                "column": EVIL,
                "sentence": EVIL,
                "remedy": EVIL,
            }
        ],
    )
    calibrate = make_calibration(dataset, root / "calibrate", [EVIL])
    spoil(calibrate / "calibration.json", {"unit", "note", "origin", "version", "name", "message"})
    content = json.loads((calibrate / "calibration.json").read_text())
    original = json.loads((check / "check.json").read_text())["dataset"]
    content["dataset"] = original
    (calibrate / "calibration.json").write_text(json.dumps(content))
    simulate = make_simulation(dataset, root / "simulate")

    def own(content):
        content["model"] = {"file": EVIL, "sha256": "ab" * 32}
        content["dataset"] = original
        content["notes"] = [EVIL]
        for run in content["runs"].values():
            run["solver"] = run["start"] = EVIL
            run["conditioning"] = {
                EVIL: {"method": EVIL, "window_s": 1, "noise": 1, "unit": EVIL, "reversals": 1}
            }

    spoil(simulate / "simulation.json", {"unit", "version"}, own)
    diagnose = make_diagnosis(dataset, root / "diagnose", "named")

    def caused(content):
        content["dataset"] = original
        content["verdict"] = "named"
        (cause,) = content["named"]
        cause |= {"effect": EVIL, "title": EVIL, "equation": EVIL, "rivals": [EVIL, EVIL + "2"]}
        cause["parameters"] = {EVIL: next(iter(cause["parameters"].values()))}
        content["channels"] = {EVIL: next(iter(content["channels"].values()))}
        maps = content["residual_map"]
        for when in ("before", "after"):
            signals = {EVIL: maps[when]["f_in_N"]["phase"], **maps[when]["f_in_N"]}
            maps[when] = {EVIL: signals}
        content["signatures"]["effects"][0] = EVIL

    spoil(
        diagnose / "diagnosis.json",
        {"unit", "reason", "next_experiment", "sentence", "label", "version"},
        caused,
    )
    return page(read_inputs([dataset, check, calibrate, simulate, diagnose]))


def test_no_element_attribute_or_address_comes_of_a_name(hostile):
    text = harmless(hostile)
    assert text.count(SHOWN) > 30
    assert "49" not in re.findall(r"\{\{.*?\}\}", text)
    assert "\x07" not in hostile
    assert "\u202e" not in hostile
    assert "\\x07\\u202e" in text


def test_pictures_say_and_show_the_names_as_text(hostile):
    labels = [unescape(one) for one in re.findall('role="img" aria-label="([^"]*)"', hostile)]
    assert any(RUN in label.replace("`", "") or RUN.replace("`", "") in label for label in labels)
    svg = "".join(re.findall("<svg.*?</svg>", hostile, re.DOTALL))
    assert "&lt;script&gt;hit()" in svg
    assert "<script" not in svg


def test_the_title_is_one_line_of_text(hostile):
    (title,) = re.findall("<title>(.*?)</title>", hostile, re.DOTALL)
    assert SHOWN in unescape(title)
    assert "\n" not in title


def test_commands_are_quoted_for_the_shell(hostile):
    commands = unescape(re.search("<pre[^>]*><code>(.*?)</code>", hostile, re.DOTALL)[1])
    for line in commands.strip().splitlines():
        words = shlex.split(line)
        assert words[0] == "tsas"
        assert not {"touch", "x)", "&"} & set(words)


def test_a_page_of_tracking_and_of_closing_is_harmless_too(tmp_path):
    changed = {"file", "origin", "quantity", "shape", "version"}
    tracked = make_tracking(tmp_path / "tracked")

    def own(content):
        content["notes"] = [EVIL]
        for result in content["results"]:
            result["controller"] += EVIL
            result["condition"] += EVIL
        content["conditions"] = {k + EVIL: v for k, v in content["conditions"].items()}

    spoil(tracked / "tracking.json", changed, own)
    text = page(read_inputs([tracked]))
    assert SHOWN in harmless(text)
    title, hidden, _, rows = CASES["bend"]
    cases = {EVIL: (EVIL + title, {EVIL: 1.0} | hidden, [{"effect": EVIL, "rivals": [EVIL]}], {
        name + EVIL: rmse for name, rmse in rows.items()
    })}  # fmt: skip
    loop = make_closing(tmp_path / "loop", cases, version=EVIL)
    assert SHOWN in harmless(page(read_inputs([loop])))


def test_every_field_of_a_section_is_escaped():
    def draw(figure):
        figure.add_subplot().set_title(EVIL.replace("\ud800", ""))

    table = Table(EVIL, (EVIL, EVIL), ((EVIL, EVIL),), notes=(EVIL,))
    drawn: Picture = picture(draw, key=EVIL, alt=EVIL, caption=EVIL)
    section = Section(
        anchor(EVIL), EVIL, (EVIL,), (EVIL,), (EVIL,), (EVIL,), (table,), (drawn,), closing=(EVIL,)
    )
    glance = Glance(EVIL, EVIL, EVIL, (Fact(EVIL, EVIL, EVIL, EVIL),))
    text = rendered(name=EVIL, about=EVIL, summary=EVIL, sections=[section], glance=glance)
    text = harmless(text)
    assert text.count(SHOWN) == 25  # and once more in the plot, where long names are cut
    assert text.count(SHOWN[:20]) == 26


def test_no_script_runs_in_a_browser_even_without_the_policy(hostile, tmp_path):
    path = tmp_path / "page.html"
    path.write_text(hostile, encoding="utf-8")
    with chromium() as browser:
        context = browser.new_context(bypass_csp=True)
        tab = context.new_page()
        asked = []
        tab.on("request", lambda request: asked.append(request.url))
        tab.add_init_script("window.hits = 0; window.hit = () => { window.hits += 1; }")
        tab.goto(path.as_uri())
        assert tab.evaluate("window.hits") == 0
        tab.evaluate("document.querySelectorAll('details').forEach(it => it.open = true)")
        assert tab.evaluate("document.querySelectorAll('script, img, i, b').length") == 1
        assert tab.evaluate("window.hits") == 0
        assert asked == [path.as_uri()]
        context.close()
