"""Pictures of Blender as files that the renderer reads."""

from __future__ import annotations

import os
import tempfile

import bpy

from .report import Report

READABLE = {".png", ".jpg", ".jpeg", ".exr", ".hdr", ".tga", ".bmp", ".tif", ".tiff", ".pfm", ".dds", ".ktx2", ".ppm"}


class Images:
    """Paths of pictures. Packed, generated and painted ones are written into a folder that lives as long as this object."""

    def __init__(self) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="steradian-")
        self._known: dict[tuple[object, ...], str] = {}

    def path(self, image: bpy.types.Image, report: Report) -> str | None:
        """File of a picture; None where there is none, which is told."""
        image = image.original
        if image.source in {"TILED", "MOVIE", "SEQUENCE"}:
            report(image.name, f"a picture of kind {image.source.lower()} is read as its first file")
        path = bpy.path.abspath(image.filepath_raw, library=image.library).replace("<UDIM>", "1001")
        is_file = not image.packed_file and not image.is_dirty and image.source != "GENERATED"
        if is_file and os.path.isfile(path) and os.path.splitext(path)[1].lower() in READABLE:
            return path
        return self._written(image, report)

    def _written(self, image: bpy.types.Image, report: Report) -> str | None:
        if not image.has_data and not image.packed_file and not len(image.pixels):
            report(image.name, f"the file '{image.filepath_raw}' is not there")
            return None
        key = (image.session_uid, image.is_dirty, tuple(image.size), image.generated_type, tuple(image.generated_color))
        if key not in self._known or image.is_dirty:
            extension, kind = (".exr", "OPEN_EXR") if image.is_float else (".png", "PNG")
            path = os.path.join(self._folder.name, f"{len(self._known):04}{extension}")
            copy = image.copy()
            try:
                copy.file_format = kind
                copy.save(filepath=path, save_copy=True)
            except RuntimeError as error:
                report(image.name, f"the picture cannot be written: {error}")
                return None
            finally:
                bpy.data.images.remove(copy)
            self._known[key] = path
        return self._known[key]
