"""Materials of slots as what a shape has: material, emission, media and opacity."""

from __future__ import annotations

from typing import Any

import bpy

from .. import nodes
from .context import Context

# What an entry of a material may say of the shapes that have it.
OF_SHAPE = (
    "emission",
    "interior",
    "exterior",
    "alpha",
    "displacement",
    "displacement_scale",
    "displacement_middle",
    "displacement_vector",
)


def of_slot(context: Context, thing: bpy.types.Object, slot: int) -> dict[str, Any]:
    """What the shape of a material slot has beside its geometry."""
    slots = thing.material_slots
    material = slots[min(slot, len(slots) - 1)].material if slots else None
    material = context.depsgraph.view_layer.material_override or material
    group = thing.lightgroup
    known = context.surfaces
    alone = material is not None and nodes.depends_on_object(material.node_tree)
    key = (material.name_full if material else "", group, thing.name_full if alone else "")
    context.object = thing
    if key not in known:
        known[key] = _surface(context, material, group)
    return dict(known[key])


def _surface(context: Context, material: bpy.types.Material | None, group: str) -> dict[str, Any]:
    entry = _entry(context, material)
    shape = {key: entry.pop(key) for key in OF_SHAPE if key in entry}
    name = material.name if material else "default"
    if isinstance(shape.get("emission"), dict):
        shape["emission"] = context.add("nodes", group or f"{name} emission", shape["emission"])
        context.emitters.append(name)
    for side in ("interior", "exterior"):
        if isinstance(shape.get(side), dict):
            shape[side] = context.medium(f"{name} volume", shape[side])
    return {"material": context.material(name, entry), **shape}


def _entry(context: Context, material: bpy.types.Material | None) -> dict[str, Any]:
    if material is None:
        return {"material": "diffuse", "reflectance": 0.8}
    return dict(nodes.material(material, context))
