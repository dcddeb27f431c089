"""The four groups of Fig. 4, each run with the static, the distributed and the dynamic model."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from tsas_cli.paper import Paper
from tsas_cli.physics.bristles import bristle_damping
from tsas_cli.physics.lugre.stability import FOLDS, SLOW, Stability, growth_rate, moments
from tsas_cli.physics.response import Prediction, simulate
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats
from tsas_studies.reproduction.rig import dynamic_rig, motion, quasi_static_rig, wrap_of

FINE_LUMPS = 200  # of the dynamic model that the others are held against
FINE_TOLERANCE = 1e-7  # of a step, where small differences are sought
AT_P_RAD = 0.12  # after the upper reversal: the paper marks P just behind it


@dataclass(frozen=True)
class Difference:
    """A channel of one model against another over the second period, in % of its range."""

    largest: float
    rms: float


@dataclass(frozen=True)
class Runs:
    """One group: its second period, by model, shape (n,), and what is unstable as printed.

    Models: `static`, `slip`, `dynamic` (well posed), `fine` (the same with more lumps), `printed`.
    """

    group: str
    period_s: float
    time_s: Floats
    second: npt.NDArray[np.bool_]
    sample_at_p: int
    models: dict[str, Prediction]
    unstable: tuple[Stability, ...]

    @property
    def diverging(self) -> Stability | None:
        """The fastest growth in full slip as printed, but for turns; None where it is stable."""
        turning = SLOW * max(abs(np.gradient(self.models["slip"].x_in_mm, self.time_s)))
        sliding = [
            s for s in self.unstable if s.moment.whole and abs(s.moment.speed_mm_s) > turning
        ]
        return max(sliding, key=lambda s: s.folds, default=None)

    @property
    def chattering(self) -> Stability | None:
        """The fastest growth in a dead band as printed, None where there is none."""
        bands = [s for s in self.unstable if not s.moment.whole]
        return max(bands, key=lambda s: s.folds, default=None)

    def f_in_at_p(self, model: str) -> float:
        """Return f_in at point P of the second period [N]."""
        return float(self.models[model].f_in_N[self.sample_at_p])

    def difference(
        self, model: str, other: str, channel: str, *, outside: bool = False
    ) -> Difference:
        """Return how far two models are apart in a channel, only `outside` of dead bands if asked.

        The dead bands are those of the distributed model.
        """
        one, two = (getattr(self.models[name], channel)[self.second] for name in (model, other))
        off = 100.0 * np.abs(one - two) / np.ptp(two)
        if outside:
            off = off[np.abs(self.models["slip"].phase[self.second]) == 1]
        return Difference(float(np.max(off)), float(np.sqrt(np.mean(off**2))))


def runs_of(paper: Paper, group: str) -> Runs:
    """Simulate one group with every model."""
    omega = paper.value(f"groups.{group}.angular_frequency")
    time_s, drive = motion(paper, group)
    plain = quasi_static_rig(paper, group)
    well, printed = (dynamic_rig(paper, group, as_printed=literal) for literal in (False, True))
    slip = simulate(plain, drive)
    period_s = 2.0 * math.pi / omega
    return Runs(
        group,
        period_s,
        time_s,
        time_s > period_s,
        int(np.searchsorted(time_s, 1.5 * period_s + AT_P_RAD / omega)),
        {
            "static": simulate(plain, drive, "static"),
            "slip": slip,
            "dynamic": simulate(well, drive, "lugre"),
            "fine": simulate(well, drive, "lugre", nodes=FINE_LUMPS),
            "printed": simulate(printed, drive, "lugre"),
        },
        _unstable(printed, time_s, drive.values, slip),
    )


def _unstable(rig: Rig, time_s: Floats, x_in: Floats, slip: Prediction) -> tuple[Stability, ...]:
    """Return the moments of a run at which disturbances of steady sliding grow much."""
    found = [
        Stability(growth_rate(rig, moment), moment)
        for moment in moments(rig, time_s, x_in, slip.f_in_N, slip.phase)
    ]
    return tuple(each for each in found if each.folds > FOLDS)


def effect_of_mass(paper: Paper, group: str) -> float:
    """Return by how much a tenth of the tendon's mass changes f_in at most [% of its range]."""
    _, drive = motion(paper, group)
    rig = dynamic_rig(paper, group, as_printed=False)
    limit = rig.preload_N * wrap_of(rig)
    damping = bristle_damping(rig.bristles, rig.sheath_length_mm, limit, 0.0)
    heavy = rig.bristles._replace(damping_N_s_per_mm=damping)
    light = heavy._replace(tendon_mass_kg_per_m=0.1 * heavy.tendon_mass_kg_per_m)
    one, other = (
        simulate(rig._replace(bristles=bristles), drive, "lugre", tolerance=FINE_TOLERANCE).f_in_N
        for bristles in (heavy, light)
    )
    return float(100.0 * np.max(np.abs(one - other)) / np.ptp(one))


def effect_of_speed(slow: Runs, fast: Runs) -> Difference:
    """Return how far f_in of the dynamic model is apart at two speeds [% of its range]."""
    angles = np.linspace(2.0 * math.pi, 4.0 * math.pi, 4001)[1:-1]
    one, two = (
        np.interp(angles, 2.0 * math.pi * runs.time_s / runs.period_s, runs.models["fine"].f_in_N)
        for runs in (slow, fast)
    )
    off = 100.0 * np.abs(one - two) / np.ptp(one)
    return Difference(float(np.max(off)), float(np.sqrt(np.mean(off**2))))
