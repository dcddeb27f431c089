"""The RMSE of both sides per run and channel, and on held-out data where both are diagnoses."""

from tsas_cli.comparing.compare import Comparison
from tsas_cli.comparing.stage import fitted_to, held_out
from tsas_cli.records.comparison import shared_name
from tsas_cli.reporting.content import Section, Table
from tsas_cli.reporting.numbers import ABSENT, plain

_RATIO = "A ratio below 1 means that B is nearer to the measurement than A."


def section(it: Comparison) -> Section:
    """Return the section of the errors."""
    if it.on is not None:
        own = " Each run's own preload and zeros are fitted to it first." if it.own_fitted else ""
        how = f"Both models are simulated on the recordings of {it.on.manifest.name}.{own}"
    else:
        how = "Each side is held to the recordings that it has read."
    return Section(
        "errors",
        "Errors per run",
        (how, *((_RATIO,) if it.shared else ())),
        tables=(_table(it), *_held_out(it)),
    )


def _table(it: Comparison) -> Table:
    rows = tuple(
        (
            shared_name(row.run_a, row.run_b),
            row.channel,
            plain(row.rmse_a, 3),
            plain(row.rmse_b, 3),
            plain(row.ratio, 3),
            plain(row.noise, 2),
            row.unit,
            fitted_to(row.fitted_a, row.fitted_b) or ABSENT,
        )
        for row in it.errors
    )
    header = ("run", "channel", "RMSE of A", "RMSE of B", "B / A", "noise", "unit", "fitted to it")
    caption = "Measured against simulated"
    return Table(caption, header, rows, numeric=frozenset(range(2, 6))).without_empty()


def _held_out(it: Comparison) -> tuple[Table, ...]:
    rows = tuple(
        (
            row.channel,
            *(plain(v, 3) for v in (row.rmse_a, row.noise_a, row.rmse_b, row.noise_b)),
            row.unit,
        )
        for row in held_out(it)
    )
    header = ("channel", "RMSE of A", "noise floor of A", "RMSE of B", "noise floor of B", "unit")
    caption = "Errors on held-out data, each on its own recordings, with what is named"
    return (Table(caption, header, rows, numeric=frozenset(range(1, 5))),) if rows else ()
