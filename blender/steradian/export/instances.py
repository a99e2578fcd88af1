"""Objects of a dependency graph as shapes, and as groups that are placed many times."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from . import curves, light, matrix, mesh, surface, volume
from .context import Context

GEOMETRY = {"MESH", "CURVE", "SURFACE", "FONT", "META", "CURVES", "VOLUME", "POINTCLOUD"}


@dataclass
class Model:
    """What is placed: a geometry with its materials, and all its places."""

    name: str
    object: bpy.types.Object
    parts: list[dict[str, Any]]
    places: list[tuple[Any, NDArray[np.float64]]] = field(default_factory=list)


class Meshes:
    """Arrays of meshes that are kept from one export to the next, until their data changes."""

    def __init__(self) -> None:
        self._kept: dict[Any, Any] = {}
        self._used: set[Any] = set()

    def get(self, key: Any, make: Any) -> Any:
        """Value of a key, made where it is not kept."""
        self._used.add(key)
        if key not in self._kept:
            self._kept[key] = make()
        return self._kept[key]

    def forget(self, is_changed: Any) -> None:
        """Drops entries whose key is changed."""
        self._kept = {key: value for key, value in self._kept.items() if not is_changed(key)}

    def sweep(self) -> None:
        """Drops what was not used since the last sweep."""
        self._kept = {key: value for key, value in self._kept.items() if key in self._used}
        self._used = set()


def places(depsgraph: bpy.types.Depsgraph) -> dict[Any, NDArray[np.float64]]:
    """Matrices of all that is placed, by keys that stay the same from frame to frame."""
    return {
        _place(found): matrix.array(found.matrix_world)
        for found in depsgraph.object_instances
        if found.object.type in GEOMETRY
    }


def _place(found: bpy.types.DepsgraphObjectInstance) -> Any:
    if not found.is_instance:
        return found.object.name_full
    return (found.parent.name_full if found.parent else "", found.object.name_full, tuple(found.persistent_id))


Moved = dict[Any, tuple[NDArray[np.float64], NDArray[np.float64]]]


def export(context: Context, meshes: Meshes, moved: Moved | None = None) -> None:
    """Adds all objects that are seen; `moved` has their places at both ends of the exposure."""
    models: dict[Any, Model] = {}
    for found in context.depsgraph.object_instances:
        thing = found.object
        if thing.type == "LIGHT" and (found.is_instance or found.show_self):
            light.export(context, thing, found.matrix_world)
        if thing.type not in GEOMETRY:
            if thing.type in {"GREASEPENCIL", "GPENCIL"}:
                context.report(thing.name, "is a drawing of Grease Pencil, which is left out")
            continue
        place = matrix.array(found.matrix_world)
        if not matrix.usable(place):
            context.report(thing.name, "has a scale of zero, and is left out")
            continue
        if found.show_self:
            _placed(context, meshes, models, found, thing, place)
        if found.show_particles and not found.is_instance:
            curves.export_particles(context, thing)
    for model in models.values():
        _add(context, model, moved or {})


def _placed(
    context: Context, meshes: Meshes, models: dict[Any, Model], found: Any, thing: bpy.types.Object, place: Any
) -> None:
    materials = tuple(slot.material.name_full if slot.material else "" for slot in thing.material_slots)
    data = thing.data
    key = (thing.type, data.as_pointer() if data else thing.name_full, materials, _visibility(thing))
    if key not in models:
        models[key] = Model(thing.name, thing, _parts(context, meshes, thing))
    models[key].places.append((_place(found), place))


def _visibility(thing: bpy.types.Object) -> tuple[bool, ...]:
    return (thing.visible_camera, thing.visible_shadow, thing.is_shadow_catcher, thing.is_holdout)


def _parts(context: Context, meshes: Meshes, thing: bpy.types.Object) -> list[dict[str, Any]]:
    """Shapes of an object, without their names and places."""
    _tell_visibility(context, thing)
    if thing.type == "VOLUME":
        return volume.parts(context, thing)
    if thing.type == "CURVES":
        return curves.parts(context, thing)
    if thing.type == "POINTCLOUD":
        return curves.points(context, thing)
    found = []
    for slot, arrays in meshes.get(_mesh_key(thing), lambda: _triangles(thing)):
        shape = {"shape": "mesh", "mesh": _mesh(context, thing, slot, arrays), **surface.of_slot(context, thing, slot)}
        if thing.is_shadow_catcher:
            shape["shadow_catcher"] = True
        found.append(shape)
    return found


def _mesh_key(thing: bpy.types.Object) -> Any:
    return (
        thing.data.name_full if thing.data else "",
        thing.name_full if thing.modifiers or thing.type != "MESH" else "",
        thing.data.as_pointer(),
    )


def _triangles(thing: bpy.types.Object) -> Any:
    if thing.type == "MESH":
        return mesh.arrays(thing.data)
    try:
        made = thing.to_mesh()
    except RuntimeError:
        return []
    found = mesh.arrays(made) if made else []
    thing.to_mesh_clear()
    return found


def _mesh(context: Context, thing: bpy.types.Object, slot: int, arrays: dict[str, Any]) -> str:
    """Puts arrays into the section of meshes, once, and gives their name."""
    name = f"{thing.name}/{slot}/{id(arrays):x}"
    context.sections["meshes"][name] = arrays
    return name


def _tell_visibility(context: Context, thing: bpy.types.Object) -> None:
    hidden = [
        what
        for what in ("camera", "diffuse", "glossy", "transmission", "volume_scatter", "shadow")
        if not getattr(thing, f"visible_{what}")
    ]
    if hidden:
        context.report(thing.name, f"is seen by all rays, those of {', '.join(hidden)} too")
    if thing.is_holdout:
        context.report(thing.name, "is no holdout, but drawn")


# Modifiers that change a shape in time.
DEFORMING = {
    "ARMATURE",
    "CLOTH",
    "CURVE",
    "HOOK",
    "LATTICE",
    "MESH_CACHE",
    "MESH_DEFORM",
    "MESH_SEQUENCE_CACHE",
    "OCEAN",
    "SHRINKWRAP",
    "SOFT_BODY",
    "SURFACE_DEFORM",
    "WAVE",
}


def _tell_deformation(context: Context, thing: bpy.types.Object) -> None:
    keys = getattr(thing.data, "shape_keys", None)
    if any(m.type in DEFORMING for m in thing.modifiers) or (keys is not None and keys.animation_data is not None):
        context.report(
            thing.name, "moves as a whole while the shutter is open: its shape is that of the middle of the exposure"
        )


def _add(context: Context, model: Model, moved: Moved) -> None:
    """A model that is placed once and stands still is a shape by itself; others are a group with instances."""
    if moved:
        _tell_deformation(context, model.object)
    ways = []
    for key, place in model.places:
        begin, end = moved.get(key, (place, None))
        moves = end is not None and not np.allclose(begin, end, atol=1e-7)
        ways.append((begin, end) if moves and matrix.usable(begin) and matrix.usable(end) else (place, None))
    if len(ways) == 1 and ways[0][1] is None:
        for part in model.parts:
            context.add("shapes", model.name, {**part, "to_world": ways[0][0]})
        return
    if not model.parts:
        return
    name = f"{model.name}/{len(context.sections['groups'])}"
    context.sections["groups"][name] = {context.name(model.name): part for part in model.parts}
    for begin, end in ways:
        instance = {"group": name, "to_world": begin}
        if end is not None:
            instance |= {"to_world_end": end, "motion_times": [0.0, 1.0]}
        context.instances.append(instance)
