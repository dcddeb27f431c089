"""Names from files that look like markup, code or commands are shown as text, everywhere."""

import json
import re
import shlex
from contextlib import contextmanager
from html import unescape

import pyarrow as pa
import pytest

from tests.reporting import made_diagnoses, made_loops
from tests.reporting import made_folders as by_hand
from tests.reporting.pages import chromium
from tests.reporting.test_page import Outline, commands_of, without_script
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.writing import write_dataset
from tsas_cli.reporting.content import Fact, Glance, Picture, Section, Table, anchor, rendered
from tsas_cli.reporting.drawing import picture

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


def harmless(text):
    """Assert that a page holds nothing but what our templates write; return its text."""
    text = without_script(text)
    seen = Outline(text)
    assert seen.tags <= set(TAGS.split())
    assert not [name for name, _ in seen.attributes if name.startswith("on")]
    addresses = [value for name, value in seen.attributes if name in {"href", "src", "xlink:href"}]
    assert {a for a in addresses if not a.startswith("#")} <= {"data:,"}
    assert {a[1:] for a in addresses if a.startswith("#")} <= set(seen.ids)
    assert all(re.fullmatch(r"[\w.-]+", name) for name in seen.ids)
    styles = [value for name, value in seen.attributes if name == "style"]
    assert not [style for style in styles if re.search(r"url\((?!#)|hit", style)]
    text.encode("utf-8")
    return "".join(seen.text)


@contextmanager
def spoil(path, *keys):
    """Yield what a file holds, with every text under the keys replaced, to be changed further."""

    def spoiled(table):
        return {k: EVIL if k in keys and isinstance(v, str) else v for k, v in table.items()}

    with by_hand.edited(path) as content:
        content |= json.loads(json.dumps(content), object_hook=spoiled)
        yield content


@pytest.fixture(scope="module")
def hostile(tmp_path_factory):
    """A page whose dataset, runs, columns, units, files and sentences are all hostile."""
    root = tmp_path_factory.mktemp("hostile") / "$(touch x) '<i>"
    dataset = by_hand.make_dataset(root / "data <b> & 'x'", (RUN, "plain"), samples=400)
    read = read_dataset(dataset)
    text = EVIL.replace("\ud800", "")  # which TOML cannot hold
    texts = dict.fromkeys(("name", "description", "license", "source"), text)
    manifest = read.manifest.model_copy(update=texts)
    tables = {r.run.id: pa.table({**r.columns, text: r.time_s}) for r in read}
    dataset = root / "again"
    dataset.mkdir()
    write_dataset(dataset, manifest, tables)
    keys = ("code", "run", "column", "sentence", "remedy")
    check = by_hand.make_check(
        dataset, root / "check", [{"severity": "error"} | dict.fromkeys(keys, EVIL)]
    )
    calibrate = by_hand.make_calibration(dataset, root / "calibrate", [EVIL])
    keys = ("unit", "note", "origin", "version", "name", "message")
    with spoil(calibrate / "calibration.json", *keys) as content:
        content["dataset"] = by_hand.source(dataset, calibrate)
    simulate = by_hand.make_simulation(dataset, root / "simulate")
    with spoil(simulate / "simulation.json", "unit", "version") as content:
        content["model"] = {"file": EVIL, "sha256": "ab" * 32}
        content["notes"] = [EVIL]
        cleaned = {"method": EVIL, "window_s": 1, "noise": 1, "unit": EVIL, "reversals": 1}
        for run in content["runs"].values():
            run |= {"solver": EVIL, "start": EVIL, "conditioning": {EVIL: cleaned}}
    diagnose = made_diagnoses.make_diagnosis(dataset, root / "diagnose", "named")
    keys = ("unit", "reason", "next_experiment", "sentence", "label", "version")
    with spoil(diagnose / "diagnosis.json", *keys) as content:
        (cause,) = content["named"]
        cause |= {"effect": EVIL, "title": EVIL, "equation": EVIL, "rivals": [EVIL, EVIL + "2"]}
        cause["parameters"] = {EVIL: next(iter(cause["parameters"].values()))}
        content["channels"] = {EVIL: next(iter(content["channels"].values()))}
        maps = content["residual_map"]
        for when in ("before", "after"):
            signals = {EVIL: maps[when]["f_in_N"]["phase"], **maps[when]["f_in_N"]}
            maps[when] = {EVIL: signals}
        content["signatures"]["effects"][0] = EVIL
    return by_hand.page_from(dataset, check, calibrate, simulate, diagnose)


def test_no_element_attribute_or_address_comes_of_a_name(hostile):
    text = harmless(hostile)
    assert text.count(SHOWN) > 30
    assert "49" not in re.findall(r"\{\{.*?\}\}", text)
    assert "\x07" not in hostile
    assert "\u202e" not in hostile
    assert "\\x07\\u202e" in text


def test_pictures_say_and_show_the_names_as_text(hostile):
    labels = Outline(hostile).labels
    assert any(RUN in label.replace("`", "") or RUN.replace("`", "") in label for label in labels)
    svg = "".join(re.findall("<svg.*?</svg>", hostile, re.DOTALL))
    assert "&lt;script&gt;hit()" in svg
    assert "<script" not in svg


def test_the_title_is_one_line_of_text(hostile):
    (title,) = re.findall("<title>(.*?)</title>", hostile, re.DOTALL)
    assert SHOWN in unescape(title)
    assert "\n" not in title


def test_commands_are_quoted_for_the_shell(hostile):
    for line in commands_of(hostile).strip().splitlines():
        words = shlex.split(line)
        assert words[0] == "tsas"
        assert not {"touch", "x)", "&"} & set(words)


def test_a_page_of_tracking_and_of_closing_is_harmless_too(tmp_path):
    tracked = made_loops.make_tracking(tmp_path / "tracked")
    keys = ("file", "origin", "quantity", "shape", "version")
    with spoil(tracked / "tracking.json", *keys) as content:
        content["notes"] = [EVIL]
        for result in content["results"]:
            result["controller"] += EVIL
            result["condition"] += EVIL
        content["conditions"] = {k + EVIL: v for k, v in content["conditions"].items()}
    assert SHOWN in harmless(by_hand.page_from(tracked))
    title, hidden, _, rows = made_loops.CASES["bend"]
    cases = {EVIL: (EVIL + title, {EVIL: 1.0} | hidden, [{"effect": EVIL, "rivals": [EVIL]}], {
        name + EVIL: rmse for name, rmse in rows.items()
    })}  # fmt: skip
    loop = made_loops.make_closing(tmp_path / "loop", cases, version=EVIL)
    assert SHOWN in harmless(by_hand.page_from(loop))


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


def test_an_address_holds_no_letter_that_means_something_in_html_css_or_urls():
    odd = ["a b", "a.20b", "a%20b", "a-b", "ä", '">', "a/b", ""]
    assert anchor("diagnosis", "free_tendon") == "diagnosis-free_tendon"
    addresses = {anchor("x", word) for word in odd}
    assert len(addresses) == len(odd)
    assert not set("".join(addresses)) & set(" %\"'<>&#()/?;:")
