"""The page of `tsas compare`: what differs, how sure that is, and where it shows."""

import shlex
from collections.abc import Callable, Iterator, Sequence

from tsas_cli.comparing.compare import Comparison
from tsas_cli.comparing.sentences import findings, notes
from tsas_cli.comparing.stage import tables
from tsas_cli.reporting.comparing import maps, residuals, values
from tsas_cli.reporting.content import Section, Table
from tsas_cli.reporting.rendered import rendered

_SAID = 3  # findings that stand in the summary
_VALUES = (
    "B − A has a 95 % interval where both values were fitted, to different recordings: it goes as "
    "far as the two intervals in quadrature, each side on its own. Where it does not hold 0, the "
    "difference is more than the uncertainty of both."
)


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
    printed = {table[0]: Table.printed(table) for table in tables(it)}
    points = (*findings(it)[_SAID:], *notes(it))
    yield Section("sides", "What is compared", points=points, tables=(printed["sides"],))
    if "parameters" in printed:
        shown = tuple(values.pictures(it))
        how = (_VALUES,) if it.tested else ()
        yield Section("values", "Values", how, tables=(printed["parameters"],), pictures=shown)
    if "effects" in printed:
        said = tuple(f"{name}: {side.reason}" for name, side in it.sides.items() if side.reason)
        yield Section("effects", "Effects", said, tables=(printed["effects"],))
    if errors := tuple(table for name, table in printed.items() if name.startswith("error")):
        yield Section("errors", "Errors per run", tuple(_held_to(it)), tables=errors)
    if it.maps:
        yield maps.section(it)
    if it.shared:
        yield residuals.section(it)
    yield _repeat(it)


def _held_to(it: Comparison) -> Iterator[str]:
    if it.on is None:
        yield "Each side is held to the recordings that it has read."
    else:
        yield f"Both models are simulated on the recordings of {it.on.manifest.name}."
    if it.shared:
        yield "A ratio below 1 means that B is nearer to the measurement than A."


def _repeat(it: Comparison) -> Section:
    command = ["tsas", "compare", str(it.a.path), str(it.b.path)]
    if it.on is not None:
        command += ["--on", str(it.on.folder)]
        if it.on.chosen is not None:
            command += ["--runs", ",".join(it.on.chosen)]
    files = tuple(
        (name, file, digest)
        for name, side in it.sides.items()
        for file, digest in side.files.items()
    )
    if it.on is not None:
        files += tuple(("", file, digest) for file, digest in it.on.hashes().items())
    return repeat_section(command, files)


def repeat_section(command: Sequence[str], files: tuple[tuple[str, str, str], ...]) -> Section:
    """Return the command that makes the page, and the checksums of what both sides read."""
    return Section(
        "repeat",
        "How to repeat it",
        ("This command makes the same page from the same files.",),
        tables=(Table("Files read", ("side", "file", "SHA-256"), files),),
        commands=(shlex.join([*command, "--out", "compared"]),),
    )
