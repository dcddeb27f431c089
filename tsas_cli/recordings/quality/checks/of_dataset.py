"""The checks of the manifest, and of all runs beside each other."""

from collections.abc import Callable

from tsas_cli.recordings.dataset import CONDITIONS, Dataset
from tsas_cli.recordings.manifest import Manifest, RigSheet
from tsas_cli.recordings.quality.copies.search import find_copies
from tsas_cli.recordings.quality.finding import Finding, Findings, NotChecked, warning
from tsas_cli.support.errors import printable


def unknown_key(manifest: Manifest) -> Findings:
    """The manifest holds a key that format 1 does not define.

    Such a key is kept but has no effect; a misspelt key, or one of another table, loses its value.
    A run may have keys of its own, conditions that `tsas runs` finds it by.
    """
    places: dict[tuple[str, str], list[str]] = {}
    tables = [("the top", manifest), ("[rig]", manifest.rig)]
    for place, table in [*tables, *((f"run {run.id}", run) for run in manifest.run)]:
        for key, hint in table.unknown_keys().items():
            remedy = f"move it to {_TABLES[key]}" if key in _TABLES else hint
            places.setdefault((key, remedy), []).append(place)
    for (key, hint), where in places.items():
        lost = hint.startswith(("did you mean", "move it"))
        if not lost and all(place.startswith("run ") for place in where):
            continue
        yield Finding(
            "warning" if lost else "note",
            None,
            f"dataset.toml holds the unknown key {printable(key)} in {where[0]}"
            + (f" and {len(where) - 1} more" if len(where) > 1 else ""),
            hint if lost else "none, if it is a note for readers",
        )


_TABLES = dict.fromkeys(RigSheet.model_fields, "[rig]") | dict.fromkeys(
    (*CONDITIONS, "load"), "[[run]]"
)
# Key, whether a value is implausible, and its likely unit.
_Suspicions = tuple[tuple[str, Callable[[float], bool], str], ...]
_RUN: _Suspicions = (
    ("total_bend_rad", lambda v: v > 50 or (v > 6.5 and v % 5 == 0), "degree"),
    ("sheath_length_mm", lambda v: v < 5, "metre"),
    ("sheath_length_mm", lambda v: v > 5e4, "micrometre"),
)
_RIG: _Suspicions = (
    ("tendon_diameter_mm", lambda v: v < 0.02, "metre"),
    ("tendon_diameter_mm", lambda v: v > 50, "micrometre"),
    ("tendon_modulus_GPa", lambda v: 1e3 < v < 1e6, "MPa"),
    ("tendon_modulus_GPa", lambda v: v >= 1e6, "Pa"),
    ("friction_coefficient", lambda v: v > 3, "percent"),
    ("turntable_radius_mm", lambda v: v < 0.5, "metre"),
    ("turntable_radius_mm", lambda v: v > 5e3, "micrometre"),
    ("gear_ratio", lambda v: v < 0.1, "turns of the pulley for one of the motor"),
    ("inertia_N_mm_s2", lambda v: v > 1e4, "g cm²"),
    ("proximal_length_mm", lambda v: 0 < v < 0.5, "metre"),
    ("distal_length_mm", lambda v: 0 < v < 0.5, "metre"),
)


def manifest_unit(manifest: Manifest) -> Findings:
    """A value in the manifest looks as if it were in another unit than its key says.

    A bend of 180 rad is most likely 180°, a sheath of 0.8 mm most likely 0.8 m. The limits are far
    beyond plausible values; a value within them may still be wrong.
    """
    tables = [("rig.", manifest.rig.model_dump(), _RIG)]
    tables += [(f"run {run.id}: ", run.model_dump(), _RUN) for run in manifest.run]
    for place, values, suspicions in tables:
        for key, implausible, likely in suspicions:
            value = values[key]
            if value is not None and implausible(value):
                yield warning(
                    None,
                    f"dataset.toml says {place}{key} = {value:g}, which looks like {likely}",
                    f"convert the value to the unit in the key, if it is in {likely}",
                )


def copies(dataset: Dataset) -> Findings:
    """A run holds samples of another run of the dataset, which are no further evidence.

    Two runs that repeat a motion have independent noise; a copy shares it. The rows of each run are
    looked for in every other one, by the values of all channels, rounded to the coarser steps of
    the two runs: the same samples, written again, with fewer digits or at shifted times, a part of
    them, or every second or third. They have to agree for longer than a repeat of the motion could;
    constant stretches are no evidence. Runs computed without noise agree wherever their motion
    does, and are reported as copies. A copy that was filtered, scaled or interpolated between
    samples is not found. Fits count each sample once, and report it.
    """
    found = find_copies(dataset, strict=False)
    for copy in found.copies:
        yield Finding(
            "error" if copy.contradicts else "warning",
            None,
            f"{copy.sentence}{copy.contradiction}",
            "correct the conditions in dataset.toml, or leave out the wrong run"
            if copy.contradicts
            else "remove the copy, or leave it as it is: fits count each sample once",
            first_s=copy.span.begin_s,
            run=copy.run.id,
        )
    for run in found.unordered:
        yield NotChecked("time does not increase", run=run)
    for run in found.short:
        yield NotChecked("too few rows change", run=run)
