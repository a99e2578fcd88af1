"""Coordinates: where textures are looked up, as affine maps of the spaces that both renderers know."""

from __future__ import annotations

import math

import numpy as np

from . import values as v
from .registry import evaluates


def _flat(matrix) -> tuple:
    return tuple(float(x) for x in np.asarray(matrix, float).ravel())


def _object_from_world(obj):
    return np.linalg.inv(np.array(obj.matrix_world, float))


def _generated_from_object(obj):
    """The unit cube over the texture space of an object's data."""
    data = obj.data
    middle, half = getattr(data, "texspace_location", None), getattr(data, "texspace_size", None)
    if middle is None:
        corners = np.array(obj.bound_box)
        middle, half = 0.5 * (corners.min(0) + corners.max(0)), 0.5 * (corners.max(0) - corners.min(0))
    matrix = np.eye(4)
    for i in range(3):
        scale = 0.5 / half[i] if half[i] else 0.0
        matrix[i, i], matrix[i, 3] = scale, 0.5 - scale * middle[i]
    return matrix


def space_of(here, base: str) -> tuple:
    """Parameters that place a texture's point in the space `base`."""
    if base.startswith("uv"):
        name = base[3:]
        if not name or name == getattr(here.reader.context, "uv_map", None):
            return (("mapping", "uv"),)
        here.reader.context.attributes.add(name)
        return (("mapping", "uv"), ("uv_set", name))
    if base == "world":
        return ()
    obj = here.reader.context_object(base)
    if obj is None:
        here.tell(f"{base} coordinates need the object that is shaded: those of the world are taken")
        return ()
    matrix = _object_from_world(obj)
    if base == "generated":
        matrix = _generated_from_object(obj) @ matrix
    return (("texture_from_world", _flat(matrix)),)


def coordinates(here, base: str) -> v.Field:
    """The coordinates of a space, as a field."""
    names = ("u", "v", "0") if base.startswith("uv") else ("x", "y", "z")
    low, high = (0.0, 1.0) if base.startswith("uv") or base == "generated" else (-10.0, 10.0)
    return v.Field(3, low, high, None, names, space_of(here, base), v.Place(base, _flat(np.eye(4)[:3])))


@evaluates("ShaderNodeTexCoord")
def texture_coordinate(here, out):
    if out == "UV":
        return coordinates(here, "uv")
    if out == "Generated":
        return coordinates(here, "generated")
    if out == "Object":
        other = here.node.object
        return coordinates(here, f"object:{other.name}" if other else "object")
    here.tell(f"coordinates '{out}' are not known: UV is taken")
    return coordinates(here, "uv")


@evaluates("ShaderNodeUVMap")
def uv_map(here, out):
    return coordinates(here, f"uv:{here.node.uv_map}" if here.node.uv_map else "uv")


@evaluates("ShaderNodeNewGeometry")
def geometry(here, out):
    if out == "Position":
        return coordinates(here, "world")
    if out in ("Normal", "True Normal", "Incoming", "Tangent"):
        here.tell(f"'{out}' as a value is not known: (0, 0, 1) is taken")
        return (0.0, 0.0, 1.0)
    fallback = {"Backfacing": 0.0, "Pointiness": 0.5, "Random Per Island": 0.5}.get(out, 0.5)
    here.tell(f"'{out}' is not known: {fallback} is taken")
    return fallback


def _euler(angles, order="XYZ"):
    """Blender's rotation about x, then y, then z."""
    out = np.eye(3)
    for axis, angle in zip(order, angles):
        c, s = math.cos(angle), math.sin(angle)
        i, j = {"X": (1, 2), "Y": (2, 0), "Z": (0, 1)}[axis]
        turn = np.eye(3)
        turn[i, i], turn[i, j], turn[j, i], turn[j, j] = c, -s, s, c
        out = turn @ out
    return out


def moved(here, given, matrix):
    """A vector under an affine map (4 x 4)."""
    matrix = np.asarray(matrix, float)
    rows = []
    parts = v.components(given)
    for row in matrix[:3]:
        total = float(row[3])
        for k, part in zip(row[:3], parts):
            if k:
                total = v.add(v.multiply(part, float(k)), total) if k != 1.0 or total else part
        rows.append(total)
    found = v.combine_colour(*rows)
    if isinstance(found, v.Field) and isinstance(given, v.Field) and given.place:
        return v.Field(3, found.low, found.high, found.node, found.formulas, found.space, given.place.then(matrix))
    return found


def _constant_vector(here, key, default):
    value = here.colour(key, default)
    if not v.is_constant(value):
        here.tell(f"'{key}' from a texture: its middle is taken")
    return np.array(v.middle(value), float)


@evaluates("ShaderNodeMapping")
def mapping(here, out):
    kind = here.node.vector_type
    place = _constant_vector(here, "Location", (0, 0, 0)) if here.socket("Location").enabled else np.zeros(3)
    turn = _euler(_constant_vector(here, "Rotation", (0, 0, 0)))
    scale = _constant_vector(here, "Scale", (1, 1, 1))
    matrix = np.eye(4)
    if kind == "TEXTURE":
        safe = np.where(scale == 0, 1.0, scale)
        matrix[:3, :3] = np.diag(1 / safe) @ turn.T
        matrix[:3, 3] = matrix[:3, :3] @ -place
    else:
        inverse = np.where(scale == 0, 0.0, 1 / np.where(scale == 0, 1.0, scale))
        matrix[:3, :3] = turn @ np.diag(inverse if kind == "NORMAL" else scale)
        matrix[:3, 3] = place if kind == "POINT" else 0.0
    if kind == "NORMAL" and not v.is_constant(here.colour("Vector")):
        here.tell("Mapping of normals does not make textures unit vectors")
    return moved(here, here.colour("Vector"), matrix)


@evaluates("ShaderNodeVectorRotate")
def vector_rotate(here, out):
    node = here.node
    centre, angle = _constant_vector(here, "Center", (0, 0, 0)), here.constant("Angle")
    if node.rotation_type == "EULER_XYZ":
        turn = _euler(_constant_vector(here, "Rotation", (0, 0, 0)))
    else:
        axis = {"X_AXIS": (1, 0, 0), "Y_AXIS": (0, 1, 0), "Z_AXIS": (0, 0, 1)}.get(node.rotation_type)
        axis = np.array(axis, float) if axis else _constant_vector(here, "Axis", (0, 0, 1))
        x, y, z = axis / (np.linalg.norm(axis) or 1.0)
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        turn = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    turn = turn.T if node.invert else turn
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn, centre - turn @ centre
    return moved(here, here.colour("Vector"), matrix)


def place_of(here, default: str, key="Vector"):
    """The coordinates that a texture is looked up at: (base, affine map 4 x 4, place parameters)."""
    given = here.colour(key) if here.is_linked(key) else coordinates(here, default)
    if v.is_constant(given) or given.place is None:
        if v.is_constant(given):
            here.tell("constant coordinates: the texture is looked up as without them")
        else:
            here.tell("coordinates that are no affine map of a space: those without the nodes between are taken")
        given = coordinates(here, default)
    own = here.node.texture_mapping
    place = given.place.then(_own_mapping(own)) if own else given.place
    return place.base, np.vstack([place.array, [0, 0, 0, 1]]), space_of(here, place.base)


def _own_mapping(mapping):
    """The affine map of the old mapping that texture nodes carry themselves."""
    matrix = np.eye(4)
    matrix[:3, :3] = _euler(mapping.rotation) @ np.diag(mapping.scale)
    matrix[:3, 3] = mapping.translation
    return matrix


def on_uv(here, default="generated") -> bool:
    """True if a texture is looked up by UV coordinates."""
    return place_of(here, default)[0].startswith("uv")


def flat_parameters(here, default="uv") -> dict:
    """Parameters of the mapping of a texture over two coordinates."""
    base, matrix, space = place_of(here, default)
    found = dict(space)
    if base.startswith("uv"):
        if not np.allclose(matrix, np.eye(4)):
            found["to_uv"] = {"matrix": list(_flat(matrix))}
        return found
    return {"mapping": "planar", "texture_from_world": {"matrix": list(_flat(_through(matrix, found)))}}


def _through(matrix, found):
    own = found.get("texture_from_world")
    return matrix @ np.array(own, float).reshape(4, 4) if own is not None else matrix


def solid_parameters(here, scale: float = 1.0, default="generated") -> dict:
    """Parameters of a pattern in space; over u and v where the coordinates are UV."""
    base, matrix, space = place_of(here, default)
    matrix = np.diag([scale, scale, scale, 1.0]) @ matrix
    found = dict(space)
    if base.startswith("uv"):
        return {**found, "dimension": 2, "to_uv": {"matrix": list(_flat(matrix))}}
    return {"dimension": 3, "texture_from_world": {"matrix": list(_flat(_through(matrix, found)))}}


def vector(here, default="generated", key="Vector"):
    """The three coordinates of a texture's point, for patterns that are formulas."""
    given = here.colour(key) if here.is_linked(key) else coordinates(here, default)
    own = getattr(here.node, "texture_mapping", None)
    matrix = _own_mapping(own) if own else np.eye(4)
    return given if np.allclose(matrix, np.eye(4)) else moved(here, given, matrix)
