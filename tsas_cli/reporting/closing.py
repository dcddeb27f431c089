"""What a diagnosis is worth in tracking: hidden differences, named, and the RMSE by model."""

from collections.abc import Iterator, Mapping
from functools import partial
from statistics import median
from typing import Any

from tsas_cli.records.closing import ClosedCase, ClosingFile, Row
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.content import Picture, Section, Table, table_of
from tsas_cli.reporting.drawing import legend, picture, stacked
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import as_printed, over_seeds, plain, with_spread
from tsas_cli.support.wording import listed

_HOW = (
    "A plant differs from what the controller knows. It is recorded while it tracks with the model "
    "of the data sheet, calibrated and diagnosed from these recordings alone, and tracks a "
    "reference with four models in inverse and feedforward."
)
_SHARED = (
    "All is simulated, and the plant is made of the same laws as the models: a wrong law would go "
    "unseen here. The blind benchmark has a rig of its own for that."
)
_LIMIT = (
    "The limit is the plant's own model. It is no lower bound: a wrong model may happen to cancel "
    "a part of what the controller itself leaves, so that extended / true can be below 1. Where "
    "nothing is named, the extended model is the calibrated one."
)
NEAR = 1.1  # a ratio that is no more than this, up or down, makes no difference
_PERCENT = f"{100.0 * (NEAR - 1.0):.0f} %"


MODELS = {  # by role: name, and form and size of the mark, so that colour alone tells nothing
    "data-sheet": ("data sheet", "s", 6.0),
    "calibrated": ("calibrated", "D", 5.5),
    "extended": ("extended", "o", 6.0),
    "true": ("true", "|", 13.0),
}
_ROW_IN = 0.21
_PANEL_IN = 0.34  # its title


def table(closing: ClosingFile) -> Table:
    """Return the table, with its spread where there is more than one seed."""
    rows = tuple(
        (
            case.case,
            row.controller,
            *map(with_spread, row.by_model.values()),
            plain(row.over_limit, 3),
        )
        for case in closing.cases
        for row in case.controllers
    )
    header = ("case", "controller", *(name for name, _, _ in MODELS.values()), "extended / true")
    return table_of(f"RMSE of the force [N] by model{over_seeds(*closing.seeds)}", header, rows)


def dots(closing: ClosingFile) -> Picture:
    """Return the picture of the same errors, one panel for each controller."""
    controllers = closing.of_controllers()
    sizes = {
        name: ", ".join(
            f"{case} {', '.join(plain(rmse.mean, 2) for rmse in row.by_model.values())}"
            for case, row in rows.items()
        )
        for name, rows in controllers.items()
    }
    errors = "; ".join(f"{name}: {by_case}" for name, by_case in sizes.items())
    return picture(
        partial(draw_dots, controllers=controllers),
        key="closing-rmse",
        alt="RMSE of the force in newton on a logarithmic axis, with the model of the data sheet, "
        f"calibrated, extended and true, by controller and case. {errors}.",
        caption="RMSE of the force by controller, case and model, on a logarithmic axis: further "
        "left is better, and the true model is the limit.",
        height_in=1.0 + sum(_PANEL_IN + _ROW_IN * len(rows) for rows in controllers.values()),
    )


def worth(closing: ClosingFile) -> Iterator[str]:
    """Yield, for each controller, what the extended model is worth, and where it falls short."""
    for name, rows in closing.of_controllers().items():
        yield f"`{name}`: {_gain(rows)} {_limit(rows)}"


def _gain(rows: dict[str, Row]) -> str:
    """Return in sentences how much the extended model lowers the error of the data sheet's."""
    middle = median(row.gain for row in rows.values())
    matters = "hardly matters" if middle > 1.0 / NEAR else "does harm"
    if middle > NEAR:
        matters = "matters"
    sentence = f"the better model {matters}. RMSE data sheet / extended is {plain(middle, 2)}"
    if len(rows) == 1:
        return f"{sentence}."
    gains = {case: row.gain for case, row in rows.items()}
    low, high = plain(min(gains.values()), 2), plain(max(gains.values()), 2)
    worse = [f"{case} ({plain(gain, 2)})" for case, gain in gains.items() if gain < 1.0 / NEAR]
    but = f"; the data sheet's is better by more than {_PERCENT} in {listed(worse)}"
    return f"{sentence} (median of {len(rows)} cases, {low} to {high}){but if worse else ''}."


def _limit(rows: dict[str, Row]) -> str:
    """Return in a sentence where the extended model is not as good as the true one."""
    off = [
        f"{case} ({plain(row.over_limit, 3)} times)"
        for case, row in rows.items()
        if row.over_limit > NEAR
    ]
    if off:
        return f"The extended model is more than {_PERCENT} above the limit in {listed(off)}."
    where = "in every case " if len(rows) > 1 else ""
    return f"The extended model is {where}within {_PERCENT} of the limit, or better."


def draw_dots(figure: Any, *, controllers: Mapping[str, Mapping[str, Row]]) -> None:
    """Draw the panels below each other, over one logarithmic axis.

    `controllers` has the RMSE with each model by controller and case.
    """
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    heights = [len(rows) + 0.2 for rows in controllers.values()]
    panels = stacked(figure, len(controllers), sharex=True, height_ratios=heights)
    for axes, (name, rows) in zip(panels, controllers.items(), strict=True):
        _draw_panel(axes, rows)
        axes.set_title(name, loc="left", fontsize=9.0, pad=3.0)
    last = panels[-1]
    last.set_xscale("log")
    last.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    last.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    last.xaxis.set_minor_formatter(NullFormatter())
    last.set_xlabel("RMSE of the force [N]")
    legend(figure, last, ncols=len(MODELS), handlelength=1.0)


def _draw_panel(axes: Any, rows: Mapping[str, Row]) -> None:
    places = range(len(rows))
    for place, row in zip(places, rows.values(), strict=True):
        means = [rmse.mean for rmse in row.by_model.values()]
        ends = [min(means), max(means)]
        axes.plot(ends, [place, place], color=STAND_IN["line"], linewidth=3.0, zorder=1)
    for role, (name, marker, size) in MODELS.items():
        axes.plot(
            [row.by_model[role].mean for row in rows.values()],
            places,
            linestyle="none",
            marker=marker,
            markersize=size,
            markeredgewidth=1.6,
            markerfacecolor=STAND_IN[role] if role == "extended" else "none",
            color=STAND_IN[role],
            label=name,
            zorder=2 if role == "true" else 3,
        )
    axes.set_yticks(places, list(rows))
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.tick_params(axis="y", length=0)


def section(inputs: Inputs) -> Section | None:
    """Return the section, None where no loop was closed over a diagnosis."""
    closing = inputs.get(ClosingFile)
    if closing is None:
        return None
    return Section(
        "closing",
        "Does a better model track better?",
        (_HOW, _SHARED),
        tables=(
            table_of(
                "What was hidden in the plant, and what the diagnosis named",
                ("case", "what differs", "hidden", "verdict", "named"),
                map(_case, closing.cases),
            ),
        ),
        parts=(
            Section(
                "closing-rmse",
                "RMSE by model",
                (_LIMIT,),
                points=tuple(worth(closing)),
                pictures=(dots(closing),),
            ),
            Section("closing-table", "The same errors in numbers", tables=(table(closing),)),
        ),
    )


def _case(case: ClosedCase) -> tuple[str, ...]:
    hidden = (f"`{name}` = {as_printed(value)}" for name, value in case.hidden.items())
    named = (" or ".join(f"`{name}`" for name in (it.effect, *it.rivals)) for it in case.named)
    return case.case, case.title, ", ".join(hidden), case.verdict, ", ".join(named) or "nothing"
