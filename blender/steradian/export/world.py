"""Worlds: the background's colour, pictures around and skies."""

from __future__ import annotations

import math
from typing import Any

import bpy
import numpy as np

from .. import nodes
from .context import Context
from .matrix import array

# From a latlong whose up is +y, as the scene language has it, to Blender's, whose up is +z and whose middle is at +x.
LATLONG = np.array([[0.0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]])


def export(context: Context, world: bpy.types.World | None) -> None:
    """Adds the light of a world."""
    if world is None:
        return
    name = world.lightgroup or world.name
    tree = world.node_tree if bpy.app.version >= (5, 0) or world.use_nodes else None
    output = next((n for n in tree.nodes if n.type == "OUTPUT_WORLD" and n.is_active_output), None) if tree else None
    if output is None:
        _constant(context, name, list(world.color))
        return
    if output.inputs["Volume"].is_linked:
        context.report(world.name, "the volume of the world is left out")
    surface = _linked(output.inputs["Surface"])
    if surface is None:
        return
    found = _picture_or_sky(surface, set())
    strength = _number(context, surface.inputs["Strength"]) if surface.type == "BACKGROUND" else 1.0
    if found is None:
        _constant(context, name, list(nodes.world_colour(world, context)))
    elif strength > 0:
        if surface.type != "BACKGROUND" or _linked(surface.inputs["Color"]) != found:
            context.report(world.name, f"what is between '{found.name}' and the output is left out")
        (_sky if found.type == "TEX_SKY" else _picture)(context, name, found, strength)


def _picture_or_sky(node: bpy.types.Node | None, seen: set[str]) -> bpy.types.Node | None:
    """The first picture or sky that a node gets its colour from."""
    if node is None or node.name in seen:
        return None
    seen.add(node.name)
    if node.type in {"TEX_ENVIRONMENT", "TEX_SKY"}:
        return node
    found = (_picture_or_sky(_linked(socket), seen) for socket in node.inputs if socket.is_linked)
    return next((each for each in found if each is not None), None)


def _linked(socket: bpy.types.NodeSocket) -> bpy.types.Node | None:
    """The node that a socket is linked to, through reroutes."""
    while socket.is_linked:
        node = socket.links[0].from_node
        if node.type != "REROUTE":
            return node
        socket = node.inputs[0]
    return None


def _number(context: Context, socket: bpy.types.NodeSocket) -> float:
    node = _linked(socket)
    if node is not None and node.type == "VALUE":
        return float(node.outputs[0].default_value)
    if node is not None:
        context.report(node.name, f"the link to '{socket.name}' is not followed")
    return float(socket.default_value)


def _constant(context: Context, name: str, colour: list[float]) -> None:
    if any(colour):
        context.add("lights", name, {"light": "environment", "radiance": colour})


def _picture(context: Context, name: str, node: bpy.types.Node, strength: float) -> None:
    path = context.image(node.image) if node.image else None
    if path is None:
        _constant(context, name, [strength, 0.0, strength])
        return
    if node.projection != "EQUIRECTANGULAR":
        context.report(node.name, f"the projection {node.projection.lower()} is read as equirectangular")
    space = node.image.colorspace_settings.name
    entry: dict[str, Any] = {
        "light": "environment",
        "file": {"file": path},
        "parametrization": "latlong",
        "scale": strength,
        "to_world": np.linalg.inv(_mapping(context, node)) @ LATLONG,
        "encoding": "srgb" if space == "sRGB" else "linear",
    }
    context.add(
        "lights", name, {key: value for key, value in entry.items() if key != "encoding" or not node.image.is_float}
    )


def _mapping(context: Context, node: bpy.types.Node) -> Any:
    """Matrix from directions of the world to those that a texture is looked up in."""
    mapping = _linked(node.inputs["Vector"])
    if mapping is None or mapping.type == "TEX_COORD":
        return np.eye(4)
    if mapping.type != "MAPPING" or any(
        mapping.inputs[k].is_linked for k in ("Rotation", "Scale") if k in mapping.inputs
    ):
        context.report(mapping.name, "is not read: the picture is not turned")
        return np.eye(4)
    from mathutils import Euler

    scale = np.array(mapping.inputs["Scale"].default_value)
    if not np.allclose(np.abs(scale), abs(scale[0])) or np.any(
        np.array(mapping.inputs["Location"].default_value) if "Location" in mapping.inputs else 0
    ):
        context.report(mapping.name, "of its mapping the rotation is read alone")
    turn = array(Euler(mapping.inputs["Rotation"].default_value).to_matrix().to_4x4())
    turn = turn @ np.diag([*np.sign(scale), 1.0])
    return np.linalg.inv(turn) if mapping.vector_type == "TEXTURE" else turn


# Blender's single and multiple scattering in terms of ours: radiance per band, and the optical depth and albedo of its aerosols.
AIR, AEROSOL, AEROSOL_ALBEDO = 93.0, 0.05, 0.6
# Preetham's sky in terms of the one of Hosek and Wilkie.
PREETHAM = 6.8


def _sky(context: Context, name: str, node: bpy.types.Node, strength: float) -> None:
    if _linked(node.inputs["Vector"]) is not None if "Vector" in node.inputs else False:
        context.report(node.name, "its sky is not turned")
    if node.sky_type in {"PREETHAM", "HOSEK_WILKIE"}:
        factor = 1.0
        context.report(node.name, "is black below the horizon")
        if node.sky_type == "PREETHAM":
            context.report(node.name, "the sky of Preetham is approximated by that of Hosek and Wilkie")
            factor = PREETHAM
        context.add(
            "lights",
            name,
            {
                "light": "sky",
                "sun_direction": list(node.sun_direction),
                "turbidity": min(max(node.turbidity, 1.0), 10.0),
                "albedo": node.ground_albedo,
                "scale": strength * factor,
                "sun_scale": 0.0,
            },
        )
        return
    context.report(node.name, "its air is simulated anew: its light is near Cycles', not the same")
    height, turn = node.sun_elevation, node.sun_rotation
    dust = getattr(node, "aerosol_density", getattr(node, "dust_density", 1.0))
    context.add(
        "lights",
        name,
        {
            "light": "atmosphere",
            "sun_direction": [math.sin(turn) * math.cos(height), math.cos(turn) * math.cos(height), math.sin(height)],
            "altitude": min(max(node.altitude, 0.0), 50000.0),
            "pressure": min(1013.25 * node.air_density, 5000.0),
            "ozone": min(300.0 * node.ozone_density, 2000.0),
            "aerosol": min(AEROSOL * dust, 5.0),
            "aerosol_albedo": AEROSOL_ALBEDO,
            "scattering": "single" if node.sky_type in {"SINGLE_SCATTERING", "NISHITA"} else "multiple",
            "scale": AIR * strength,
            "sun_scale": node.sun_intensity if node.sun_disc else 0.0,
            "sun_aperture": min(max(math.degrees(node.sun_size), 0.01), 89.0),
        },
    )
