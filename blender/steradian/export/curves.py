"""Hair: curves objects and particle systems as strands, point clouds as spheres."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from . import surface
from .context import Context
from .mesh import column


def bezier(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Control points of the cubic Bézier strand that Catmull and Rom's spline through points is."""
    if len(points) < 2:
        return points[:0]
    padded = np.concatenate([[2 * points[0] - points[1]], points, [2 * points[-1] - points[-2]]])
    slopes = (padded[2:] - padded[:-2]) / 6
    rows = np.stack([points[:-1], points[:-1] + slopes[:-1], points[1:] - slopes[1:]], axis=1).reshape(-1, 3)
    return np.concatenate([rows, points[-1:]])


def _strand(points: NDArray[np.float64], root: float, tip: float) -> dict[str, Any]:
    return {
        "shape": "curve", "degree": 3, "basis": "bezier", "type": "cylinder", "points": bezier(points).ravel(),
        "width0": 2 * root, "width1": 2 * tip,
    }


def parts(context: Context, thing: bpy.types.Object) -> list[dict[str, Any]]:
    """Strands of a curves object, in its own space."""
    data = thing.data
    positions = column(data.position_data, "vector", 3).astype(np.float64)
    offsets = column(data.curve_offset_data, "value", 1, np.int32)
    radius = data.attributes.get("radius")
    radii = column(radius.data, "value", 1) if radius is not None else np.full(len(positions), 0.005, np.float32)
    of = surface.of_slot(context, thing, 0)
    strands, is_uneven = [], False
    for begin, end in zip(offsets[:-1], offsets[1:]):
        if end - begin < 2:
            continue
        own = radii[begin:end]
        is_uneven |= not np.allclose(own, np.linspace(own[0], own[-1], len(own)), rtol=0.05, atol=1e-6)
        strands.append({**_strand(positions[begin:end], own[0], own[-1]), **of})
    if is_uneven:
        context.report(thing.name, "its strands have the radii of root and tip, linear in between")
    return strands


def points(context: Context, thing: bpy.types.Object) -> list[dict[str, Any]]:
    """Spheres of a point cloud."""
    attributes = thing.data.attributes
    positions = column(attributes["position"].data, "vector", 3).astype(np.float64)
    radius = attributes.get("radius")
    radii = column(radius.data, "value", 1) if radius is not None else np.full(len(positions), 0.01, np.float32)
    of = surface.of_slot(context, thing, 0)
    return [{"shape": "sphere", "center": at, "radius": r, **of} for at, r in zip(positions, radii) if r > 0]


def export_particles(context: Context, thing: bpy.types.Object) -> None:
    """Adds the hair of an object's particle systems, which is in the space of the world."""
    for modifier in thing.modifiers:
        if modifier.type != "PARTICLE_SYSTEM":
            continue
        system = modifier.particle_system
        how = system.settings
        if how.type != "HAIR" or how.render_type != "PATH":
            continue
        first, count = 0, len(system.particles)
        if how.child_type != "NONE" and len(system.child_particles):
            first, count = count, len(system.child_particles)
        of = surface.of_slot(context, thing, max(how.material - 1, 0))
        root, tip = how.root_radius * how.radius_scale, how.tip_radius * how.radius_scale
        steps = 2 ** (how.render_step if context.depsgraph.mode == "RENDER" else how.display_step) + 1
        group = {}
        for strand in range(first, first + count):
            found = np.array([system.co_hair(thing, particle_no=strand, step=step) for step in range(steps)])
            keep = found.any(axis=1)
            if keep.sum() >= 2:
                group[context.name(f"{thing.name} {system.name}")] = {**_strand(found[keep], root, tip), **of}
        if group:
            name = f"{thing.name}/{system.name}"
            context.sections["groups"][name] = group
            context.instances.append({"group": name, "to_world": np.eye(4)})
