"""Fig. 4: input tension and output displacement of groups a to d, and what the text says of them.

The figure prints curves and no numbers, and the recordings are not public: what can be judged are
the statements about the models.
"""

from dataclasses import replace

import numpy as np

from tsas_cli.paper import Paper
from tsas_cli.support.arrays import Floats
from tsas_studies.reproduction.fig_4_runs import (
    AT_P_RAD,
    Runs,
    effect_of_mass,
    effect_of_speed,
    runs_of,
)
from tsas_studies.reproduction.group import Figure, Group, Line, Role, Row
from tsas_studies.reproduction.rig import GROUPS
from tsas_studies.reproduction.verdicts import holds, undetermined

SIMILAR_PERCENT = 5.0  # of a channel's range
LITTLE_PERCENT = 1.0
MODELS: dict[str, tuple[str, Role]] = {
    "static": ("static", "before"),
    "slip": ("distributed", "after"),
    "dynamic": ("dynamic", "simulated"),
    "printed": ("dynamic as printed", "alike"),
}
_MODELS = (
    "Each group of Table 2 runs with Eqs. (4) to (9) (static: one straight line through each dead "
    "band), the same friction spread along the sheath (distributed), and Eqs. (10) to (21): well "
    "posed, with critically damped bristles, and as printed where that has a solution."
)
_DIFFERENCES = (
    "Differences are those of the second period, from the well posed model, in percent of the "
    f"channel's range. P is {AT_P_RAD:g} rad after the upper reversal."
)
_MEASURED = (
    "The measured curves of Fig. 4 cannot be held against ours: the authors give the recordings on "
    "request."
)
AROUND_P_RAD = (-0.1, 0.5)  # of the drive's phase since the upper reversal


def fig_4(paper: Paper) -> Group:
    """Return the four groups by every model, and what of the text about them holds."""
    groups = [runs_of(paper, name) for name in GROUPS]
    rows = [row for runs in groups for row in _rows(runs)]
    return Group(
        "fig-4",
        "Fig. 4: static and dynamic model",
        (_MODELS, _DIFFERENCES),
        (*rows, *_statements(paper, groups)),
        tuple(figure for runs in groups for figure in _figures(runs)),
        (_MEASURED,),
    )


def _rows(runs: Runs) -> list[Row]:
    name = f"Group {runs.group}"
    f_in = runs.difference("static", "fine", "f_in_N")
    outside = runs.difference("static", "fine", "f_in_N", outside=True)
    x_out = runs.difference("static", "fine", "x_out_mm")
    slip = runs.difference("slip", "fine", "f_in_N")
    at_p = {MODELS[model][0]: runs.f_in_at_p(model) for model in MODELS if _shown(runs, model)}
    return [
        holds(
            f"{name}: static and dynamic model give a similar x_out",
            "text, Model validation",
            true=x_out.largest <= LITTLE_PERCENT,
            criterion=f"within {LITTLE_PERCENT:g} % of the range",
            unit="%",
            ours=x_out.largest,
            because=f"they are up to {x_out.largest:.2g} % of the range apart",
            evidence=f"x_out, and f_out with it: {x_out.largest:.2g} % at most, "
            f"{x_out.rms:.2g} % rms.",
        ),
        holds(
            f"{name}: static and dynamic model give a similar f_in",
            "text, Model validation",
            true=f_in.largest <= SIMILAR_PERCENT,
            criterion=f"within {SIMILAR_PERCENT:g} % of the range",
            unit="%",
            ours=f_in.largest,
            because="in the dead bands the tension is curved where the static model has a straight "
            f"line; outside of them the two are {outside.rms:.2g} % apart (rms)",
            evidence=f"Static {f_in.largest:.3g} % at most, {f_in.rms:.2g} % rms; distributed, "
            f"which has no dynamics either, {slip.largest:.2g} % and {slip.rms:.2g} %.",
        ),
        _literal(runs),
        undetermined(
            f"{name}: f_in at P",
            "Fig. 4",
            unit="N",
            ours=at_p["dynamic"],
            because="the figure prints no number",
            evidence="Models: "
            + ", ".join(f"{label} {value:.1f} N" for label, value in at_p.items())
            + ".",
        ),
    ]


def _shown(runs: Runs, model: str) -> bool:
    return model != "printed" or runs.diverging is None


def _literal(runs: Runs) -> Row:
    """Judge whether Eqs. (10) to (21) with Table 1 have the solution that the figure shows.

    Where the whole tendon slides unstably there is none; bristles that chatter in a dead band leave
    the rest of the curve as it is.
    """
    growing, chatter = runs.diverging, runs.chattering
    off = runs.difference("printed", "fine", "f_in_N")
    evidence = (
        f"Solved with long steps, which hide it, f_in is {off.largest:.2g} % at most and "
        f"{off.rms:.2g} % rms away from the well posed model."
    )
    if chatter is not None:
        evidence += (
            f" In the dead band of loosening disturbances grow by {chatter.growth_per_s:,.0f}/s: "
            "bristles chatter there."
        )
    because = ""
    if growing is not None:
        because = (
            f"contraction at {growing.moment.speed_mm_s:.1f} mm/s and f_in = "
            f"{growing.moment.f_in_N:.0f} N is unstable: a disturbance grows by "
            f"{growing.growth_per_s:.0f}/s"
        )
    return holds(
        f"Group {runs.group}: steady sliding is stable in the dynamic model as printed",
        "Fig. 4, Table 1",
        true=growing is None,
        criterion="wherever the whole tendon slides",
        because=because,
        evidence=evidence,
    )


def _statements(paper: Paper, groups: list[Runs]) -> list[Row]:
    mass = effect_of_mass(paper, "a")
    speed = effect_of_speed(groups[0], groups[1])
    static = groups[0].difference("static", "fine", "f_in_N")
    outside = groups[0].difference("static", "fine", "f_in_N", outside=True)
    at_p = {model: groups[0].f_in_at_p(model) for model in ("static", "slip", "dynamic")}
    causes = (("the tendon is light", mass), ("motion is slow", speed.largest))
    evidence = (
        f"A tenth of the mass changes f_in of group a by {mass:.2g} %; group b, twice as fast, "
        f"differs by {speed.largest:.2g} % at most, {speed.rms:.2g} % rms. Static and dynamic are "
        f"{static.largest:.3g} % apart all the same, {outside.largest:.2g} % outside of the dead "
        "bands."
    )
    return [
        *(
            holds(
                f"Dynamics add little because {cause}",
                "text, Model validation",
                true=size <= LITTLE_PERCENT,
                criterion=f"within {LITTLE_PERCENT:g} % of the range of f_in",
                unit="%",
                ours=size,
                because=f"f_in changes by {size:.2g} %",
                evidence=evidence,
            )
            for cause, size in causes
        ),
        undetermined(
            "The improved dynamic model is more accurate than the existing one, at P above all",
            "text, Model validation",
            because="neither the existing model's constants nor the measured curves are printed",
            evidence=f"Group a at P: static {at_p['static']:.1f}, dynamic {at_p['dynamic']:.1f} N. "
            f"Friction spread along the sheath alone gives {at_p['slip']:.1f} N; bristles and mass "
            f"add {at_p['dynamic'] - at_p['slip']:.1f} N.",
        ),
    ]


def _figures(runs: Runs) -> list[Figure]:
    part, name = f"Group {runs.group}", f"fig-4-{runs.group}"
    shown = [model for model in MODELS if _shown(runs, model)]
    time_s, second = runs.time_s, runs.second
    angle = 2.0 * np.pi * (time_s / runs.period_s - 1.5)
    around = second & (angle > AROUND_P_RAD[0]) & (angle < AROUND_P_RAD[1])

    def line(model: str, x: Floats, y: Floats) -> Line:
        label, role = MODELS[model]
        return Line(label, x, y, role, dashed=model == "printed")

    def lines(channel: str) -> tuple[Line, ...]:
        found = {model: runs.models[model] for model in ("static", "slip", "dynamic")}
        return tuple(
            line(model, it.x_in_mm[second], getattr(it, channel)[second])
            for model, it in found.items()
        )

    since_s = time_s - 1.5 * runs.period_s
    near_P = (line(n, since_s[around], runs.models[n].f_in_N[around]) for n in shown)
    at_p, value = since_s[[runs.sample_at_p]], np.array([runs.f_in_at_p("dynamic")])
    return [
        Figure(
            f"{name}-f-in",
            "Tension at the drive, second period.",
            ("x_in [mm]", "f_in [N]"),
            lines("f_in_N"),
            part,
        ),
        Figure(
            f"{name}-p",
            "The same just after the upper reversal, with point P.",
            ("time since the reversal [s]", "f_in [N]"),
            (*near_P, Line("P", at_p, value, "ink", mark="o")),
            part,
        ),
        Figure(
            f"{name}-x-out",
            "Displacement of the load; the three models lie on each other.",
            ("x_in [mm]", "x_out [mm]"),
            lines("x_out_mm"),
            part,
        ),
        Figure(
            f"{name}-lost",
            "Displacement that the load lacks.",
            ("x_in [mm]", "x_in − x_out [mm]"),
            tuple(replace(one, y=one.x - one.y) for one in lines("x_out_mm")),
            part,
        ),
    ]
