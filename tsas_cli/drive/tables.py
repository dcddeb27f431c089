"""What `tsas identify-harmonic-drive` prints."""

from typing import Any

from tsas_cli.identification.estimate import Estimate
from tsas_cli.records.result import Table


def tables(summary: dict[str, Any], title: str) -> list[Table]:
    """Return the tables of the content of `drive.json`; the title is that of the parameters."""
    estimates = [Estimate(**p) for p in summary["parameters"]]
    kinematic = summary["kinematics"]
    lead = kinematic["kinematic_lead_rpm_s_per_mm"]
    rows = [(e.name, e.text(), e.unit) for e in estimates]
    if lead is not None:
        rows.append(("60 im/(2π r1), kinematic", f"{lead:.5g}", "rpm s/mm"))
    found = summary["diagnosis"]
    named = [
        (
            cause["effect"],
            name,
            Estimate(name=name, origin="fitted", **p).text(),
            p["unit"],
            f"{cause['gain_percent']:.1f}",
            ", ".join(cause["rivals"]),
        )
        for cause in found["named"]
        for name, p in cause["parameters"].items()
    ]
    error = found["channels"]["x_in_mm"]
    keys = ("rmse_before", "rmse_after", "noise_floor", "best_obtainable")
    return [
        (
            "structures of G(s), error on held-out data in times the noise",
            ("structure", "parameters", "error", ""),
            [
                (
                    s["name"],
                    str(s["parameters"]),
                    f"{s['held_out_times_noise']:.3g}",
                    "chosen" if s["chosen"] else "" if s["converged"] else "not converged",
                )
                for s in summary["structures"]
            ],
        ),
        (
            title,
            ("name", "value [95 %]", "unit"),
            rows,
        ),
        (
            "x_in against measurement [mm]",
            ("run", "RMSE", "nominal", "noise"),
            [
                (run, f"{r['rmse']:.4g}", f"{r['rmse_nominal']:.4g}", f"{r['noise']:.2g}")
                for run, r in summary["runs"].items()
            ],
        ),
        *(
            [
                (
                    "causes",
                    ("effect", "parameter", "value [95 %]", "unit", "gain [%]", "rivals"),
                    named,
                )
            ]
            if named
            else []
        ),
        (
            "error on held-out data",
            ("channel", "before", "after", "noise", "obtainable", "unit"),
            [("x_in_mm", *(f"{error[k]:.3g}" for k in keys), "mm")],
        ),
    ]
