"""Entities by the parts of their names, and what a view shows of them."""

from collections.abc import Sequence

import rerun as rr

Entity = Sequence[str]


def path_of(entity: Entity) -> str:
    """Return the path of an entity; what a part holds that is no plain letter is escaped."""
    return rr.new_entity_path(list(entity))


def with_all_below(entity: Entity) -> str:
    """Return the expression that finds an entity and everything below it."""
    return f"{path_of(entity)}/**"
