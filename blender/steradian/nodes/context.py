"""A context of the least that reading node trees needs: for tests, and for translating one material."""

from __future__ import annotations

import os
import tempfile


class Context:
    """Keeps reports, and the names of attributes that meshes have to have. Pictures that are in no file are written into
    a folder which lives as long as this object. `object` is the one whose coordinates count."""

    def __init__(self, uv_map=None, thing=None):
        self.reports: list[tuple[str, str]] = []
        self.uv_map, self.object = uv_map, thing
        self.attributes: set[str] = set()
        self.textures: dict[str, dict] = {}
        self.materials: dict[str, dict] = {}
        self._folder = None

    def report(self, name: str, text: str):
        self.reports.append((name, text))

    def texture(self, name: str, entry: dict) -> str:
        return self._named(self.textures, name, entry)

    def material(self, name: str, entry: dict) -> str:
        return self._named(self.materials, name, entry)

    def _named(self, table, name, entry):
        free = name
        while free in table and table[free] != entry:
            free += "'"
        table[free] = entry
        return free

    def image(self, image):
        """The file of a picture."""
        import bpy

        path = bpy.path.abspath(image.filepath_raw, library=image.library)
        if image.source == "FILE" and not image.packed_file and not image.is_dirty and os.path.isfile(path):
            return path
        if not image.has_data and not len(image.pixels):
            return None
        self._folder = self._folder or tempfile.TemporaryDirectory(prefix="steradian-")
        path = os.path.join(self._folder.name, f"{image.session_uid}{'.exr' if image.is_float else '.png'}")
        if image.is_float:
            _write_floats(image, path)
            return path
        # A copy of an image has not what was painted into it.
        before, image.file_format = image.file_format, "PNG"
        try:
            image.save(filepath=path, save_copy=True)
        finally:
            image.file_format = before
        return path


def _write_floats(image, path):
    """Pixels as they are: Blender's own writer would encode some."""
    import numpy as np
    import steradian as st

    width, height = image.size
    pixels = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    rows = pixels.reshape(height, width, image.channels)[::-1]
    planes = {name: np.ascontiguousarray(rows[..., i]) for i, name in enumerate("RGBA"[:image.channels])}
    st.Image(planes).save(path, half=False, overwrite=True)
