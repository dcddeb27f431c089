"""A value in the manifest looks as if it were in another unit than its key says.

A bend of 180 rad is most likely 180°, a sheath of 0.8 mm most likely 0.8 m. The limits are far
beyond plausible values; a value within them may still be wrong.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple

from tsas_cli.recordings.manifest import Manifest
from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark


class _Suspicion(NamedTuple):
    key: str
    implausible: Callable[[float], bool]
    likely: str


_Suspicions = tuple[_Suspicion, ...]
_RUN: _Suspicions = (
    _Suspicion("total_bend_rad", lambda v: v > 50 or (v > 6.5 and v % 5 == 0), "degree"),
    _Suspicion("sheath_length_mm", lambda v: v < 5, "metre"),
    _Suspicion("sheath_length_mm", lambda v: v > 5e4, "micrometre"),
)
_RIG: _Suspicions = (
    _Suspicion("tendon_diameter_mm", lambda v: v < 0.02, "metre"),
    _Suspicion("tendon_diameter_mm", lambda v: v > 50, "micrometre"),
    _Suspicion("tendon_modulus_GPa", lambda v: 1e3 < v < 1e6, "MPa"),
    _Suspicion("tendon_modulus_GPa", lambda v: v >= 1e6, "Pa"),
    _Suspicion("friction_coefficient", lambda v: v > 3, "percent"),
    _Suspicion("proximal_length_mm", lambda v: 0 < v < 0.5, "metre"),
    _Suspicion("distal_length_mm", lambda v: 0 < v < 0.5, "metre"),
)


def find(manifest: Manifest) -> Iterator[Remark | CannotTell]:
    """Yield the values that are implausible in the unit of their key."""
    tables = [("rig.", manifest.rig.model_dump(), _RIG)]
    tables += [(f"run {run.id}: ", run.model_dump(), _RUN) for run in manifest.run]
    for place, values, suspicions in tables:
        for key, implausible, likely in suspicions:
            value = values[key]
            if value is not None and implausible(value):
                yield Remark(
                    "warning",
                    f"dataset.toml says {place}{key} = {value:g}, which looks like {likely}",
                    f"convert the value to the unit in the key, if it is in {likely}",
                )


CHECK = QualityCheck("manifest-unit", find)
