"""The page of `tsas compare`: what differs, how sure that is, and where it shows."""

import shlex
from collections.abc import Callable, Iterator

from tsas_cli.comparing.compare import Comparison
from tsas_cli.comparing.sentences import findings, notes
from tsas_cli.comparing.stage import effects, recordings_of
from tsas_cli.reporting.comparing import errors, maps, residuals, values
from tsas_cli.reporting.content import Section, Table
from tsas_cli.reporting.rendered import rendered

_SAID = 3  # findings that stand in the summary


def comparison_page(it: Comparison, advance: Callable[[], None] = lambda: None) -> str:
    """Return the whole page as HTML; `advance` is called after each section."""
    sections = []
    for section in _sections(it):
        sections.append(section)
        advance()
    return rendered(
        name="A and B, side by side",
        about=f"{it.a.path} and {it.b.path}",
        summary=" ".join(findings(it)[:_SAID]) or "There is nothing that both sides hold.",
        sections=sections,
    )


def _sections(it: Comparison) -> Iterator[Section]:
    yield _what(it)
    if it.pairs:
        yield values.section(it)
    if found := effects(it):
        rows = tuple((row.effect, row.a or "–", row.b or "–") for row in found)
        yield Section(
            "effects",
            "Effects",
            tuple(f"{name}: {side.reason}" for name, side in it.sides.items() if side.reason),
            tables=(Table("Effects that a model holds, and their rivals", HEADER, rows),),
        )
    if it.errors:
        yield errors.section(it)
    if it.maps:
        yield maps.section(it)
    if it.shared:
        yield residuals.section(it)
    yield _repeat(it)


HEADER = ("effect", "A", "B")


def _what(it: Comparison) -> Section:
    rows = tuple(
        (name, side.kind, str(side.path), recordings_of(side), side.dynamics, side.verdict)
        for name, side in it.sides.items()
    )
    header = ("", "kind", "path", "recordings read", "dynamics", "verdict")
    said = findings(it)[_SAID:]
    return Section(
        "sides",
        "What is compared",
        points=(*said, *notes(it)),
        tables=(Table("The two sides", header, rows).without_empty(),),
    )


def _repeat(it: Comparison) -> Section:
    command = ["tsas", "compare", str(it.a.path), str(it.b.path)]
    if it.on is not None:
        command += ["--on", str(it.on.folder)]
        if it.on.chosen is not None:
            command += ["--runs", ",".join(it.on.chosen)]
    command += ["--fit-own"] if it.own_fitted else []
    files = tuple(
        (name, file, digest)
        for name, side in it.sides.items()
        for file, digest in side.files.items()
    )
    if it.on is not None:
        files += tuple(("", file, digest) for file, digest in it.on.hashes().items())
    return Section(
        "repeat",
        "How to repeat it",
        ("This command makes the same page from the same files.",),
        tables=(Table("Files read", ("side", "file", "SHA-256"), files),),
        commands=(shlex.join([*command, "--out", "compared"]),),
    )
