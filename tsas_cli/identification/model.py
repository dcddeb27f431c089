"""The model: estimates of the nominal rig's parameters and of the effects' parameters."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from datetime import datetime
from typing import TYPE_CHECKING

from tsas_cli.effects import EFFECTS, Effects
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.quantities import NOMINAL, QUANTITIES
from tsas_cli.physics.bristles import Bristles
from tsas_cli.physics.rig import Rig, with_values
from tsas_cli.recordings.manifest import Manifest, RigSheet, Run
from tsas_cli.recordings.session import Session
from tsas_cli.support.errors import InputError, nearest

if TYPE_CHECKING:
    import pandas as pd

CORRECTION = "preload_correction_N"  # mean of fitted minus stated preload, for other runs
MOST_WRAP = 20.0  # friction times bend; e^20 is the ratio of the tensions at the two ends
UNKNOWN_BEND_RAD = 1.0
UNKNOWN_LENGTH_MM = 1000.0


@dataclass(frozen=True)
class Model:
    """All estimates, shared or of a single run; an effect's is named effect.parameter.

    `session` is that of the recordings that the model was fitted to, where it is known.
    """

    estimates: tuple[Estimate, ...]
    session: Session | None = None

    def value(self, name: str, run: str | None = None) -> float | None:
        """Return a value for a run, else the shared one, else None."""
        known = {(e.name, e.run): e.value for e in self.estimates}
        return known.get((name, run), known.get((name, None)))

    def estimate(self, name: str, run: str | None = None) -> Estimate:
        """Return an estimate for a run, else the shared one.

        InputError: the model does not have it.
        """
        known = {(e.name, e.run): e for e in self.estimates}
        found = known.get((name, run), known.get((name, None)))
        if found is None:
            of = "" if run is None else f" of run {run}"
            raise InputError(
                f"the model has no {name}{of}",
                remedy=nearest(name, [e.name for e in self.estimates]),
            )
        return found

    def frame(self) -> "pd.DataFrame":
        """Return the estimates as a pandas table, one row each."""
        import pandas as pd

        return pd.DataFrame([asdict(estimate) for estimate in self.estimates])

    def over(self, other: "Model") -> "Model":
        """Return these estimates, and what another model has that is missing here."""
        known = {(e.name, e.run) for e in self.estimates}
        others = (e for e in other.estimates if (e.name, e.run) not in known)
        return Model((*self.estimates, *others), self.session or other.session)

    def for_runs(self, recordings: Mapping[str, str], runs: Sequence[Run]) -> "Model":
        """Return the model with those values of a single run that belong to these recordings.

        `recordings` are those that it was fitted to, as checksums by run id. Another recording of
        the same name has a preload and zeros of its own; of other runs the values stay.
        """
        heirs: dict[str, list[str]] = {run.id: [] for run in runs}
        for run in runs:
            same = {id_ for id_, digest in recordings.items() if digest == run.sha256.lower()}
            owner = run.id if run.id in same else min(same, default=None)
            if owner is not None:
                heirs.setdefault(owner, []).append(run.id)
        own = (
            replace(e, run=run)
            for e in self.estimates
            for run in ([None] if e.run is None else heirs.get(e.run, [e.run]))
        )
        return Model(tuple(own), self.session)

    def session_start(self, manifest: Manifest) -> datetime | None:
        """Return when the session began that a dataset's runs belong to, None where it is unknown.

        It is the model's where the dataset goes on with it, else that of the dataset.
        """
        start = manifest.session_start
        if start is None or self.session is None or not self.session.goes_on_at(start):
            return start
        return self.session.first

    def rig(self, run: Run) -> Rig:
        """Return the rig of a run, calibrated or not; unknown parameters have defaults.

        InputError: friction times bend is implausibly large: no tension would be transmitted.
        """
        values = {q.name: self.value(q.name, run.id) for q in NOMINAL}
        if values["preload_N"] is None and run.preload_N is not None:
            values["preload_N"] = run.preload_N + (self.value(CORRECTION) or 0.0)
        known = {name: QUANTITIES[name].default if v is None else v for name, v in values.items()}
        bend = UNKNOWN_BEND_RAD if run.total_bend_rad is None else run.total_bend_rad
        check_wrap(known["friction_coefficient"], bend, f"run {run.id}")
        nominal = Rig(
            sheath_length_mm=run.sheath_length_mm or UNKNOWN_LENGTH_MM,
            total_bend_rad=bend,
            effects=Effects(),
            bristles=Bristles(),
            **known,
        )
        further = {name: self.value(name) for name in QUANTITIES if "." in name}
        return with_values(nominal, {n: v for n, v in further.items() if v is not None})


def check_wrap(friction: float, bend: float, where: str) -> None:
    """Refuse friction over a bend [rad] that is implausibly large: InputError."""
    if friction * bend > MOST_WRAP:
        raise InputError(
            f"a friction_coefficient of {friction:.4g} over a total_bend_rad of {bend:.4g} "
            "transmits no tension",
            where=where,
            expected=f"at most {MOST_WRAP:.4g} for their product",
            remedy="is the bend in radians?",
        )


def data_sheet(manifest: Manifest) -> Model:
    """Return the model stated by the manifest, before any fit."""
    rig = manifest.rig
    stated: dict[str, float | None] = {
        "friction_coefficient": rig.friction_coefficient,
        "load_stiffness_N_per_mm": rig.load_stiffness_N_per_mm,
        "tendon_stiffness_N": _axial_stiffness(rig.tendon_diameter_mm, rig.tendon_modulus_GPa),
    }
    estimates = [_stated(name, value) for name, value in stated.items() if value is not None]
    for effect in EFFECTS:
        for p in effect.parameters:
            named = {p.name, f"{effect.name}_{p.name}"} & RigSheet.model_fields.keys()
            value = getattr(rig, named.pop()) if named else None
            if value is not None:
                estimates.append(Estimate(f"{effect.name}.{p.name}", value, p.unit, "data sheet"))
    preloads = [
        _stated("preload_N", run.preload_N, run.id)
        for run in manifest.run
        if run.preload_N is not None
    ]
    return Model((*estimates, *preloads), manifest.session)


def _stated(name: str, value: float, run: str | None = None) -> Estimate:
    return Estimate(name, value, QUANTITIES[name].unit, "data sheet", run)


def _axial_stiffness(diameter_mm: float | None, modulus_GPa: float | None) -> float | None:
    if diameter_mm is None or modulus_GPa is None:
        return None
    return 1e3 * modulus_GPa * math.pi / 4.0 * diameter_mm**2
