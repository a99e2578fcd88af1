"""Normal maps and bumps: what feeds a socket 'Normal'."""

from __future__ import annotations

from . import values as v
from .registry import evaluates
from .tree import Here


def maps(here, key="Normal") -> dict:
    """Parameters of a material for the normal that feeds an input."""
    found = here.source(key)
    if found is None or not found.is_linked:
        return {}
    inner = Here(here.reader, found.node, found.groups)
    kind = found.node.bl_idname
    if kind == "ShaderNodeNormalMap":
        return _normal_map(inner)
    if kind == "ShaderNodeBump":
        return _bump(inner)
    if kind in ("ShaderNodeNewGeometry", "ShaderNodeTexCoord") and found.socket.identifier == "Normal":
        return {}
    here.tell(f"a '{key}' from {kind} is not known: the surface's own normal is taken")
    return {}


def _normal_map(here) -> dict:
    node = here.node
    if node.space not in ("TANGENT", "OBJECT", "WORLD"):
        here.tell(f"the space {node.space.lower()} of a normal map is not known: it is left out")
        return {}
    if node.uv_map and node.uv_map != getattr(here.reader.context, "uv_map", node.uv_map):
        here.tell(f"the tangents are those of the active UV map, not of '{node.uv_map}'")
    if node.space == "WORLD":
        here.tell("the normal map of world space is taken as one of object space")
    colour, strength = here.colour("Color"), here.constant("Strength", 1.0)
    if v.is_constant(colour) and colour == (0.5, 0.5, 1.0) or strength == 0:
        return {}
    texture = v.scene(colour) if not v.is_constant(colour) else {"texture": "constant", "value": list(colour)}
    made = {"normal_map": texture}
    if node.space != "TANGENT":
        made["normal_map_space"] = "object"
    if strength != 1.0:
        made["normal_map_strength"] = strength
    return made


def _bump(here) -> dict:
    made = maps(here)
    height = here.number("Height")
    if v.is_constant(height):
        return made
    factor = here.constant("Distance", 1.0) * min(max(here.constant("Strength", 1.0), 0.0), 1.0)
    if "bump" in made:
        here.tell("of two bumps on top of each other the sum is taken")
    if here.node.invert:
        factor = -factor
    height = v.multiply(height, factor)
    if v.is_constant(height):
        return made
    other = made.get("bump")
    return {**made, "bump": {"texture": "add", "a": other, "b": v.scene(height)} if other else v.scene(height)}


@evaluates("ShaderNodeNormalMap", "ShaderNodeBump", "ShaderNodeTangent", "ShaderNodeNormal")
def as_value(here, out):
    here.tell("a normal or tangent as a value is not known: (0, 0, 1) is taken")
    return 0.0 if out == "Dot" else (0.0, 0.0, 1.0)


def displacement(here, material) -> dict:
    """What the socket 'Displacement' of a material output says: a bump of the material, or a displacement of shapes."""
    found = here.source("Displacement")
    if found is None or not found.is_linked:
        return {}
    inner = Here(here.reader, found.node, found.groups)
    if found.node.bl_idname != "ShaderNodeDisplacement":
        inner.tell("displacement by vectors is not known: it is left out")
        return {}
    height = inner.number("Height")
    middle, scale = inner.constant("Midlevel", 0.5), inner.constant("Scale", 1.0)
    if v.is_constant(height):
        if height != middle and scale:
            inner.tell("a displacement that is the same everywhere is left out")
        return {}
    if inner.is_linked("Normal"):
        inner.tell("displacement goes along the surface's own normal")
    method = material.displacement_method
    if method == "BUMP":
        return {"bump": v.scene(v.multiply(height, scale))}
    if method == "BOTH":
        inner.tell("displacement and bump: the displacement is taken")
    return {"displacement": v.scene(height), "displacement_scale": scale, "displacement_middle": middle}
