"""Drawing of the viewport's picture by Blender's gpu module."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np

from .export.report import Report
from .viewport import Session

INTERVAL = 0.04
_sessions: dict[int, Session] = {}
_drawn: dict[int, int] = {}


def session(owner: bpy.types.RenderEngine) -> Session:
    """The session of an engine, which lasts until the engine goes."""
    found = _sessions.get(id(owner))
    if found is None:
        found = _sessions[id(owner)] = Session(Report())
        if not bpy.app.timers.is_registered(_tick):
            bpy.app.timers.register(_tick, first_interval=INTERVAL)
    return found


def _tick() -> float | None:
    """Asks for a redraw where a session has a new picture; Blender calls it in its main thread, as long as there are sessions."""
    is_new = False
    for key, each in _sessions.items():
        is_new |= _drawn.get(key) != each.count
        _drawn[key] = each.count
    if is_new:
        for window in bpy.context.window_manager.windows:
            for area in window.screen.areas:
                if area.type == "VIEW_3D":
                    area.tag_redraw()
    return INTERVAL if _sessions else None


def forget(owner: int) -> None:
    """Ends the session of an engine, by its id."""
    found = _sessions.pop(owner, None)
    _drawn.pop(owner, None)
    if found is not None:
        found.close()


def update(owner: bpy.types.RenderEngine, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
    """Takes over changes of the scene."""
    session(owner).update(depsgraph)
    _look(owner, context)


def _look(owner: bpy.types.RenderEngine, context: bpy.types.Context) -> None:
    view = context.region_data
    session(owner).camera(view.view_matrix, view.window_matrix, (context.region.width, context.region.height))


def draw(owner: bpy.types.RenderEngine, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
    """Draws the newest picture over the region."""
    import gpu
    from gpu_extras.presets import draw_texture_2d

    _look(owner, context)
    own = session(owner)
    if own.error is not None:
        owner.update_stats("Steradian", own.error)
        return
    found: Any = own.picture() or own.last()
    if found is None:
        return
    picture, spp = found
    height, width = picture.shape[:2]
    pixels = gpu.types.Buffer("FLOAT", width * height * 4, np.ascontiguousarray(picture, np.float32).ravel())
    texture = gpu.types.GPUTexture((width, height), format="RGBA16F", data=pixels)
    gpu.state.blend_set("ALPHA_PREMULT")
    owner.bind_display_space_shader(depsgraph.scene)
    draw_texture_2d(texture, (0, 0), context.region.width, context.region.height)
    owner.unbind_display_space_shader()
    gpu.state.blend_set("NONE")
    owner.update_stats("Steradian", f"Samples {spp}" if spp else "Coarse picture")
