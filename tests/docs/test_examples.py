"""The examples of README.md and docs/*.md: what they print is what they show."""

import re
from pathlib import Path

import pytest
import typer

from docs import examples
from docs.examples import PAGES, ROOT, blocks, commands, difference, refilled, run_page
from docs.manual.commands import commands as every_command

# What takes more than some seconds: `make docs-examples` runs them too.
NOT_RUN_HERE = {
    "docs/close-loop.md": ["close-loop"],
    "docs/drive.md": ["identify-harmonic-drive"],
    "docs/plan.md": ["plan"],
    "docs/sweep.md": ["sweep", "sweep"],
    "docs/tracking.md": ["track"],
}
# Of the others these take longest: `make test-large` runs them too.
LARGE = ("tutorial.md", "compare.md", "object-storage.md", "predict.md", "sweep.md")
SHOWING = [
    pytest.param(page, id=page.name, marks=pytest.mark.large if page.name in LARGE else ())
    for page in PAGES
    if any(b.kind == "calls" and not b.long for b in blocks(page.read_text(encoding="utf-8")))
]
SMALL = """# A page

<!-- file a.txt -->
```
one
two
```
<!-- file b.txt
three
-->
<!-- run -->
```python
from pathlib import Path
assert Path("b.txt").read_text() == "three\\n"
```
<!-- head a.txt -->
```
one
```

```
$ tsas explain nope
wrong
$ tsas --version
tsas {version}
```

<!-- long -->
```
$ tsas close-loop --out x
```
"""


@pytest.mark.parametrize("page", SHOWING)
def test_what_is_shown_is_what_is_printed(page):
    wrong = [difference(call) for call in run_page(page, long=False) if not call.holds]
    assert not wrong, "\n".join([*wrong, "`make docs-refill` writes what is true"])


def test_the_long_ones_are_these():
    found = {}
    for page in PAGES:
        for block in blocks(page.read_text(encoding="utf-8")):
            if block.long:
                names = [command.split()[1] for _, command, _ in commands(block)]
                found.setdefault(page.relative_to(ROOT).as_posix(), []).extend(names)
    assert found == NOT_RUN_HERE


@pytest.fixture
def small(tmp_path, monkeypatch):
    monkeypatch.setattr(examples, "ROOT", tmp_path)
    (tmp_path / "datasets").mkdir()
    page = tmp_path / "page.md"
    page.write_text(SMALL.format(version="9"), encoding="utf-8")
    return page


def test_a_page_is_run_compared_and_refilled(small):
    calls = run_page(small, long=False)
    assert [(call.command, call.holds) for call in calls] == [
        ("head a.txt", True),
        ("tsas explain nope", False),
        ("tsas --version", False),
    ]
    assert "-wrong" in difference(calls[1])
    small.write_text(refilled(small.read_text(encoding="utf-8"), calls), encoding="utf-8")
    text = small.read_text(encoding="utf-8")
    assert "wrong" not in text
    assert "tsas: there is no effect 'nope'" in text
    assert text.count("```") == SMALL.count("```")
    assert all(call.holds for call in run_page(small, long=False))


def test_left_out_lines_stay_left_out():
    call = examples.Call(Path("a.md"), 1, "tsas", ("first", "…", "last"), tuple("abcde"))
    assert call.true == ("a", "…", "e")
    assert not call.holds


def test_what_depends_on_the_machine_may_differ():
    call = examples.Call(Path("a.md"), 1, "tsas", ("r.html, 0.61 MB",), ("r.html, 0.59 MB",))
    assert call.holds


def test_a_defect_stops_the_run(monkeypatch):
    def broken() -> None:
        raise SystemExit(1)

    monkeypatch.setattr("tsas_cli.__main__.main", broken)
    with pytest.raises(RuntimeError, match="ended with 1"):
        examples.output_of("tsas check x")


def test_every_call_in_the_pages_names_a_command_and_options_that_exist():
    known = {
        name: {o for p in command.params for o in (*p.opts, *p.secondary_opts)} | {"--help"}
        for name, command in every_command()
    }
    top = typer.main.get_command(__import__("tsas_studies.commands").commands.app)
    known["tsas"] = {o for p in top.params for o in p.opts} | {"--help"}
    wrong = []
    for page in PAGES:
        for block in blocks(page.read_text(encoding="utf-8")):
            for line in block.lines:
                call = re.match(r"(?:\$ )?(tsas\b[^#]*)", line)
                if not call or ":" in call[1].split()[0]:
                    continue
                words = call[1].split()
                name = next((n for k in (3, 2, 1) if (n := " ".join(words[:k])) in known), "tsas")
                options = re.findall(r"(?<![\w-])--[a-z][\w-]*", call[1])
                if name == "tsas" and len(words) > 1 and words[1][0] not in "-:":
                    wrong.append(f"{page.name}: {line}")
                wrong += [f"{page.name}: {line}" for o in options if o not in known[name]]
    assert wrong == []
