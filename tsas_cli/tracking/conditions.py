"""What is done to the plant: changes of its rig from the start, or in the middle of a run."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from tsas_cli.effects import EFFECTS
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.paper import yang2025
from tsas_cli.physics.rig import with_values
from tsas_cli.records.tracking import ConditionChange
from tsas_cli.support.errors import InputError, nearest
from tsas_cli.support.plausible import Range
from tsas_cli.tracking.settings import Settings, printed_gains
from tsas_cli.tracking.track import Plant

ALLOWED = {
    name: Range(q.lower, q.upper, q.unit)
    for name, q in QUANTITIES.items()
    if name != "x_in_zero_mm" and not name.startswith("antagonist.")  # the plant has one tendon
} | {"total_bend_rad": Range(0.0, 100.0, "rad")}
ONLY_FROM_THE_START = {
    "preload_N": "all displacements count from the preload",
    "tendon_stiffness_N": "all displacements count from the preload",
    "x_out_zero_mm": "a sensor stays as it is",
} | {
    f"{effect.name}.{p.name}": "a sensor stays as it is"
    for effect in EFFECTS
    if effect.acts_on == "sensor"
    for p in effect.parameters
}
LATEST_S = 1e6  # at which a change may begin


@dataclass(frozen=True)
class Condition:
    """A name for the table, and the changes."""

    name: str
    changes: tuple[ConditionChange, ...] = ()

    def of(self, plant: Plant) -> Plant:
        """Return the plant under this condition."""
        early = {c.quantity: c.value for c in self.changes if c.from_s <= 0.0}
        late = {c.quantity: c.value for c in self.changes if c.from_s > 0.0}
        rig = with_values(plant.rig, early)
        if not late:
            return replace(plant, rig=rig)
        change_s = next(c.from_s for c in self.changes if c.from_s > 0.0)
        return replace(plant, rig=rig, later=with_values(rig, late), change_s=change_s)


def disturbed(options: Sequence[str], where: str = "--disturb") -> Condition:
    """Return the condition that options such as `friction_coefficient=0.16@10` describe.

    InputError: one is no NAME=VALUE[@SECONDS], names an unknown quantity, has a value that is not
    allowed or given twice, or they begin at more than one time within the run.
    """
    changes = tuple(_change(option, where) for option in options)
    times = sorted({c.from_s for c in changes if c.from_s > 0.0})
    if len(times) > 1:
        raise InputError(
            f"changes begin at {', '.join(f'{t:g} s' for t in times)}",
            where=where,
            expected="one time within the run",
        )
    named = [(c.quantity, c.from_s) for c in changes]
    for name, from_s in named:
        if named.count((name, from_s)) > 1:
            raise InputError(
                f"{name} is given twice at {from_s:g} s", where=where, expected="one value"
            )
    return Condition("disturbed", changes)


def proximal_spring() -> Condition:
    """Return the disturbance of Fig. 11: a spring at the drive's end of the tendon."""
    spring = ConditionChange(
        quantity="proximal_spring.stiffness_N_per_mm",
        value=yang2025().value("reference.disturbance_stiffness"),
        from_s=0.0,
    )
    return Condition("disturbed", (spring,))


def _change(option: str, where: str) -> ConditionChange:
    name, _, rest = option.partition("=")
    number, _, moment = rest.partition("@")
    if name not in ALLOWED:
        raise InputError(f"unknown quantity {name}", where=where, remedy=nearest(name, ALLOWED))
    try:
        value, from_s = float(number), float(moment or 0.0)
    except ValueError as error:
        raise InputError(
            f"{option!r} is no change", where=where, expected="NAME=VALUE or NAME=VALUE@SECONDS"
        ) from error
    if not 0.0 <= from_s <= LATEST_S:
        raise InputError(
            f"{option!r} begins at {moment} s", where=where, expected=f"0 to {LATEST_S:g} s"
        )
    if value not in ALLOWED[name]:
        raise InputError(f"{name} of {value:g}", where=where, expected=str(ALLOWED[name]))
    if from_s > 0.0 and name in ONLY_FROM_THE_START:
        raise InputError(
            f"{name} cannot change during a run",
            where=where,
            remedy=f"leave out @{moment}: {ONLY_FROM_THE_START[name]}",
        )
    return ConditionChange(quantity=name, value=value, from_s=from_s)


def printed_rmse(
    controller: str, condition: Condition, reference: str, settings: Settings
) -> float | None:
    """Return the printed RMSE of a controller, None where anything is not the paper's.

    The gains may be read per m or per mm.
    """
    as_the_paper = reference == "sine" and settings in (Settings(), printed_gains(Settings()))
    undisturbed = not condition.changes
    if not as_the_paper or not (undisturbed or condition == proximal_spring()):
        return None
    name = "undisturbed" if undisturbed else "disturbed"
    printed = yang2025().values.get(f"tracking.{name}.rmse_{controller.replace('-', '_')}")
    return None if printed is None else printed.value
