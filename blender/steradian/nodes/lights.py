"""The node trees of worlds and lights."""

from __future__ import annotations

import math

from . import values as v
from .reader import Reader
from .tree import Here, output_node


def _emission(thing, context, key="Surface"):
    tree = thing.node_tree
    end = output_node(tree) if tree else None
    if end is None:
        return None, None
    reader = Reader(thing.name, context)
    here = Here(reader, end)
    return reader, reader.surface(here, key)


def light_colour(light, context) -> tuple[float, float, float]:
    """Factor on a light's own colour and power that its node tree makes; (1, 1, 1) without one."""
    reader, found = _emission(light, context)
    if found is None:
        return (1.0, 1.0, 1.0)
    colour = v.as_colour(found.emission)
    if not v.is_constant(colour):
        reader.tell(None, "the light's colour varies, which is not known: its middle is taken")
    return tuple(float(c) for c in v.middle(colour))


def world_colour(world, context) -> tuple[float, float, float]:
    """Radiance of a world's background where it is one colour; pictures and skies count by their middle, which is told."""
    reader, found = _emission(world, context)
    if found is None:
        return tuple(getattr(world, "color", (0.0, 0.0, 0.0)))
    colour = v.as_colour(found.emission)
    if not v.is_constant(colour):
        reader.tell(None, "the background varies: its middle is taken")
    return tuple(float(c) for c in v.middle(colour))
