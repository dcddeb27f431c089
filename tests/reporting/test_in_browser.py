"""Every kind of page in a real browser: whole, quiet, accessible, on a phone and on a desk."""

import re
from importlib import resources
from itertools import product

import pytest

from tests.reporting.pages import KINDS, chromium, page_of

expect = pytest.importorskip("playwright.sync_api").expect
expect.set_options(timeout=40_000)  # ms, on a machine that is busy
PHONE, DESK = 390, 1280
EACH_TIME = {*((kind, PHONE, "dark") for kind in KINDS), ("pipeline", DESK, "light")}
LOOKS = [
    pytest.param(*look, marks=() if look in EACH_TIME else pytest.mark.large)
    for look in product(KINDS, (PHONE, DESK), ("dark", "light"))
]
# A picture counts as one image with its text: what is inside of it goes before the page is judged.
JUDGE = """(() => {
    document.querySelectorAll('svg > :not(title, desc)').forEach(it => it.remove());
    return axe.run({exclude: [['svg > *']]}, {resultTypes: ['violations']});
})()"""
# Folds are opened first: what is folded away is neither drawn nor judged.
UNFOLD = "document.querySelectorAll('details').forEach(fold => fold.open = true)"
SIZES = """Array.from(document.querySelectorAll('svg, img'), it => {
    const outer = it.getBoundingClientRect(), drawn = it.getBBox ? it.getBBox() : outer;
    return [outer.left, outer.right, outer.height, drawn.width, drawn.height];
})"""
# Where each address of the page leads to, but for those inside of pictures.
FOLLOW = """(async () => {
    const places = [];
    for (const it of document.querySelectorAll('main [id]:not(svg [id])')) {
        location.hash = it.id;
        await new Promise(requestAnimationFrame);
        const place = it.getBoundingClientRect();
        places.push([it.id, place.top, place.height]);
    }
    return places;
})()"""
WIDTHS = "[document.documentElement.scrollWidth, document.body.scrollWidth]"


@pytest.fixture(scope="module")
def browser():
    with chromium() as opened:
        yield opened


@pytest.fixture(scope="module")
def made(tmp_path_factory, browser):
    """By kind, the file of a page; each is made when it is asked for."""
    files = {}

    def make(kind):
        if kind not in files:
            root = tmp_path_factory.mktemp(kind)
            files[kind] = root / "page.html"
            files[kind].write_text(page_of(kind, root), encoding="utf-8")
        return files[kind].as_uri()

    return make


@pytest.fixture
def tab(browser):
    """Return a function that opens a page; its faults and requests gather in two lists."""
    contexts = []

    def open_(address, width, scheme="light", **more):
        context = browser.new_context(
            viewport={"width": width, "height": 844}, color_scheme=scheme, **more
        )
        contexts.append(context)
        one = context.new_page()
        one.faults, one.asked = [], []
        one.on("console", lambda message: one.faults.append(message.text))
        one.on("pageerror", lambda error: one.faults.append(str(error)))
        one.on("request", lambda request: one.asked.append(request.url))
        one.goto(address)
        return one

    yield open_
    for context in contexts:
        context.close()


@pytest.fixture(scope="module")
def axe():
    """Return the script of axe-core, which a package for tests carries."""
    pytest.importorskip("axe_playwright_python")
    script = resources.files("axe_playwright_python") / "axe.min.js"
    return script.read_text(encoding="utf-8")


def judged(one, axe):
    """Return each fault that axe-core finds, of whatever weight, with where it is."""
    one.evaluate(axe)
    found = one.evaluate(JUDGE)
    return [
        (fault["id"], node["html"][:200])
        for fault in found["violations"]
        for node in fault["nodes"]
    ]


def test_the_judge_finds_faults_where_there_are_some(tab, axe, tmp_path):
    path = tmp_path / "poor.html"
    path.write_text("<html><p style='color: #aaa'>pale</p><svg role='img'><g/></svg>")
    faults = {name for name, _ in judged(tab(path.as_uri(), PHONE), axe)}
    assert {"color-contrast", "svg-img-alt", "html-has-lang"} <= faults


@pytest.mark.parametrize(("kind", "width", "scheme"), LOOKS)
def test_it_is_drawn_whole_and_no_fault_is_found(made, tab, axe, kind, width, scheme):
    one = tab(made(kind), width, scheme)
    assert max(one.evaluate(WIDTHS)) <= width
    one.evaluate(UNFOLD)
    assert max(one.evaluate(WIDTHS)) <= width
    sizes = one.evaluate(SIZES)
    assert sizes
    for left, right, height, drawn_width, drawn_height in sizes:
        assert 0 <= left < right <= width
        assert min(height, drawn_width, drawn_height) > 20
    assert judged(one, axe) == []
    assert one.faults == []
    assert one.asked == [made(kind)]


def test_the_keyboard_reaches_the_content_at_once_and_shows_where_it_is(made, tab):
    one = tab(made("closing"), DESK)
    focused = "document.activeElement.textContent.trim()"
    one.keyboard.press("Tab")
    assert one.evaluate(focused) == "Skip to the content"
    assert one.locator(".skip").bounding_box()["y"] >= 0
    outline = "getComputedStyle(document.activeElement).outlineStyle"
    assert one.evaluate(outline) != "none"
    one.keyboard.press("Enter")
    assert one.evaluate("document.activeElement.id") == "content"
    one.keyboard.press("Tab")
    assert one.evaluate(focused) == one.locator("main h2").first.inner_text()
    assert one.evaluate(outline) != "none"


def test_the_page_of_a_pipeline_is_short_and_begins_with_the_picture(made, tab):
    one = tab(made("pipeline"), 1400)
    assert one.evaluate("document.documentElement.scrollHeight") <= 4000
    assert one.locator("main details").first.bounding_box()["y"] <= 4000
    first = one.locator(".glance svg").first.bounding_box()
    assert first["y"] + first["height"] < 844
    expect(one.locator("main table").first).not_to_be_visible()


def plot_of(one):
    """Return the first plot, ready, and a function that moves the mouse to parts of its size."""
    plot = one.locator(".glance .plot").first
    plot.locator(".key").first.wait_for()
    box = plot.locator("svg").bounding_box()

    def move(x, y, **more):
        one.mouse.move(box["x"] + x * box["width"], box["y"] + y * box["height"], **more)

    return plot, move


def test_values_show_under_the_mouse_at_the_same_sample_in_both_panels(made, tab):
    one = tab(made("pipeline"), DESK)
    plot, move = plot_of(one)
    tip = one.locator(".tip")
    expect(tip).not_to_be_visible()
    move(0.5, 0.37)
    said = tip.inner_text().split("\n")
    assert re.fullmatch(r"x_in −?[\d.]+ mm", said[0])
    assert re.fullmatch(r"time [\d.]+ s", said[8])
    assert said[2::2][:3] == ["measured", "nominal model", "extended model"]
    measured, nominal = (float(said[k].removesuffix(" N").replace("−", "-")) for k in (3, 5))
    residual = float(said[11].removesuffix(" N").replace("−", "-"))
    assert measured - nominal == pytest.approx(residual, abs=0.02)
    assert plot.locator("circle.mark").count() == 5
    move(0.5, 1.2)
    expect(tip).not_to_be_visible()
    assert plot.locator("circle.mark").count() == 0


def test_a_click_or_a_key_on_the_legend_hides_a_curve_and_shows_it_again(made, tab):
    one = tab(made("pipeline"), DESK)
    plot, _ = plot_of(one)
    curves = plot.locator("[id*=axes_] > g > [clip-path][style*='--before']")
    shown = lambda: [curves.nth(k).is_visible() for k in range(2)]  # noqa: E731
    assert shown() == [True, True]
    key = plot.get_by_role("button", name="nominal model")
    key.click()
    assert key.get_attribute("aria-pressed") == "false"
    assert shown() == [False, False]
    key.press("Enter")
    assert key.get_attribute("aria-pressed") == "true"
    assert shown() == [True, True]


def test_a_legend_hides_a_mean_with_its_bars_and_points(made, tab):
    one = tab(made("pipeline") + "#diagnosis-maps", DESK)
    one.evaluate(UNFOLD)
    plot = one.locator(".plot:has(svg[aria-label^='Mean residual'])").first
    curve = plot.locator("[id*=axes_] > g [style*='stroke: var(--before)']").first
    plot.scroll_into_view_if_needed()
    plot.get_by_role("button", name="nominal model").click()
    parts = plot.locator("[id*=axes_] > g").locator("[style*='stroke: var(--before)']")
    assert parts.count() > 2
    expect(curve).not_to_be_visible()
    assert not any(parts.nth(k).is_visible() for k in range(parts.count()))


def test_curves_without_a_legend_show_their_values_too(made, tab):
    one = tab(made("tracking"), DESK)
    plot = one.locator("#tracking-effort .plot").first
    plot.scroll_into_view_if_needed()
    plot.locator(".reset").wait_for(state="attached")
    box = plot.bounding_box()
    plot.hover(position={"x": box["width"] / 2, "y": box["height"] / 4})
    expect(one.locator(".tip")).to_contain_text("time")


def test_a_part_of_a_loop_is_enlarged_with_ticks_of_its_own_and_back(made, tab):
    one = tab(made("pipeline"), DESK)
    plot, move = plot_of(one)
    loop = plot.locator("[id*=axes_1] > g > [clip-path][style*='--after']")
    whole = loop.get_attribute("d")
    ticks = plot.locator("[id*=axes_1] text").all_text_contents()
    move(0.7, 0.15)
    one.mouse.down()
    move(0.9, 0.4, steps=4)
    one.mouse.up()
    assert loop.get_attribute("d") != whole
    shown = plot.locator("[id*=axes_1] text:visible").all_text_contents()
    assert shown
    values = [float(text.replace("−", "-")) for text in shown if "[" not in text]
    assert values != [float(text.replace("−", "-")) for text in ticks if "[" not in text]
    plot.get_by_role("button", name="Reset zoom").click()
    assert loop.get_attribute("d") == whole
    expect(plot.locator(".reset")).not_to_be_visible()
    box = plot.bounding_box()
    one.mouse.dblclick(box["x"] + box["width"] / 2, box["y"] + box["height"] / 3)
    assert loop.get_attribute("d") != whole


def test_a_folded_section_opens_by_its_link_its_address_and_the_keyboard(made, tab):
    one = tab(made("pipeline"), DESK)
    table = one.locator("#parameters table").first
    expect(table).not_to_be_visible()
    one.locator("nav a[href='#parameters']").click()
    expect(table).to_be_visible()
    shown = one.locator("#simulation svg").first
    expect(shown).not_to_be_visible()
    one.locator("#simulation summary").first.press("Enter")
    expect(shown).to_be_visible()
    again = tab(made("pipeline") + "#simulation", DESK)
    expect(again.locator("#simulation svg").first).to_be_visible()


def test_contents_are_folded_on_a_phone_and_stay_beside_the_text_on_a_desk(made, tab):
    link = "nav ol ol a"
    one = tab(made("diagnosis"), PHONE)
    expect(one.locator(link).first).not_to_be_visible()
    one.locator("nav summary").click()
    expect(one.locator(link).first).to_be_visible()
    one = tab(made("diagnosis"), DESK)
    expect(one.locator(link).first).to_be_visible()
    one.evaluate("window.scrollTo(0, document.body.scrollHeight)")
    nav, main = (one.locator(name).bounding_box() for name in ("nav", "main"))
    assert 0 <= nav["y"] < 50
    assert nav["x"] + nav["width"] < main["x"]


def test_every_address_leads_into_view_and_into_folds(made, tab):
    places = tab(made("pipeline"), PHONE).evaluate(FOLLOW)
    assert len(places) > 15
    for name, top, height in places:
        assert height > 0, name
        assert top < 844, name


def test_paper_is_light_whole_and_unfolded(made, tab):
    one = tab(made("diagnosis"), 700, "dark")
    one.emulate_media(media="print", color_scheme="dark")
    expect(one.locator("main details:not([open]) svg").last).to_be_visible()
    assert one.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    expect(one.locator(".skip")).not_to_be_visible()
    overflow = one.locator(".scroll").first.evaluate("it => getComputedStyle(it).overflowX")
    assert overflow == "visible"


def test_on_a_phone_a_wide_table_scrolls_in_its_own_region(made, tab):
    one = tab(made("pipeline"), PHONE)
    wide = one.locator(".scroll").evaluate_all(
        "them => them.filter(it => it.scrollWidth > it.clientWidth).map(it => it.tabIndex)"
    )
    assert wide
    assert set(wide) == {0}
