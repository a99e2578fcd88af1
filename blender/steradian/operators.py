"""Operators: the scene as a file, and in the renderer's own viewer."""

from __future__ import annotations

import os
import tempfile
from typing import Any

import bpy
from bpy.props import BoolProperty, StringProperty

from .engine import library, tell
from .export.report import Report
from .export.scene import Exporter

_views: list[Any] = []


class STERADIAN_OT_open(bpy.types.Operator):
    """Write the scene as a file, and show it in Steradian's own viewer in the browser"""

    bl_idname = "steradian.open"
    bl_label = "Open in Steradian"

    filepath: StringProperty(
        name="File", description="Scene file to write; a temporary one if it is empty", subtype="FILE_PATH"
    )
    show: BoolProperty(name="Show", description="Start the viewer", default=True)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Exports, saves and shows."""
        report = Report(lambda line: self.report({"WARNING"}, line))
        depsgraph = context.evaluated_depsgraph_get()
        exporter = Exporter(report)
        path = bpy.path.abspath(self.filepath) or os.path.join(
            tempfile.mkdtemp(prefix="steradian-"), f"{context.scene.name}.steradian"
        )
        try:
            compiled = library().scene(exporter.export(depsgraph).description)
            compiled.save(path, overwrite=True)
            tell(compiled, report)
            if self.show:
                _views.append((compiled.view(), exporter))
        except (ValueError, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.report({"INFO"}, f"Written to {path}")
        return {"FINISHED"}


CLASSES = (STERADIAN_OT_open,)


def _menu(self: Any, context: bpy.types.Context) -> None:
    if context.engine == "STERADIAN":
        self.layout.operator(STERADIAN_OT_open.bl_idname)


def register() -> None:
    """Adds the operator to the menu Render."""
    if hasattr(bpy.types, "TOPBAR_MT_render"):
        bpy.types.TOPBAR_MT_render.append(_menu)


def unregister() -> None:
    """Takes it away, and ends views that it began."""
    if hasattr(bpy.types, "TOPBAR_MT_render"):
        bpy.types.TOPBAR_MT_render.remove(_menu)
    while _views:
        _views.pop()[0].close()
