"""A dependency graph as a dictionary for `steradian.scene`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np

from . import camera, instances, lamps, matrix, world
from .context import Context
from .image import Images
from .report import Report

FILTERS = {"BOX": "box", "GAUSSIAN": "gaussian", "BLACKMAN_HARRIS": "blackman_harris"}


@dataclass
class Exported:
    """A scene as a dictionary for `steradian.scene`, and how it is to be rendered.

    Lamps that the camera would see, but does not see in Blender, are hidden by an option of methods. It hides the
    background, too, which is then rendered by itself, to go behind the picture.
    """

    description: dict[str, Any]
    lamps: list[lamps.Lamp]
    emitters: list[str]
    around: dict[str, Any]
    is_transparent: bool

    @property
    def camera(self) -> dict[str, Any] | None:
        """The camera that is looked through."""
        return next(iter(self.description.get("cameras", {}).values()), None)

    @property
    def seen_lamps(self) -> list[str]:
        """Names of lamps that the camera would see."""
        camera = self.camera
        return [lamp.name for lamp in self.lamps if camera is not None and lamps.in_view(lamp, camera)]

    @property
    def kept_by(self) -> str | None:
        """Why lamps in view cannot be hidden; None where they can."""
        if self.emitters:
            return f"'{self.emitters[0]}' shines, too, and is to be seen"
        if "media" in self.description and self.around and not self.is_transparent:
            return "there is a background behind media"
        return None

    @property
    def hides_lamps(self) -> bool:
        """True if the method has to hide lamps from the camera."""
        return bool(self.seen_lamps) and self.kept_by is None

    @property
    def background(self) -> dict[str, Any] | None:
        """The scene of what is behind everything, where it has to be rendered by itself."""
        if not self.around or self.is_transparent or not self.hides_lamps:
            return None
        return {
            "cameras": self.description["cameras"],
            "lights": self.around,
            **{k: self.description[k] for k in ("film", "filter")},
        }

    @property
    def how(self) -> dict[str, bool]:
        """What the choice of a method needs to know."""
        return {"hides_lamps": self.hides_lamps, "media": "media" in self.description}


class Exporter:
    """Makes descriptions, and keeps what does not change from one to the next: meshes and pictures."""

    def __init__(self, report: Report | None = None):
        self.report = report or Report()
        self.images = Images()
        self.meshes = instances.Meshes()

    def export(
        self,
        depsgraph: bpy.types.Depsgraph,
        size: tuple[int, int] | None = None,
        *,
        view: dict[str, Any] | None = None,
        frame_set: Any = None,
    ) -> Exported:
        """The scene of a dependency graph; `view` is a camera instead of the scene's own.

        With `frame_set(frame, subframe)` motion blur is exported where the scene has it: what moves is looked at
        as the shutter opens and as it closes.
        """
        scene = depsgraph.scene_eval
        size = size or frame_size(scene)
        is_blurred = frame_set is not None and scene.render.use_motion_blur
        moved, eye, now = self._moved(depsgraph, frame_set) if is_blurred else (None, None, 0.0)
        context = Context(depsgraph, self.report, self.images)
        context.sun_distance = _sun_distance(depsgraph)
        if view is not None:
            context.add("cameras", "view", view)
        elif scene.camera is not None:
            camera.export(context, scene.camera.evaluated_get(depsgraph), size, eye)
        world.export(context, getattr(depsgraph.view_layer_eval, "world_override", None) or scene.world)
        around = dict(context.sections["lights"])
        instances.export(context, self.meshes, moved)
        self.meshes.sweep()
        if is_blurred:
            frame_set(*_moment(now))
        description = {**context.description(), **settings(scene, size)}
        exported = Exported(description, context.lamps, context.emitters, around, scene.render.film_transparent)
        if view is None and exported.kept_by is not None:
            for name in exported.seen_lamps:
                self.report(name, f"is seen by the camera: {exported.kept_by}")
        return exported

    def _moved(self, depsgraph: bpy.types.Depsgraph, frame_set: Any) -> tuple[Any, Any, float]:
        """Places of objects and of the camera as the shutter opens and as it closes, and the frame; the graph is left in between."""
        scene = depsgraph.scene
        now = scene.frame_current + scene.frame_subframe
        shutter = scene.render.motion_blur_shutter
        begin = now - {"START": 0.0, "CENTER": 0.5, "END": 1.0}[scene.render.motion_blur_position] * shutter
        places, eyes = [], []
        for time in (begin, begin + shutter):
            frame_set(*_moment(time))
            places.append(instances.places(depsgraph))
            eyes.append(matrix.array(scene.camera.evaluated_get(depsgraph).matrix_world) if scene.camera else np.eye(4))
        frame_set(*_moment(begin + shutter / 2))
        both = {key: (place, places[1][key]) for key, place in places[0].items() if key in places[1]}
        return both, tuple(eyes), now


def _moment(time: float) -> tuple[int, float]:
    frame = int(np.floor(time))
    return frame, float(min(max(time - frame, 0.0), 1.0))


def frame_size(scene: bpy.types.Scene) -> tuple[int, int]:
    """Size of the whole frame in pixels, with the percentage."""
    part = scene.render.resolution_percentage / 100
    return max(int(scene.render.resolution_x * part), 1), max(int(scene.render.resolution_y * part), 1)


def settings(scene: bpy.types.Scene, size: tuple[int, int]) -> dict[str, Any]:
    """Film and pixel filter."""
    own = getattr(scene, "steradian", None)
    film: dict[str, Any] = {"film": "rgb", "width": size[0], "height": size[1]}
    if own is not None and own.clamp > 0:
        film["max_component"] = own.clamp
    kind = FILTERS[own.filter if own is not None else "BLACKMAN_HARRIS"]
    width = own.filter_width if own is not None else 1.5
    radius = 0.5 if kind == "box" else width / 2
    entry: dict[str, Any] = {"filter": kind, "radius_x": radius, "radius_y": radius}
    if kind == "gaussian":
        entry["sigma"] = width / 12
    return {"film": film, "filter": entry}


def _sun_distance(depsgraph: bpy.types.Depsgraph) -> float:
    """How far away discs of suns are: a power of ten, a hundred times the size of the scene or more."""
    reach = 1.0
    for thing in depsgraph.objects:
        if thing.type in instances.GEOMETRY and len(thing.bound_box):
            corners = np.array(thing.bound_box) @ np.array(thing.matrix_world.to_3x3()).T + np.array(
                thing.matrix_world.translation
            )
            reach = max(reach, float(np.abs(corners).max()))
    return float(10 ** np.ceil(np.log10(reach * 100)))
