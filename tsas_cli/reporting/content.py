"""What the first screen and the sections of a page are made of, and the page from them."""

import re
from base64 import b64encode
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from importlib.resources import files
from itertools import islice

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from tsas_cli.reporting.numbers import ABSENT, MINUS
from tsas_cli.support import __version__
from tsas_cli.support.errors import printable

MOST_RUNS = 10  # of which a section has pictures
_NUMBER = re.compile(f"(?:[-{MINUS}]?\\d.{{0,22}}|{ABSENT}|none|)$")  # a cell among numbers


@dataclass(frozen=True)
class Table:
    """A table: its caption, header and rows of text; columns in `numeric` are aligned to the right.

    `notes`, where there are any, are sentences under each row, over the whole width.
    """

    caption: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    numeric: frozenset[int] = frozenset()
    notes: tuple[str, ...] = ()


def table_of(
    caption: str, header: Sequence[str], rows: Iterable[Sequence[str]], notes: Iterable[str] = ()
) -> Table:
    """Return a table without its empty columns; numbers are aligned to the right."""
    if "_" not in caption.partition(" ")[0]:
        caption = caption[:1].upper() + caption[1:]
    cells = tuple(rows)
    kept = [k for k in range(len(header)) if any(row[k] not in {"", ABSENT} for row in cells)]
    shown = tuple(tuple(row[k] for k in kept) for row in cells)
    return Table(
        caption,
        tuple(header[k] for k in kept),
        shown,
        frozenset(k for k in range(1, len(kept)) if all(_NUMBER.match(row[k]) for row in shown)),
        tuple(notes),
    )


def table_by_column(caption: str, rows: Iterable[Mapping[str, str]]) -> Table:
    """Return a table of rows that map the names of their columns to cells."""
    cells = list(rows)
    header = list(dict.fromkeys(name for row in cells for name in row))
    return table_of(caption, header, [[row.get(name, "") for name in header] for row in cells])


@dataclass(frozen=True)
class Picture:
    """A plot as inline SVG, with the alternative text inside, and the caption under it."""

    svg: Markup
    caption: str


@dataclass(frozen=True)
class Group:
    """Pictures under one name that a reader can fold away, one group per run."""

    name: str
    pictures: tuple[Picture, ...]


@dataclass(frozen=True)
class Fact:
    """One number of the first screen: what it is, the number, and what to compare it with.

    Where there was another number before, `before` holds it.
    """

    label: str
    value: str
    note: str = ""
    before: str = ""


@dataclass(frozen=True)
class Glance:
    """The first screen: the kind of answer, the answer in a few words, the numbers behind it.

    `next_experiment` and `pictures` stand right under the answer; `numbers` says what the facts
    are.
    """

    kind: str
    verdict: str
    numbers: str = ""
    facts: tuple[Fact, ...] = ()
    pictures: tuple[Picture, ...] = ()
    next_experiment: str = ""


@dataclass(frozen=True)
class Section:
    """One section: what it shows, in the order of the fields; `parts` have their own headings.

    `given` says whether there was anything to make it from, `folded` whether only its title shows
    until a reader opens it.
    """

    anchor: str
    title: str
    intro: tuple[str, ...] = ()
    points: tuple[str, ...] = ()
    equations: tuple[str, ...] = ()
    commands: tuple[str, ...] = ()
    tables: tuple[Table, ...] = ()
    pictures: tuple[Picture, ...] = ()
    groups: tuple[Group, ...] = ()
    closing: tuple[str, ...] = ()
    parts: tuple["Section", ...] = ()
    given: bool = True
    folded: bool = False


def anchor(*words: str) -> str:
    """Return words as one name that can be an id and an address, whatever letters they hold.

    >>> anchor("diagnosis", "free_tendon"), anchor("map", "a b")
    ('diagnosis-free_tendon', 'map-a.20b')
    """
    return "-".join(re.sub(r"[^\w-]", lambda letter: f".{ord(letter[0]):x}", w) for w in words)


def pictures_by_run(
    count: int, runs: Iterable[tuple[str, Iterable[Picture]]]
) -> tuple[tuple[Group, ...], tuple[str, ...]]:
    """Return the pictures of the first runs, each by its name; where runs are left, a sentence.

    `count` is the number of all runs.
    """
    first = ((run, tuple(pictures)) for run, pictures in islice(runs, MOST_RUNS))
    groups = tuple(Group(f"Run {run}", pictures) for run, pictures in first if pictures)
    return groups, (f"{MOST_RUNS} of {count} runs are drawn.",) if count > MOST_RUNS else ()


def missing(anchor: str, title: str, *, what: str, stage: str) -> Section:
    """Return a section that only says what was not given, and which stage writes it."""
    sentence = f"No {what} was given: add a folder written by `tsas {stage}`."
    return Section(anchor, title, (sentence,), given=False)


def rendered(
    *,
    name: str,
    about: str,
    summary: str,
    sections: Iterable[Section],
    glance: Glance | None = None,
    advance: Callable[[], None] = lambda: None,
) -> str:
    """Return a page as HTML.

    `about` follows the name in the window's title; what stands between backticks in the summary
    becomes code. Each of the sections is in the contents, and so are its parts; `glance` stands
    above all. `advance` is called after each section.
    """
    made = []
    for section in sections:
        made.append(section)
        advance()
    environment = Environment(
        loader=PackageLoader("tsas_cli.reporting"),
        autoescape=True,
        finalize=_visible,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["prose"] = _prose
    script = (files("tsas_cli.reporting") / "templates" / "figures.js").read_text(encoding="utf-8")
    return environment.get_template("page.html").render(
        name=name,
        about=about,
        summary=summary,
        sections=made,
        glance=glance,
        version=__version__,
        script=Markup(script),  # noqa: S704  our own, and the one that the page allows
        digest=b64encode(sha256(script.encode()).digest()).decode(),
    )


def _prose(text: str) -> Markup:
    """Escape a sentence; what stands between backticks in it becomes code."""
    return Markup(re.sub("`([^`]+)`", r"<code>\1</code>", str(escape(printable(text)))))  # noqa: S704


def _visible(value: object) -> object:
    """Make control characters in names from files visible; leave our own markup as it is."""
    return value if isinstance(value, Markup) else printable(str(value))
