"""Lights in Cycles' units: watts as radiance and radiant intensity."""

from __future__ import annotations

import math
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from .. import nodes
from . import matrix
from .context import Context
from .lamps import Lamp


def export(context: Context, thing: bpy.types.Object, world: Any) -> None:
    """Adds a light object at a place."""
    lamp, place = thing.data, matrix.array(world)
    if not matrix.usable(place):
        return
    strength = lamp.energy * 2.0 ** getattr(lamp, "exposure", 0.0) * _colour(context, lamp)
    if not strength.any():
        return
    name = thing.lightgroup or thing.name
    if not lamp.use_shadow:
        context.report(thing.name, "throws shadows, though it is set not to")
    {"POINT": _point, "SPOT": _spot, "SUN": _sun, "AREA": _area}[lamp.type](context, name, thing, place, strength)


def _colour(context: Context, lamp: bpy.types.Light) -> NDArray[np.float64]:
    """Colour of a light with its temperature and its node tree."""
    colour = np.array(lamp.color, np.float64)
    if getattr(lamp, "use_temperature", False):
        colour *= np.array(lamp.temperature_color)[:3]
    if not lamp.use_nodes or lamp.node_tree is None:
        return colour
    return colour * np.array(nodes.light_colour(lamp, context), np.float64)


def _point(
    context: Context, name: str, thing: bpy.types.Object, place: NDArray[np.float64], strength: NDArray[np.float64]
) -> None:
    radius = thing.data.shadow_soft_size
    strength = strength * _whole(thing.data)
    if radius > 0:
        if thing.data.use_soft_falloff:
            context.report(thing.name, "is a sphere: its soft falloff, which is darker very near the lamp, is left out")
        radiance = strength / (4 * math.pi**2 * radius**2)
        _emitter(context, name, thing, {"shape": "sphere", "radius": radius, "to_world": _moved(place)}, radiance)
    else:
        context.add("lights", name, {"light": "point", "position": place[:3, 3], "intensity": strength / (4 * math.pi)})


def _whole(lamp: bpy.types.Light) -> float:
    """Factor on the power of a point or spot: the area of its sphere where its power is not that of all of it."""
    if getattr(lamp, "normalize", True):
        return 1.0
    return 4 * math.pi * lamp.shadow_soft_size**2 if lamp.shadow_soft_size > 0 else 4.0


def _moved(place: NDArray[np.float64]) -> NDArray[np.float64]:
    m = np.eye(4)
    m[:3, 3] = place[:3, 3]
    return m


def _spot(
    context: Context, name: str, thing: bpy.types.Object, place: NDArray[np.float64], strength: NDArray[np.float64]
) -> None:
    lamp = thing.data
    scale = np.linalg.norm(place[:3, :3], axis=0)
    if not np.allclose(scale, scale[0], rtol=1e-3):
        context.report(thing.name, "has a round cone: its scale is left out")
    half = lamp.spot_size / 2
    inner = min(math.cos(half) + lamp.spot_blend * (1 - math.cos(half)), 1.0)
    at = matrix.rigid(place) @ matrix.FLIP
    points = _disc(SPOTS) * lamp.shadow_soft_size if lamp.shadow_soft_size > 0 else np.zeros((1, 3))
    if len(points) > 1:
        context.report(thing.name, f"is {SPOTS} points on a disc: soft shadows have as many steps")
    for point in points:
        moved = at.copy()
        moved[:3, 3] += at[:3, :3] @ point
        context.add(
            "lights",
            name,
            {
                "light": "spot",
                "intensity": strength * _whole(lamp) / (4 * math.pi * len(points)),
                "cone_angle": math.degrees(half),
                "falloff_start": math.degrees(math.acos(inner)),
                "falloff": "smoothstep",
                "to_world": moved,
            },
        )


# Points that stand for a spot with a radius: one light of ours with a cone has no size.
SPOTS = 24


def _disc(count: int) -> NDArray[np.float64]:
    """Points evenly over the unit disc across z."""
    k = np.arange(count) + 0.5
    radius, turn = np.sqrt(k / count), k * math.pi * (3 - math.sqrt(5))
    return np.stack([radius * np.cos(turn), radius * np.sin(turn), np.zeros(count)], axis=1)


def _sun(
    context: Context, name: str, thing: bpy.types.Object, place: NDArray[np.float64], strength: NDArray[np.float64]
) -> None:
    axes = matrix.rigid(place)
    way, size = -axes[:3, 2], math.tan(thing.data.angle / 2)
    if size < 1e-4:
        context.add("lights", name, {"light": "distant", "direction": way, "radiance": strength})
        return
    # A disc so far away that its light is as good as parallel from each of its points.
    distance = context.sun_distance
    disc = np.eye(4)
    disc[:3, :3] = (axes @ matrix.FLIP)[:3, :3] * distance * size
    disc[:3, 3] = -way * distance
    _emitter(
        context,
        name,
        thing,
        {"shape": "disk", "to_world": disc},
        strength / (math.pi * math.sin(thing.data.angle / 2) ** 2),
    )


def _area(
    context: Context, name: str, thing: bpy.types.Object, place: NDArray[np.float64], strength: NDArray[np.float64]
) -> None:
    lamp = thing.data
    if lamp.spread < math.pi - 1e-3:
        context.report(thing.name, "shines to all sides of its face: its spread is left out")
    across = lamp.size_y if lamp.shape in {"RECTANGLE", "ELLIPSE"} else lamp.size
    scale = np.linalg.norm(place[:3, :3], axis=0)
    size = np.array([lamp.size * scale[0], across * scale[1]]) / 2
    is_round = lamp.shape in {"DISK", "ELLIPSE"}
    area = size[0] * size[1] * (math.pi if is_round else 4)
    if area <= 0:
        context.report(thing.name, "has no area, and is left out")
        return
    m = matrix.rigid(place) @ matrix.FLIP @ np.diag([size[0], size[1], 1, 1])
    shape = {"shape": "disk"} if is_round else {"shape": "polygon", "points": [-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0]}
    radiance = strength / (math.pi * (area if getattr(lamp, "normalize", True) else 1))
    _emitter(context, name, thing, {**shape, "to_world": m}, radiance)


def _emitter(
    context: Context, name: str, thing: bpy.types.Object, shape: dict[str, Any], radiance: NDArray[np.float64]
) -> None:
    """A shape that emits, and that light passes: lamps throw no shadows."""
    if context.clear is None:
        context.clear = context.material("lamp", {"material": "interface"})
    emission = context.add("nodes", name, {"light": "area", "radiance": radiance})
    context.add("shapes", thing.name, {**shape, "material": context.clear, "emission": emission})
    if thing.visible_camera:
        context.emitters.append(thing.name)
        return
    m = shape["to_world"]
    is_ball = shape["shape"] == "sphere"
    radius = shape["radius"] if is_ball else float(np.linalg.norm(m[:3, 0]) + np.linalg.norm(m[:3, 1]))
    context.lamps.append(Lamp(thing.name, m[:3, 3], radius, None if is_ball else m[:3, 2] / np.linalg.norm(m[:3, 2])))
