"""The page of `tsas compare`: what differs, how sure that is, and where it shows.

It is of two models, or of two folders of tracked runs.
"""

import shlex
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from tsas_cli.comparing import tracked
from tsas_cli.comparing.compare import Comparison
from tsas_cli.comparing.predictions import Both, channels
from tsas_cli.comparing.stage import differs, record_of, tables
from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.recordings.writing import columns_of, result_file
from tsas_cli.records.comparison import ComparisonFile, ModelComparison, ParameterPair, shared_name
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.content import Picture, Section, pictures_by_run, rendered, table_of
from tsas_cli.reporting.diagnosis.maps import Panel, pictures
from tsas_cli.reporting.drawing import Residuals, legend, picture, stacked, two_residuals
from tsas_cli.reporting.names import quantity_of
from tsas_cli.reporting.numbers import plain, with_spread
from tsas_cli.reporting.tracking.runs import TRUE, WANTED

_MOST = 8  # strips of a picture
_SAID = 5  # findings that stand in the summary
_VALUES = (
    "B − A has a 95 % interval where both values were fitted, to different recordings: it goes as "
    "far as the two intervals in quadrature, each side on its own. Where it does not hold 0, the "
    "difference is more than the uncertainty of both."
)


def comparison_page(it: Comparison, advance: Callable[[], None] = lambda: None) -> str:
    """Return the whole page as HTML; `advance` is called after each section."""
    record = record_of(it)
    return rendered(
        name="A and B, side by side",
        about=f"{it.a.path} and {it.b.path}",
        summary=" ".join(record.findings[:_SAID]) or "There is nothing that both sides hold.",
        sections=_sections(it, record),
        advance=advance,
    )


def _sections(it: Comparison, record: ModelComparison) -> Iterator[Section]:
    printed = {table[0]: table_of(*table) for table in tables(record)}
    points = (*record.findings[_SAID:], *record.notes)
    yield Section("sides", "What is compared", points=points, tables=(printed["sides"],))
    if "parameters" in printed:
        shown = tuple(_value_pictures(it))
        how = (_VALUES,) if it.tested else ()
        yield Section("values", "Values", how, tables=(printed["parameters"],), pictures=shown)
    if "effects" in printed:
        reasons = {"A": record.a.reason, "B": record.b.reason}
        verdicts = tuple(f"{name}: {reason}" for name, reason in reasons.items() if reason)
        yield Section("effects", "Effects", verdicts, tables=(printed["effects"],))
    if errors := tuple(table for name, table in printed.items() if name.startswith("error")):
        held = "Each side is held to the recordings that it has read."
        if record.on is not None:
            held = f"Both models are simulated on the recordings of {record.on.name}."
        ratio = "A ratio below 1 means that B is nearer to the measurement than A."
        yield Section(
            "errors", "Errors per run", (held, ratio)[: 1 + bool(it.shared)], tables=errors
        )
    if it.maps:
        yield _maps(it)
    if it.shared:
        yield _residuals(it)
    options: list[str] = []
    if it.on is not None:
        options = ["--on", str(it.on.folder)]
        if it.on.chosen is not None:
            options += ["--runs", ",".join(it.on.chosen)]
    yield _repeat(record, {} if record.on is None else record.on.hashes, options)


def _repeat(
    record: ComparisonFile, on: Mapping[str, str] = {}, options: Sequence[str] = ()
) -> Section:
    """Return the command that makes the page, and the checksums of what both sides read."""
    sides = {"A": record.a, "B": record.b}
    files = [(name, *read) for name, side in sides.items() for read in side.files.items()]
    files += [("", *read) for read in on.items()]
    command = ["tsas", "compare", record.a.path, record.b.path, *options, "--out", "compared"]
    return Section(
        "repeat",
        "How to repeat it",
        ("This command makes the same page from the same files.",),
        tables=(table_of("Files read", ("side", "file", "SHA-256"), files),),
        commands=(shlex.join(command),),
    )


_MAPS = (
    "Measured minus simulated in units of the channel's noise, in the same bins for both: the mean "
    "in each, and bars of one standard deviation. Noise alone has its mean at zero and bars as "
    "long as the band."
)
_OWN = "No recording is in both, so that each side is shown on its own recordings."
_NOTHING = "Over no signal does the error of either side stand out of the noise."


def _maps(it: Comparison) -> Section:
    panels = [
        Panel(channel, signal, bins, it.maps["b"][channel][signal])
        for channel, signals in it.maps["a"].items()
        for signal, bins in signals.items()
    ]
    shown = pictures(panels, key="map", names=("A", "B"))
    intro = (_MAPS if shown else _NOTHING,) if it.shared else (_OWN, _MAPS if shown else _NOTHING)
    return Section("maps", "Where the errors are", intro, pictures=shown)


def _residuals(it: Comparison) -> Section:
    """Return the section of the residuals, one group per run that both predict."""
    groups, left = pictures_by_run(
        len(it.shared),
        ((shared_name(*both.ids), _pictures(both, n)) for n, both in enumerate(it.shared)),
    )
    what = "Measured minus simulated. Noise alone leaves 95 % between the dashed lines."
    return Section("residuals", "Residuals over time", (what, *left), groups=groups)


def _pictures(both: Both, number: int) -> Iterator[Picture]:
    """Yield the picture of a run's residuals, a panel for each channel that both predict."""
    a, b = both.a, both.b
    if a is None or b is None:
        return
    panels, sizes = [], []
    for name in channels(both):
        errors = a.errors.get(name), b.errors.get(name)
        if any(error is None or not np.isfinite(error).any() for error in errors):
            continue
        unit = BY_NAME[name].unit
        label = f"{quantity_of(name)} [{unit}]"
        time_s, noise = a.run.time_s, a.noise(name)
        panels.append(Residuals(label, time_s, a.errors[name], b.errors[name], noise))
        sizes.append(f"{name} A {plain(a.rmse(name), 3)}, B {plain(b.rmse(name), 3)} {unit}")
    if panels:
        rmse = "; ".join(sizes)
        yield two_residuals(
            panels,
            key=f"residuals-{number}",
            alt=f"Run {shared_name(*both.ids)}: measured minus simulated over time, of A and of B. "
            f"Root mean square: {rmse}.",
            caption=f"RMSE: {rmse}.",
        )


def _value_pictures(it: Comparison) -> Iterator[Picture]:
    """Yield the picture of fitted values, differing ones first, those of single runs last."""
    shown = [p for p in it.pairs if p.a and p.b and "fitted" in (p.a.origin, p.b.origin)]
    shown.sort(key=lambda pair: (pair not in it.differing, pair.run != "all"))
    strips = shown[:_MOST]
    if not strips:
        return
    values = "; ".join(
        f"{_label(pair)}: A {plain(pair.a.value)}, B {plain(pair.b.value)}"
        f"{', which differs' if differs(pair) == 'yes' else ''}"
        for pair in strips
        if pair.a and pair.b
    )
    star = " A star marks a difference beyond both uncertainties." if it.tested else ""
    yield picture(
        partial(_draw_values, strips=strips),
        key="values",
        alt=f"Values of A and B with 95 % intervals, each on its own axis. {values}.",
        caption=f"Values of A and B with their 95 % intervals, each on its own axis.{star}",
        height_in=0.5 + 0.72 * len(strips),
    )


def _label(pair: ParameterPair) -> str:
    return pair.name.rpartition(".")[2] + ("" if pair.run == "all" else f"\nrun {pair.run}")


def _draw_values(figure: Any, strips: Sequence[ParameterPair]) -> None:
    """Draw the strips below each other, A above B in each; a star marks those that differ."""
    look = {"marker": "o", "markersize": 5, "capsize": 3, "elinewidth": 1.6, "linestyle": "none"}
    rows = stacked(figure, len(strips))
    for axes, pair in zip(rows, strips, strict=True):
        for name, side, role, y in (("A", pair.a, "before", 1.0), ("B", pair.b, "after", 0.0)):
            if side is not None and side.value is not None:
                ends = side.interval_low, side.interval_high
                low, high = (side.value if end is None else end for end in ends)
                reach = [[side.value - low], [high - side.value]]
                style = {"color": STAND_IN[role], "label": name, **look}
                axes.errorbar(side.value, y, xerr=reach, **style)
        axes.set(ylim=(-0.6, 1.6), yticks=[])
        axes.margins(x=0.08)
        axes.locator_params(axis="x", nbins=4)
        axes.ticklabel_format(axis="x", useOffset=False)
        star = " *" if differs(pair) == "yes" else ""
        axes.set_ylabel(_label(pair) + star, rotation=0, ha="right", va="center")
        axes.spines["left"].set_visible(False)
    legend(figure, rows[0])


def tracked_page(it: tracked.Tracks, advance: Callable[[], None] = lambda: None) -> str:
    """Return the whole page as HTML; `advance` is called after each section.

    InputError: a run cannot be read.
    """
    return rendered(
        name="A and B, side by side",
        about=" and ".join(str(path) for path in it.paths.values()),
        summary=" ".join(it.record.findings)
        or "There is no controller and condition that both have.",
        sections=_tracked_sections(it),
        advance=advance,
    )


def _tracked_sections(it: tracked.Tracks) -> Iterator[Section]:
    sides = table_of("Folders", ("", "path"), [(n, str(p)) for n, p in it.paths.items()])
    printed = [table_of(*table) for table in tracked.tables(it.record)]
    yield Section("sides", "What is compared", points=it.record.notes, tables=(sides, *printed))
    if pictures := tuple(_error_pictures(it)):
        what = "Wanted less true force at the load, with the first seed of noise."
        yield Section("tracking-error", "Tracking error", (what,), pictures=pictures)
    yield _repeat(it.record)


def _error_pictures(it: tracked.Tracks) -> Iterator[Picture]:
    """Yield the errors over time of each pair whose runs have the same clock."""
    for number, results in enumerate(it.followed):
        a, b = (
            columns_of(result_file(path, result.run), ("time_s", WANTED, TRUE))
            for path, result in zip(it.paths.values(), results, strict=True)
        )
        if a["time_s"].shape != b["time_s"].shape or (a["time_s"] != b["time_s"]).any():
            continue
        first, second = (side[WANTED] - side[TRUE] for side in (a, b))
        panel = Residuals("error [N]", a["time_s"], first, second, noise=None)
        in_a, in_b = (with_spread(result.scores.rmse_N) for result in results)
        which = f"{results[0].controller}, {results[0].condition}"
        words = f"{which}: RMSE {in_a} N in A, {in_b} N in B."
        yield two_residuals(
            [panel],
            key=f"tracked-{number}",
            alt=f"Wanted less true force at the load over time, of A and of B. {words}",
            caption=words,
        )
