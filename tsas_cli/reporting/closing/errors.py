"""The RMSE of every controller in every case, by the model in its inverse and feedforward."""

from collections.abc import Iterator
from functools import partial
from statistics import median

from tsas_cli.reporting.closing_file import Closing, Row
from tsas_cli.reporting.content import Picture, Table
from tsas_cli.reporting.diagnosis.words import listed
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.figures.closing import MODELS, draw_dots, height_in
from tsas_cli.reporting.numbers import plain, with_spread

NEAR = 1.1  # of the limit, and of no difference


def table(closing: Closing) -> Table:
    """Return the table, with its spread where there is more than one seed."""
    seeds = closing.seeds[1] - closing.seeds[0] + 1
    over = f", mean ± standard deviation over {seeds} seeds of noise" if seeds > 1 else ""
    rows = tuple(
        (
            case.case,
            row.controller,
            *(with_spread(rmse.mean, rmse.sd) for rmse in row.by_model.values()),
            plain(row.over_limit, 3),
        )
        for case in closing.cases
        for row in case.controllers
    )
    header = ("case", "controller", *(it.label for it in MODELS.values()), "extended / true")
    numeric = frozenset(range(2, len(header)))
    return Table(f"RMSE of the force [N] by model{over}", header, rows, numeric=numeric)


def dots(closing: Closing) -> Picture:
    """Return the picture of the same errors, one panel for each controller."""
    controllers = closing.of_controllers()
    said = "; ".join(
        f"{name}: {', '.join(_said(case, row) for case, row in rows.items())}"
        for name, rows in controllers.items()
    )
    return picture(
        partial(draw_dots, controllers=controllers),
        key="closing-rmse",
        alt="RMSE of the force in newton on a logarithmic axis, with the model of the data sheet, "
        f"calibrated, extended and true, by controller and case. {said}.",
        caption="RMSE of the force by controller, case and model, on a logarithmic axis: further "
        "left is better, and the true model is the limit.",
        height_in=height_in([len(rows) for rows in controllers.values()]),
    )


def worth(closing: Closing) -> Iterator[str]:
    """Yield, for each controller, what the extended model is worth, and where it falls short."""
    for name, rows in closing.of_controllers().items():
        yield f"`{name}`: {_gain(rows)}; {_limit(rows)}."


def most_and_least(closing: Closing) -> Iterator[str]:
    """Yield for which controller the extended model matters most, and for which least."""
    gains = {
        name: median(row.gain for row in rows.values())
        for name, rows in closing.of_controllers().items()
    }
    ranked = sorted(gains, key=lambda name: gains[name])
    if len(ranked) > 1:
        sizes = [plain(gains[name], 2) for name in (ranked[-1], ranked[0])]
        many = "in the median over the cases, " if len(closing.cases) > 1 else ""
        yield (
            f"The extended model matters most for {ranked[-1]}, least for {ranked[0]}: {many}it "
            f"divides the RMSE with the data sheet's by {sizes[0]} and {sizes[1]}."
        )


def _said(case: str, row: Row) -> str:
    return f"{case} {', '.join(plain(rmse.mean, 2) for rmse in row.by_model.values())}"


def _gain(rows: dict[str, Row]) -> str:
    """Return how much the extended model lowers the error of the data sheet's."""
    gains = [row.gain for row in rows.values()]
    middle = median(gains)
    verdict = (
        "the better model matters"
        if middle > NEAR
        else "the better model harms"
        if middle < 1.0 / NEAR
        else "the better model hardly matters"
    )
    size = f"the RMSE with the data sheet's is {plain(middle, 2)} times that with the extended"
    if len(gains) == 1:
        return f"{verdict}, {size}"
    low, high = plain(min(gains), 2), plain(max(gains), 2)
    worse = [case for case, row in rows.items() if row.gain < 1.0 / NEAR]
    but = f", but it is larger with the extended in {listed(worse)}" if worse else ""
    return f"{verdict}, {size} (median over {len(gains)} cases, {low} to {high}){but}"


def _limit(rows: dict[str, Row]) -> str:
    """Return where the extended model is not as good as the true one."""
    off = [
        f"{case} ({plain(row.over_limit, 3)} times)"
        for case, row in rows.items()
        if row.over_limit > NEAR
    ]
    percent = f"{100.0 * (NEAR - 1.0):.0f} %"
    if not off:
        return f"everywhere the extended model is within {percent} of the limit"
    return f"the extended model is more than {percent} above the limit in {listed(off)}"
