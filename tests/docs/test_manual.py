"""The site of the documentation: whole, true to the program, and at home without a network."""

import inspect
import json
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import tsas_cli
from docs.manual import drawn, pages
from docs.manual.api import api_page
from docs.manual.colours import palettes
from docs.manual.commands import command_page, commands, example
from docs.manual.effects import PARTS, _figure, effect_pages, parts_of
from docs.manual.links import for_site, targets
from docs.manual.signatures import SIGNATURES
from tsas_cli.effects import EFFECTS
from tsas_cli.reporting.colours import STAND_IN

EVERY_EFFECT = pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.name)
LOADED = re.compile(r"""(?:src|srcset)\s*=\s*["']?https?:|url\(["']?https?:|@import|unpkg""")
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")


def flat(text):
    return " ".join(text.split())


def figure(effect):
    """Return the figure of one effect, and of the others, which are drawn alike, its frame."""
    return _figure(effect) if effect.name == "backlash" else f"<figure>{effect.name}</figure>"


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    pytest.importorskip("zensical", reason="the group docs is not installed")
    from docs.manual.build import build

    return build(tmp_path_factory.mktemp("site"), effect_pages(figure))


def test_the_site_is_built_without_a_complaint_and_holds_every_page(site):
    wanted = {page.site for page in pages.pages()} | {"commands.md", "api.md", *effect_pages(str)}
    built = {path.relative_to(site).with_suffix(".md").as_posix() for path in site.rglob("*.html")}
    assert wanted <= built


def test_nothing_is_loaded_from_elsewhere(site):
    texts = {p.name: p.read_text(encoding="utf-8") for p in site.rglob("*.html")}
    assert len(texts) > 40
    assert [name for name, text in texts.items() if LOADED.search(text)] == []
    links = [tag for text in texts.values() for tag in re.findall(r"<link[^>]*>", text)]
    assert [tag for tag in links if "http" in tag] == []
    sheets = [p.read_text(encoding="utf-8") for p in site.rglob("*.css")]
    assert [s[:60] for s in sheets if LOADED.search(s.replace("@import", ""))] == []
    assert "<script src=" in texts["index.html"]
    assert "iframe-worker.js" in texts["index.html"]


def test_the_search_knows_the_pages(site):
    items = json.loads((site / "search.json").read_text(encoding="utf-8"))["items"]
    found = [i["text"] for i in items if i["location"].startswith("effects/backlash.html")]
    assert "a reversal of x_in" in " ".join(found)
    assert "[mm]" not in found[0]  # of an axis
    assert (site / "search.js").is_file()


SEARCH = """<script>
function all(root, sel, out = []) {
  root.querySelectorAll("*").forEach(e => {
    if (e.matches(sel)) out.push(e);
    if (e.shadowRoot) all(e.shadowRoot, sel, out);
  });
  return out;
}
setTimeout(() => {
  document.querySelector(".md-search__button").click();
  setTimeout(() => {
    const field = all(document, "input[aria-label=Search]")[0];
    field.value = "backlash";
    field.dispatchEvent(new InputEvent("input", {bubbles: true, composed: true}));
    setTimeout(() => {
      const found = document.createElement("pre");
      found.textContent = "found " + all(document, "a").map(a => a.href).join(" ");
      document.body.append(found);
    }, 3000);
  }, 2000);
}, 1500);
</script></body>"""


def opened(page: Path, work: Path) -> tuple[str, list[str]]:
    """Return a page as a browser makes it, and the addresses that it asks the network for."""
    log = work / "net.json"
    call = [
        *(CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--dump-dom"),
        *("--no-first-run", "--disable-background-networking", "--disable-component-update"),
        *("--disable-sync", "--host-resolver-rules=MAP * ~NOTFOUND", f"--log-net-log={log}"),
        *(f"--user-data-dir={work / 'user'}", "--virtual-time-budget=12000", page.as_uri()),
    ]
    done = subprocess.run(call, capture_output=True, text=True, check=True, timeout=120)
    lines = [line.rstrip().rstrip(",") for line in log.read_text(encoding="utf-8").splitlines()]
    events = [json.loads(line) for line in lines if line.startswith('{"params"')]
    wanted = [event["params"] for event in events if "initiator" in event["params"]]
    pages = [p["url"] for p in wanted if p["initiator"] == "null"]  # else it is the browser's own
    return done.stdout, [url for url in pages if url.startswith("http")]


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")
def test_a_browser_asks_for_nothing_and_finds_what_is_searched(site, tmp_path):
    loud = tmp_path / "loud.html"
    loud.write_text('<html><img src="http://elsewhere.invalid/a.png"></html>', encoding="utf-8")
    assert opened(loud, tmp_path)[1] == ["http://elsewhere.invalid/a.png"]
    page = site / "limits.html"
    searching = site / "searching.html"
    text = page.read_text(encoding="utf-8").replace("</body>", SEARCH)
    searching.write_text(text, encoding="utf-8")
    shown, asked = opened(searching, tmp_path)
    searching.unlink()
    assert asked == []
    assert "effects/backlash.html?h=backlash" in shown.split("<pre>found ")[1]


def test_the_picture_stands_alone():
    text = (pages.ROOT / "docs" / "before-after.svg").read_text(encoding="utf-8")
    assert len(text) < 150_000
    assert set(re.findall(r"var\(--([\w-]+)\)", text)) <= set(re.findall(r"--([\w-]+):", text))
    assert not re.search(r"(href|src)=.http", text)
    assert "On held-out runs the residual falls from" in text


def test_every_page_of_docs_but_the_worklog_is_in_the_site_once():
    kept = {path.relative_to(pages.ROOT).as_posix() for path in (pages.ROOT / "docs").glob("*.md")}
    listed = [page.source for page in pages.pages()]
    assert len(listed) == len(set(listed))
    assert kept - set(listed) == {"docs/worklog.md"}


@pytest.mark.parametrize("page", ["README.md", "docs/worklog.md"])
def test_links_that_the_site_does_not_follow_lead_somewhere(page):
    for target in targets((pages.ROOT / page).read_text(encoding="utf-8"), page):
        assert (pages.ROOT / target).exists(), target


def test_links_lead_within_the_site_or_become_words():
    sites = {"docs/a.md": "a.md", "docs/b.md": "sub/b.md", "tsas_cli/effects": "effects/index.md"}
    text = "[b](b.md#x) [e](../tsas_cli/effects/) [code](../tsas_cli/app.py) [w](https://w.org/)"
    assert for_site(text, "docs/a.md", sites) == (
        "[b](sub/b.md#x) [e](effects/index.md) code [w](https://w.org/)"
    )
    assert for_site("[a](a.md)", "docs/b.md", sites) == "[a](../a.md)"


def test_fences_keep_their_text_and_comments_go():
    text = "a\n<!-- file x\n[a](b.md)\n-->\n```\n$ tsas x\n[a](b.md)\n```\n"
    assert for_site(text, "docs/a.md", {"docs/a.md": "a.md"}) == (
        "a\n```console\n$ tsas x\n[a](b.md)\n```\n"
    )


@EVERY_EFFECT
def test_an_effect_has_all_its_parts(effect):
    page = flat(re.sub(r"\[(\w+)\]\(\w+\.md\)", r"\1", PAGES[f"effects/{effect.name}.md"]))
    parts = parts_of(effect.doc)
    assert list(parts) == ["", *PARTS]
    for part in (effect.title, effect.equation, effect.experiment, *parts.values()):
        assert flat(part) in page
    said = flat(effect.doc)
    assert all(text[1:] in said for text in parts.values())
    for p in effect.parameters:
        assert f"| `{p.name}` | {p.unit} | " in page


PAGES = effect_pages(lambda effect: f"<figure>{effect.name}</figure>")


def test_a_text_without_a_part_is_refused():
    with pytest.raises(ValueError, match="expected the parts"):
        parts_of("A thing.\n\nEquation: x.\n")


def test_every_effect_has_a_signature():
    names = [effect.name for effect in EFFECTS]
    assert list(SIGNATURES) == names, "docs/manual/signatures.py has one for each, in order"


@EVERY_EFFECT
def test_a_signature_is_large_enough_to_be_seen(effect):
    signature = SIGNATURES[effect.name]
    without = drawn._run(effect, {}, signature.motion)
    for variant in signature.variants:
        changed = drawn._run(effect, dict(variant.values), signature.motion)
        change = np.abs(changed[variant.channel] - without[variant.channel])
        assert change.max() > 0.03 * np.ptp(without[variant.channel])
        shown = [channel for plane in signature.planes for channel in plane]
        seen = max(np.abs(changed[c] - without[c]).max() / np.ptp(without[c]) for c in shown)
        assert seen > 0.03


def test_a_figure_is_the_same_each_time_and_takes_the_colours_of_the_page():
    effect = EFFECTS[0]
    first, again = (drawn.signature_picture(effect, SIGNATURES[effect.name]).svg for _ in range(2))
    assert first == again
    assert "var(--after)" in first
    assert "#c0ff" not in first
    assert not LOADED.search(first)
    assert SIGNATURES[effect.name].look in first


def test_both_schemes_name_every_colour():
    for scheme in palettes():
        assert set(re.findall(r"--([\w-]+):", scheme)) >= set(STAND_IN)


def test_every_command_is_in_the_reference_with_an_example():
    page = command_page()
    for name, _ in commands():
        assert f"\n## {name}\n" in page
        assert f"\n$ {example(name)[0]}\n" in page
    with pytest.raises(LookupError):
        example("tsas nope")


@pytest.mark.parametrize("name", ["simulate", "report", "challenge score"])
def test_the_reference_says_what_help_says(tsas, monkeypatch, name):
    monkeypatch.setenv("TYPER_USE_RICH", "0")
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.setenv("TERMINAL_WIDTH", "200")
    printed = tsas(*name.split(), "--help").stdout
    section = command_page().split(f"\n## tsas {name}\n")[1].split("\n## ")[0]
    rows = re.findall(r"^\| `(.*?)` \| (.*) \|$", section.replace("\\|", "|"), re.MULTILINE)
    shown = {flat(names): flat(about) for names, about in rows}
    assert len(shown) > 4
    squeezed = re.sub(r"\s", "", printed)
    for names, about in shown.items():
        assert re.sub(r"\s", "", names + about) in squeezed
    listed = set(re.findall(r"^ +(?:-\w, )?(--[a-z-]+)", printed, re.MULTILINE)) - {"--help"}
    assert listed == {n for names in shown for n in re.findall(r"--[a-z-]+", names)[:1]}


def test_the_python_api_has_every_call_and_argument():
    page = api_page()
    for name in tsas_cli.__all__:
        section = page.split(f"\n## tsas.{name}\n")[1].split("\n## ")[0]
        thing = getattr(tsas_cli, name)
        if not inspect.isclass(thing):
            told = re.findall(r"^\| `(\w+)` \| .+ \|$", section, re.MULTILINE)
            assert told == list(inspect.signature(thing).parameters)
            assert "**Returns**" in section
