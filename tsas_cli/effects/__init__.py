"""Everything that makes a real rig differ from the nominal one, one file each."""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.effects.free_tendon import FREE_TENDON, FreeTendon

EFFECTS: tuple[Effect, ...] = (FREE_TENDON,)


class Effects(NamedTuple):
    """The values of every effect's parameters, neutral unless said otherwise."""

    free_tendon: FreeTendon = FreeTendon()


__all__ = ["EFFECTS", "Effect", "Effects", "FreeTendon", "Parameter"]
