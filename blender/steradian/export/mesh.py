"""Evaluated meshes as arrays: shared vertices, which are parted only where corners differ in normal, coordinates or colour."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

# Attributes of Blender's own bookkeeping, which no material reads.
INTERNAL = {"position", "material_index", "sharp_face", "sharp_edge", "custom_normal", "crease_edge", "crease_vert"}
COLUMNS = {
    "FLOAT": ("value", 1),
    "INT": ("value", 1),
    "INT8": ("value", 1),
    "BOOLEAN": ("value", 1),
    "FLOAT2": ("vector", 2),
    "FLOAT_VECTOR": ("vector", 3),
    "FLOAT_COLOR": ("color", 4),
    "BYTE_COLOR": ("color", 4),
}


def column(collection: Any, name: str, width: int, kind: type = np.float32) -> NDArray[Any]:
    """A property of all items of a collection, one row for each."""
    found = np.empty(len(collection) * width, kind)
    collection.foreach_get(name, found)
    return found.reshape(-1, width) if width > 1 else found


def arrays(mesh: bpy.types.Mesh) -> list[tuple[int, dict[str, Any]]]:
    """Parts of a mesh by material slot: arrays for the section `meshes`."""
    mesh.calc_loop_triangles()
    if not mesh.loop_triangles:
        return []
    corners = column(mesh.loop_triangles, "loops", 3, np.int32)
    vertex_of = column(mesh.loops, "vertex_index", 1, np.int32)
    positions = column(mesh.vertices, "co", 3)
    faces_of = column(mesh.loop_triangle_polygons, "value", 1, np.int32)
    names, per_corner, per_face = _attributes(mesh, vertex_of)
    columns = [column(mesh.corner_normals, "vector", 3), *per_corner]
    data = np.concatenate(columns, axis=1)
    ends = np.cumsum([c.shape[1] for c in columns])

    # Each vertex takes the data of one of its corners; corners that differ become vertices of their own.
    shared = np.zeros((len(positions), data.shape[1]), np.float32)
    shared[vertex_of] = data
    apart = (shared[vertex_of] != data).any(axis=1)
    index = vertex_of.copy()
    index[apart] = len(positions) + np.arange(int(apart.sum()))
    positions = np.concatenate([positions, positions[vertex_of[apart]]])
    split = np.split(np.concatenate([shared, data[apart]]), ends[:-1], axis=1)

    attributes = dict(zip(names, split[1:]))
    uvs = mesh.uv_layers.active_render if hasattr(mesh.uv_layers, "active_render") else None
    uvs = uvs or next((layer for layer in mesh.uv_layers if layer.active_render), None)
    triangles = index[corners].astype(np.uint32)
    whole = {"positions": positions, "normals": _unit(split[0]), "attributes": attributes}
    if uvs is not None and uvs.name in attributes:
        whole["uvs"] = attributes[uvs.name]

    slots = _slots(mesh)
    if slots is None:
        return [(0, {**whole, "triangles": triangles, "attributes": _with_faces(attributes, per_face, faces_of)})]
    of_triangle = slots[faces_of]
    parts = []
    for slot in np.unique(of_triangle):
        chosen = of_triangle == slot
        own, renumbered = np.unique(triangles[chosen], return_inverse=True)
        part = {key: value[own] for key, value in whole.items() if key != "attributes"}
        part["triangles"] = renumbered.reshape(-1, 3).astype(np.uint32)
        part["attributes"] = _with_faces(
            {name: value[own] for name, value in attributes.items()}, per_face, faces_of[chosen]
        )
        parts.append((int(slot), part))
    return parts


def _unit(normals: NDArray[np.float32]) -> NDArray[np.float32]:
    """Normals of vertices that no face has are up."""
    normals[~normals.any(axis=1)] = (0, 0, 1)
    return normals


def _with_faces(attributes: dict[str, Any], per_face: dict[str, Any], faces_of: NDArray[Any]) -> dict[str, Any]:
    return attributes | {name: {"face": value.shape[1], "data": value[faces_of]} for name, value in per_face.items()}


def _slots(mesh: bpy.types.Mesh) -> NDArray[np.int32] | None:
    """Material slot of each face; None where all have the first."""
    found = mesh.attributes.get("material_index")
    if found is None or found.domain != "FACE":
        return None
    slots = column(found.data, "value", 1, np.int32)
    return slots if slots.any() else None


def _attributes(
    mesh: bpy.types.Mesh, vertex_of: NDArray[Any]
) -> tuple[list[str], list[NDArray[Any]], dict[str, NDArray[Any]]]:
    """Names and values at corners of UV maps, colours and other attributes, and values at faces."""
    names, per_corner, per_face = [], [], {}
    for attribute in mesh.attributes:
        if attribute.name in INTERNAL or attribute.name.startswith(".") or attribute.data_type not in COLUMNS:
            continue
        what, width = COLUMNS[attribute.data_type]
        if attribute.domain not in ("POINT", "CORNER", "FACE") or not len(attribute.data):
            continue
        kind = {"INT": np.int32, "INT8": np.int8, "BOOLEAN": np.bool_}.get(attribute.data_type, np.float32)
        values = column(attribute.data, what, width, kind).astype(np.float32).reshape(-1, width)
        if attribute.domain == "FACE":
            per_face[attribute.name] = values
        else:
            names.append(attribute.name)
            per_corner.append(values if attribute.domain == "CORNER" else values[vertex_of])
    return names, per_corner, per_face
