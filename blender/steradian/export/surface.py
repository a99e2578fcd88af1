"""Materials of slots as what a shape has: material, emission, media and opacity."""

from __future__ import annotations

from typing import Any

import bpy

from .context import Context

try:
    from .. import nodes
except ImportError:
    nodes = None

# What an entry of a material may say of the shapes that have it.
OF_SHAPE = ("emission", "interior", "exterior", "alpha", "displacement", "displacement_scale", "displacement_middle", "displacement_vector")


def of_slot(context: Context, thing: bpy.types.Object, slot: int) -> dict[str, Any]:
    """What the shape of a material slot has beside its geometry."""
    slots = thing.material_slots
    material = slots[min(slot, len(slots) - 1)].material if slots else None
    material = context.depsgraph.view_layer.material_override or material
    group = thing.lightgroup
    known = context.surfaces
    alone = nodes is not None and material is not None and nodes.depends_on_object(material.node_tree)
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
    if nodes is not None:
        return dict(nodes.material(material, context))
    return _principled(context, material)


def _principled(context: Context, material: bpy.types.Material) -> dict[str, Any]:
    """The values of a Principled BSDF's main sockets."""
    found = [node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED"] if material.node_tree else []
    if not found:
        emitting = [node for node in material.node_tree.nodes if node.type == "EMISSION"] if material.node_tree else []
        if emitting:
            value = [float(c) * emitting[0].inputs["Strength"].default_value for c in emitting[0].inputs["Color"].default_value[:3]]
            return {"material": "diffuse", "reflectance": 0.0, "emission": {"light": "area", "radiance": value, "two_sided": True}}
        return {"material": "diffuse", "reflectance": list(material.diffuse_color[:3])}
    inputs = found[0].inputs
    for socket in inputs:
        if socket.is_linked:
            context.report(material.name, f"the link to '{socket.name}' is not followed")
    if inputs["Metallic"].default_value == 0 and inputs["Specular IOR Level"].default_value == 0:
        entry: dict[str, Any] = {"material": "diffuse", "reflectance": list(inputs["Base Color"].default_value[:3])}
    else:
        entry = {
            "material": "principled", "base_color": list(inputs["Base Color"].default_value[:3]),
            "roughness": inputs["Roughness"].default_value, "metallic": inputs["Metallic"].default_value,
        }
    strength = inputs["Emission Strength"].default_value
    if strength > 0:
        colour = [float(c) * strength for c in inputs["Emission Color"].default_value[:3]]
        entry["emission"] = {"light": "area", "radiance": colour, "two_sided": True}
    return entry
