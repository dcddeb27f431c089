"""Numbers printed by Yang et al. 2025, from `values.toml`, each with its unit and its source."""

import math
import tomllib
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from types import MappingProxyType

from tsas_cli.support.files import Raw


@dataclass(frozen=True)
class Printed:
    """One number as it is printed; `source` is the table, figure, equation or section."""

    value: float
    unit: str
    source: str
    note: str = ""

    @property
    def half_a_digit(self) -> float:
        """Half a unit of the last printed digit, trailing zeros not counted."""
        mantissa, _, exponent = repr(self.value).partition("e")
        decimals = len(mantissa.partition(".")[2].rstrip("0"))
        return 0.5 * 10.0 ** (int(exponent or 0) - decimals)


@dataclass(frozen=True)
class Paper:
    """All printed numbers by name: `rig.preload`, `groups.a.angular_frequency`."""

    citation: MappingProxyType[str, str]
    values: MappingProxyType[str, Printed]

    def __getitem__(self, name: str) -> Printed:
        """Return a printed number."""
        return self.values[name]

    def value(self, name: str) -> float:
        """Return a number in its printed unit, an angle in rad."""
        printed = self.values[name]
        return printed.value * (math.pi if printed.unit == "pi rad" else 1.0)

    def with_value(self, name: str, value: float) -> "Paper":
        """Return a copy of the paper with one number replaced."""
        changed = dict(self.values) | {name: replace(self.values[name], value=value)}
        return replace(self, values=MappingProxyType(changed))


@cache
def yang2025() -> Paper:
    """Return the numbers that are shipped with the package."""
    text = files(__package__).joinpath("values.toml").read_text(encoding="utf-8")
    content = tomllib.loads(text)
    citation = MappingProxyType(content.pop("citation"))
    return Paper(citation, MappingProxyType(dict(_leaves(content, ""))))


def _leaves(content: Raw, path: str) -> list[tuple[str, Printed]]:
    found = []
    for key, entry in content.items():
        if "value" in entry:
            found.append((path + key, Printed(**entry)))
        else:
            found += _leaves(entry, f"{path}{key}.")
    return found
