"""The render engine that Blender calls."""

from __future__ import annotations

import os
import tempfile
import time
from typing import Any

import bpy
import numpy as np

from . import passes, settings
from .export.report import Report
from .export.scene import Exported, Exporter, frame_size


def library() -> Any:
    """The renderer's Python module."""
    import warnings

    import steradian

    warnings.filterwarnings("ignore", category=steradian.SceneWarning)
    return steradian


class SteradianEngine(bpy.types.RenderEngine):
    """Steradian as a render engine."""

    bl_idname = "STERADIAN"
    bl_label = "Steradian"
    bl_use_preview = True
    bl_use_postprocess = True
    bl_use_shading_nodes_custom = False
    bl_use_eevee_viewport = True
    bl_use_gpu_context = False

    def _report(self) -> Report:
        def tell(line: str) -> None:
            print(f"Steradian: {line}")
            self.report({"WARNING"}, line)

        return Report(tell)

    def update_render_passes(
        self, scene: bpy.types.Scene | None = None, renderlayer: bpy.types.ViewLayer | None = None
    ) -> None:
        """Tells Blender which passes there are."""
        self.register_pass(scene, renderlayer, "Combined", 4, "RGBA", "COLOR")
        for each in passes.wanted(renderlayer, scene):
            self.register_pass(scene, renderlayer, each.name, len(each.channels), each.channels, each.kind)

    def render(self, depsgraph: bpy.types.Depsgraph) -> None:
        """Renders a view layer of a frame."""
        try:
            self._render(depsgraph)
        except (ValueError, RuntimeError, OSError) as error:
            self.error_set(f"Steradian: {error}")

    def _render(self, depsgraph: bpy.types.Depsgraph) -> None:
        scene, view_layer = depsgraph.scene, depsgraph.view_layer
        report = self._report()
        for name in passes.missing(view_layer):
            report(view_layer.name, f"there is no pass {name}")
        if scene.render.use_multiview:
            report(scene.name, "is rendered by one eye: there are no views of stereoscopy")
        self.update_stats("Steradian", "Reading the scene")
        exporter = Exporter(report)
        size = frame_size(scene)
        exported = exporter.export(depsgraph, size, frame_set=lambda frame, part: self.frame_set(frame, subframe=part))
        if not exported.description.get("cameras"):
            self.error_set("Steradian: the scene has no camera")
            return
        self.update_stats("Steradian", "Compiling the scene")
        compiled = library().scene(exported.description)
        tell(compiled, report)
        self._frame(compiled, exported, scene, view_layer, size, report)
        tell(compiled, report)

    def _frame(
        self, compiled: Any, exported: Exported, scene: Any, view_layer: Any, size: tuple[int, int], report: Report
    ) -> None:
        """Renders in steps of growing numbers of samples, each of which Blender shows."""
        wanted = [] if self.is_preview else passes.wanted(view_layer, scene)
        own, transparent = scene.steradian, scene.render.film_transparent
        denoiser = None if own.denoiser == "none" or self.is_preview else own.denoiser
        groups = any(each.layer == "light_groups" for each in wanted)
        frame: dict[str, Any] = {"size": size}
        if (crop := border(scene, size)) is not None:
            frame["crop"] = crop
        behind = background(exported, frame)
        options = (
            settings.options(scene, is_preview=self.is_preview, groups=groups, **exported.how)
            | frame
            | {
                "transparent": transparent,
                "layers": passes.layers(wanted, alpha=transparent or behind is not None, denoise=denoiser is not None),
            }
        )
        for each in wanted:
            self.add_pass(each.name, len(each.channels), each.channels, layer=view_layer.name)

        def show(image: Any) -> None:
            result = self.begin_result(0, 0, image.width, image.height, layer=view_layer.name)
            found = result.layers[0].passes
            put(found["Combined"], passes.combined(image, transparent=transparent, background=behind))
            for each in wanted:
                if each.name in found:
                    put(found[each.name], passes.values(image, each))
            self.end_result(result)

        with tempfile.TemporaryDirectory(prefix="steradian-") as folder:
            image = self._steps(compiled, options, show, os.path.join(folder, "state"))
        if image is not None and denoiser and not self.test_break():
            self.update_stats("Steradian", "Removing noise")
            show(_denoised(image, denoiser, report))

    def _steps(self, compiled: Any, options: dict[str, Any], show: Any, state: str) -> Any:
        """Shows pictures of more and more samples; the last one."""
        spp, limit, begin, image = options.get("spp"), options.get("time"), time.monotonic(), None

        def progress(now: Any) -> bool:
            self.update_progress(min(now.spp / spp, 1.0) if spp else now.fraction)
            self.update_stats("Steradian", f"Samples {now.spp:.0f} of {spp or 'a preview'}")
            return not self.test_break()

        parts = steps(spp, can_go_on=not options.get("adaptive") and "error" not in options and not self.is_preview)
        for part in parts:
            now = dict(options)
            if part is not None:
                now["spp"] = part
            if limit is not None:
                now["time"] = limit - (time.monotonic() - begin)
                if now["time"] <= 0 and image is not None:
                    break
            if len(parts) > 1:
                now["resume"] = state
            try:
                image = compiled.render(progress=progress, **now)
            except ValueError:
                if self.test_break():
                    break
                raise
            show(image)
            if image.stopped or self.test_break():
                break
        return image

    def __del__(self) -> None:
        from . import viewport_draw

        viewport_draw.forget(id(self))
        if (inherited := getattr(super(), "__del__", None)) is not None:
            inherited()

    def view_update(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        """Takes over changes of the scene into the viewport."""
        from . import viewport_draw

        viewport_draw.update(self, context, depsgraph)

    def view_draw(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        """Draws the picture that there is into the viewport."""
        from . import viewport_draw

        viewport_draw.draw(self, context, depsgraph)


def background(exported: Exported, frame: dict[str, Any]) -> Any:
    """Picture of what is behind everything, rows from the top, where it is rendered apart."""
    if exported.background is None:
        return None
    image = library().scene(exported.background).render(spp=16, integrator="path", color="rgb", **frame)
    return np.stack([image["R"], image["G"], image["B"]], axis=-1)


def put(target: bpy.types.RenderPass, values: Any) -> None:
    """Writes rows from the bottom into a pass."""
    target.rect.foreach_set(np.ascontiguousarray(values, np.float32).ravel())


def tell(compiled: Any, report: Report) -> None:
    """Reports what the renderer says of a scene."""
    for message in compiled.messages:
        if message.kind != "note":
            report("Scene", message.message)


def steps(spp: int | None, *, can_go_on: bool) -> list[int | None]:
    """Numbers of samples after which a picture is shown: a 64th, a 16th, a quarter, and all."""
    if spp is None or not can_go_on:
        return [spp]
    return [*sorted({max(spp // part, 1) for part in (64, 16, 4)} - {spp}), spp]


def border(scene: bpy.types.Scene, size: tuple[int, int]) -> list[int] | None:
    """The part of the frame to render, x0 y0 x1 y1 from the top left corner; None for all of it."""
    render = scene.render
    if not render.use_border:
        return None
    x0, x1 = (int(size[0] * at) for at in (render.border_min_x, render.border_max_x))
    y0, y1 = (int(size[1] * at) for at in (render.border_min_y, render.border_max_y))
    if x1 <= x0 or y1 <= y0:
        return None
    return [x0, size[1] - y1, x1, size[1] - y0]


def _denoised(image: Any, method: str, report: Report) -> Any:
    try:
        return image.denoise(method)
    except (ValueError, RuntimeError, OSError) as error:
        report("Denoiser", f"{error}; the renderer's own is taken")
        return image.denoise("nlm")
