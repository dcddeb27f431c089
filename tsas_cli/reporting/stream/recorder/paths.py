"""Entities by the parts of their names."""

from collections.abc import Sequence

import rerun as rr

Entity = Sequence[str]


def path_of(entity: Entity) -> str:
    """Return the path of an entity; what a part holds that is no plain letter is escaped."""
    return rr.new_entity_path(list(entity))
