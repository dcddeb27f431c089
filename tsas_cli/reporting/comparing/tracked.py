"""The page of two folders of tracked runs: what was asked for, the scores, the errors over time."""

from collections.abc import Callable, Iterator
from functools import partial

from tsas_cli.comparing.tracked import (
    TRACKING_FILE,
    ControllerPair,
    Tracks,
    findings,
    notes,
    tables,
)
from tsas_cli.recordings.writing import columns_of, result_file
from tsas_cli.reporting.comparing.page import repeat_section
from tsas_cli.reporting.content import Picture, Section, Table, rendered
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.numbers import with_spread
from tsas_cli.reporting.tracking.runs import TRUE, WANTED
from tsas_cli.reporting.two_residuals import Residuals, draw_two_residuals, height_in


def tracked_page(it: Tracks, advance: Callable[[], None] = lambda: None) -> str:
    """Return the whole page as HTML; `advance` is called after each section.

    InputError: a run cannot be read.
    """
    return rendered(
        name="A and B, side by side",
        about=" and ".join(str(path) for path in it.paths.values()),
        summary=" ".join(findings(it)) or "There is no controller and condition that both have.",
        sections=_sections(it),
        advance=advance,
    )


def _sections(it: Tracks) -> Iterator[Section]:
    sides = Table("Folders", ("", "path"), tuple((n, str(p)) for n, p in it.paths.items()))
    printed = [Table.printed(table) for table in tables(it)]
    yield Section("sides", "What is compared", points=tuple(notes(it)), tables=(sides, *printed))
    if pictures := tuple(_pictures(it)):
        what = "Wanted less true force at the load, with the first seed of noise."
        yield Section("tracking-error", "Tracking error", (what,), pictures=pictures)
    files = tuple((n, TRACKING_FILE, digest) for n, digest in it.checksums.items())
    yield repeat_section(["tsas", "compare", *map(str, it.paths.values())], files)


def _pictures(it: Tracks) -> Iterator[Picture]:
    """Yield the errors over time of each pair whose runs have the same clock."""
    for number, both in enumerate(it.followed):
        a, b = (
            columns_of(result_file(path, result.run), ("time_s", WANTED, TRUE))
            for path, result in zip(it.paths.values(), (both.a, both.b), strict=True)
        )
        if a["time_s"].shape != b["time_s"].shape or (a["time_s"] != b["time_s"]).any():
            continue
        first, second = (side[WANTED] - side[TRUE] for side in (a, b))
        panel = Residuals("error [N]", a["time_s"], first, second, noise=None)
        words = _words(both)
        yield picture(
            partial(draw_two_residuals, panels=[panel]),
            key=f"tracked-{number}",
            alt=f"Wanted less true force at the load over time, of A and of B. {words}",
            caption=words,
            height_in=height_in(1) + 0.6,
        )


def _words(both: ControllerPair) -> str:
    a, b = (with_spread(r.scores["rmse_N"].mean, r.scores["rmse_N"].sd) for r in (both.a, both.b))
    return f"{both.a.controller}, {both.a.condition}: RMSE {a} N in A, {b} N in B."
