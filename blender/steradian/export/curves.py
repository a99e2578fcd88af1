"""Hair: curves objects and particle systems as strands, point clouds as spheres.

Strands whose material is `hair` are curves. Others are tubes of triangles: shading normals of curves are those of pbrt, whose
cylinders are seen from inside, which light scattered by hair does not depend on, but diffuse light does.
"""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from . import surface
from .context import Context
from .mesh import column

# Sides of a tube, pieces of each segment of a strand, and most triangles of an object's tubes.
SIDES, PIECES, MOST = 12, 2, 12_000_000

Strand = tuple[NDArray[np.float64], NDArray[np.float64]]


def bezier(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Control points of the cubic Bézier strand that Catmull and Rom's spline through points is."""
    if len(points) < 2:
        return points[:0]
    padded = np.concatenate([[2 * points[0] - points[1]], points, [2 * points[-1] - points[-2]]])
    slopes = (padded[2:] - padded[:-2]) / 6
    rows = np.stack([points[:-1], points[:-1] + slopes[:-1], points[1:] - slopes[1:]], axis=1).reshape(-1, 3)
    return np.concatenate([rows, points[-1:]])


def shapes(context: Context, name: str, strands: list[Strand], of: dict[str, Any]) -> list[dict[str, Any]]:
    """Shapes of strands, each its points and radii."""
    is_hair = context.sections["materials"].get(of.get("material", ""), {}).get("material") == "hair"
    count = sum((len(points) - 1) * PIECES * SIDES * 2 for points, _ in strands)
    if not is_hair and count <= MOST:
        return [{"shape": "mesh", "mesh": tubes(strands), **of}] if strands else []
    if not is_hair:
        context.report(name, "has too many strands for tubes: they are curves, shaded as if from inside")
    if any(
        not np.allclose(radii, np.linspace(radii[0], radii[-1], len(radii)), rtol=0.05, atol=1e-6)
        for _, radii in strands
    ):
        context.report(name, "its strands have the radii of root and tip, linear in between")
    return [
        {
            "shape": "curve",
            "degree": 3,
            "basis": "bezier",
            "type": "cylinder",
            "points": bezier(points).ravel(),
            "width0": 2 * radii[0],
            "width1": 2 * radii[-1],
            **of,
        }
        for points, radii in strands
    ]


def tubes(strands: list[Strand]) -> dict[str, Any]:
    """One mesh of tubes around strands; its sides are moved out so that they look as wide as round ones in the mean."""
    by_length: dict[int, list[Strand]] = {}
    for strand in strands:
        by_length.setdefault(len(strand[0]), []).append(strand)
    positions, normals, triangles, first = [], [], [], 0
    for alike in by_length.values():
        p, n, t = _tubes(np.array([points for points, _ in alike]), np.array([radii for _, radii in alike]))
        positions.append(p)
        normals.append(n)
        triangles.append(t + first)
        first += len(p)
    return {
        "positions": np.concatenate(positions),
        "normals": np.concatenate(normals),
        "triangles": np.concatenate(triangles),
    }


def _tubes(points: NDArray[np.float64], radii: NDArray[np.float64]) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """Tubes around strands of as many points each: vertices, normals and triangles."""
    points, radii = _refined(points), _lerped(radii)
    strands, rings = points.shape[:2]
    along = np.gradient(points, axis=1)
    along /= np.maximum(np.linalg.norm(along, axis=2, keepdims=True), 1e-12)
    side = np.empty_like(points)
    axis = np.eye(3)[np.abs(along[:, 0]).argmin(axis=1)]
    for k in range(rings):
        axis = axis - (axis * along[:, k]).sum(axis=1, keepdims=True) * along[:, k]
        axis /= np.maximum(np.linalg.norm(axis, axis=1, keepdims=True), 1e-12)
        side[:, k] = axis
    up = np.cross(along, side)
    turns = np.arange(SIDES) * 2 * np.pi / SIDES
    out = side[:, :, None] * np.cos(turns)[:, None] + up[:, :, None] * np.sin(turns)[:, None]
    wide = np.pi / (SIDES * np.sin(np.pi / SIDES))
    at = points[:, :, None] + out * (radii * wide)[:, :, None, None]
    index = np.arange(strands * rings * SIDES).reshape(strands, rings, SIDES)
    a, b = index[:, :-1], np.roll(index, -1, axis=2)[:, :-1]
    c, d = np.roll(index, -1, axis=2)[:, 1:], index[:, 1:]
    faces = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    return at.reshape(-1, 3).astype(np.float32), out.reshape(-1, 3).astype(np.float32), faces.astype(np.uint32)


def _refined(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points on Catmull and Rom's splines, `PIECES` for each segment."""
    padded = np.concatenate([2 * points[:, :1] - points[:, 1:2], points, 2 * points[:, -1:] - points[:, -2:-1]], axis=1)
    before, a, b, after = (padded[:, k : k + points.shape[1] - 1, None] for k in range(4))
    t = (np.arange(PIECES) / PIECES)[:, None]
    found = a + 0.5 * t * (b - before + t * (2 * before - 5 * a + 4 * b - after + t * (3 * (a - b) + after - before)))
    return np.concatenate([found.reshape(len(points), -1, 3), points[:, -1:]], axis=1)


def _lerped(radii: NDArray[np.float64]) -> NDArray[np.float64]:
    t = np.arange(PIECES) / PIECES
    found = radii[:, :-1, None] * (1 - t) + radii[:, 1:, None] * t
    return np.concatenate([found.reshape(len(radii), -1), radii[:, -1:]], axis=1)


def parts(context: Context, thing: bpy.types.Object) -> list[dict[str, Any]]:
    """Strands of a curves object, in its own space."""
    data = thing.data
    positions = column(data.position_data, "vector", 3).astype(np.float64)
    offsets = column(data.curve_offset_data, "value", 1, np.int32)
    radius = data.attributes.get("radius")
    radii = column(radius.data, "value", 1).astype(np.float64) if radius is not None else np.full(len(positions), 0.005)
    strands = [(positions[i:j], radii[i:j]) for i, j in zip(offsets[:-1], offsets[1:]) if j - i >= 2]
    return shapes(context, thing.name, strands, surface.of_slot(context, thing, 0))


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
        strands = []
        for strand in range(first, first + count):
            found = np.array([system.co_hair(thing, particle_no=strand, step=step) for step in range(steps)])
            found = found[found.any(axis=1)]
            if len(found) >= 2:
                strands.append((found, np.linspace(root, tip, len(found))))
        name = f"{thing.name} {system.name}"
        for shape in shapes(context, name, strands, of):
            context.add("shapes", name, {**shape, "to_world": np.eye(4)})
