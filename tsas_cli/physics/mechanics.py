"""A rig without what its sensors do: rigs that differ in readings alone have one solution."""

from functools import cache

from tsas_cli.effects import EFFECTS, Effects
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.rig import Rig

READ = (*(e.name for e in EFFECTS if e.acts_on == "sensor"), "drive_law", "load_law")
_NEUTRAL_READ = {name: getattr(Effects(), name) for name in READ}
_CHANNELS = ("f_in_", "f_out_", "x_out_")
_PRESCRIBED = {"force": "f_out_", "displacement": "x_out_"}  # the sensor's channel, by the load
_OF_X_OUT = "position_sensor_ripple"  # whose parameters do not begin with the channel


def mechanics_of(rig: Rig, drive: DriveInput) -> Rig:
    """Return the rig with perfect sensors, but for the one whose readings determine the motion.

    Both rigs have the same solution of a run. A start and a drive by force need every sensor.
    """
    if drive.kind != "displacement" or drive.start_f_in_N is not None:
        return rig
    known = _neutral_read(drive.load)
    effects = {n: getattr(rig.effects, n)._replace(**fields) for n, fields in known.items()}
    zero = rig.x_out_zero_mm if drive.load == "displacement" else 0.0
    return rig._replace(effects=rig.effects._replace(**effects), x_out_zero_mm=zero)


@cache
def _neutral_read(load: str) -> dict[str, dict[str, float]]:
    """Return the neutral parameters of each effect that do not determine a motion with a load."""
    given, out = _PRESCRIBED.get(load), {}
    others = tuple(channel for channel in _CHANNELS if channel != given)
    for name, neutral in _NEUTRAL_READ.items():
        fields = neutral._asdict()
        determines = given is not None and (
            any(field.startswith(given) for field in fields)
            or (given == "x_out_" and name == _OF_X_OUT)
        )
        out[name] = {f: v for f, v in fields.items() if not determines or f.startswith(others)}
    return out
