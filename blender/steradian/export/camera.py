"""Cameras: the window that a projection matrix shows, lens and panorama."""

from __future__ import annotations

import math
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from . import matrix
from .context import Context


def export(
    context: Context, thing: bpy.types.Object, size: tuple[int, int], moved: tuple[Any, Any] | None = None
) -> None:
    """Adds the camera of a scene for pictures of a size; `moved` are its places at both ends of the exposure."""
    render = context.depsgraph.scene.render
    camera = thing.data
    begin, end = moved or (thing.matrix_world, thing.matrix_world)
    place = matrix.rigid(begin) @ matrix.FLIP
    if camera.type == "PANO":
        entry = _panorama(context, thing, place)
    else:
        window = matrix.array(
            thing.calc_matrix_camera(
                context.depsgraph,
                x=size[0],
                y=size[1],
                scale_x=render.pixel_aspect_x,
                scale_y=render.pixel_aspect_y,
            )
        )
        entry = projection(window, camera.clip_start, camera.clip_end)
        entry["to_world"] = place
        if camera.dof.use_dof:
            entry |= _lens(context, thing)
    if not np.allclose(begin, end, atol=1e-7):
        entry |= {
            "to_world_end": matrix.rigid(end) @ np.linalg.inv(matrix.rigid(begin)) @ entry["to_world"],
            "motion_times": [0.0, 1.0],
        }
    context.add("cameras", thing.name, entry)


def projection(window: NDArray[np.float64], near: float, far: float) -> dict[str, Any]:
    """Camera with the projection of a matrix of OpenGL, perspective or orthographic."""
    is_perspective = window[3, 3] == 0
    shift = window[:2, 2] if is_perspective else -window[:2, 3]
    low, high = (shift - 1) / window.diagonal()[:2], (shift + 1) / window.diagonal()[:2]
    entry: dict[str, Any] = {
        "camera": "perspective" if is_perspective else "orthographic",
        "screen_window": [low[0], high[0], low[1], high[1]],
        "near": max(near, 0.0),
        "far": far,
    }
    return entry | {"fov": 90.0} if is_perspective else entry


def _lens(context: Context, thing: bpy.types.Object) -> dict[str, Any]:
    camera, dof = thing.data, thing.data.dof
    if dof.aperture_blades > 0 or dof.aperture_ratio != 1:
        context.report(thing.name, "its aperture is round: blades and ratio are left out")
    unit = camera.lens * 1e-3 if camera.type == "PERSP" else 1.0
    distance = dof.focus_distance
    if dof.focus_object is not None:
        target = dof.focus_object.evaluated_get(context.depsgraph)
        point = target.matrix_world
        if dof.focus_subtarget and target.pose and dof.focus_subtarget in target.pose.bones:
            point = target.matrix_world @ target.pose.bones[dof.focus_subtarget].matrix
        axis = -matrix.rigid(thing.matrix_world)[:3, 2]
        distance = abs(float(axis @ (np.array(point.translation) - np.array(thing.matrix_world.translation))))
    return {"lens_radius": unit / (2 * max(dof.aperture_fstop, 1e-5)), "focal_distance": max(distance, 1e-5)}


def _panorama(context: Context, thing: bpy.types.Object, place: NDArray[np.float64]) -> dict[str, Any]:
    # Before Blender 5 these were settings of Cycles.
    camera = thing.data if hasattr(thing.data, "panorama_type") else getattr(thing.data, "cycles", None)
    if camera is None:
        return {"camera": "spherical", "mapping": "equirectangular", "to_world": place @ PANORAMA}
    if camera.panorama_type != "EQUIRECTANGULAR":
        context.report(thing.name, f"a panorama {camera.panorama_type.lower()} is rendered as equirectangular")
    ranges = (camera.longitude_min, camera.longitude_max, camera.latitude_min, camera.latitude_max)
    if not np.allclose(ranges, (-math.pi, math.pi, -math.pi / 2, math.pi / 2), atol=1e-4):
        context.report(thing.name, "shows all longitudes and latitudes")
    return {"camera": "spherical", "mapping": "equirectangular", "to_world": place @ PANORAMA}


# From the axes of the scene language's panorama, whose middle is at -x, to those of a camera.
PANORAMA = np.array([[0.0, 0, -1, 0], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1]])
