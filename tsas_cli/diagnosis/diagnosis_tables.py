"""The tables that `tsas diagnose` prints."""

from typing import Any

from tsas_cli.identification.estimate import Estimate
from tsas_cli.records.result import Table

SHOWN = 8  # hypotheses that are printed
_ERRORS = ("rmse_before", "rmse_after", "noise_floor", "best_obtainable")


def tables(summary: dict[str, Any], title: str) -> list[Table]:
    """Return what is named under its title, the errors before and after, and the ranking."""
    named = [
        (
            cause["effect"],
            name,
            Estimate(
                name,
                p["value"],
                p["unit"],
                "fitted",
                None,
                p["stderr"],
                p["interval_low"],
                p["interval_high"],
                p["at_bound"],
            ).text(),
            p["unit"],
            ", ".join(cause["rivals"]),
        )
        for cause in summary["named"]
        for name, p in cause["parameters"].items()
    ]
    errors = [
        (name, *(f"{c[key]:.3g}" for key in _ERRORS), c["unit"])
        for name, c in summary["channels"].items()
    ]
    ranking = [
        (
            " + ".join(row["effects"]),
            f"{row['gain_percent']:.1f}",
            f"{row['sureness']:.1f}",
            "" if row["converged"] else "not converged",
        )
        for row in summary["candidates"][:SHOWN]
    ]
    return [
        *(
            [(title, ("effect", "parameter", "value [95 %]", "unit", "rivals"), named)]
            if named
            else []
        ),
        (
            "error on held-out data",
            ("channel", "before", "after", "noise", "obtainable", "unit"),
            errors,
        ),
        ("hypotheses", ("effects", "gain [%]", "sureness", ""), ranking),
    ]
