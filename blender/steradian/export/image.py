"""Pictures of Blender as files that the renderer reads."""

from __future__ import annotations

import os
import struct
import tempfile
import zlib
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from .report import Report

READABLE = {".png", ".jpg", ".jpeg", ".exr", ".hdr", ".tga", ".bmp", ".tif", ".tiff", ".pfm", ".dds", ".ktx2", ".ppm"}


class Images:
    """Paths of pictures. Packed, generated and painted ones are written into a folder that lives as long as this object.

    Nothing of Blender's data is changed: renders run beside its window.
    """

    def __init__(self) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="steradian-")
        self._known: dict[tuple[object, ...], str] = {}

    def path(self, image: bpy.types.Image, report: Report) -> str | None:
        """File of a picture; None where there is none, which is told."""
        image = image.original
        if image.source in {"TILED", "MOVIE", "SEQUENCE"}:
            report(image.name, f"a picture of kind {image.source.lower()} is read as its first file")
        path = bpy.path.abspath(image.filepath_raw, library=image.library).replace("<UDIM>", "1001")
        extension = os.path.splitext(path)[1].lower()
        is_file = not image.is_dirty and image.source != "GENERATED" and extension in READABLE
        if is_file and not image.packed_file and os.path.isfile(path):
            return path
        if is_file and image.packed_file:
            return self._kept(
                (image.session_uid, "packed", image.packed_file.size), extension, bytes(image.packed_file.data)
            )
        if not len(image.pixels):
            report(image.name, f"the file '{image.filepath_raw}' is not there, or cannot be read")
            return None
        return self._written(image)

    def _kept(self, key: tuple[object, ...], extension: str, data: bytes) -> str:
        if key not in self._known:
            self._known[key] = os.path.join(self._folder.name, f"{len(self._known):04}{extension}")
            with open(self._known[key], "wb") as file:
                file.write(data)
        return self._known[key]

    def _written(self, image: bpy.types.Image) -> str:
        """A picture by its pixels: floats as OpenEXR, bytes as PNG."""
        width, height = image.size
        pixels = np.empty(width * height * image.channels, np.float32)
        image.pixels.foreach_get(pixels)
        rows = np.flipud(pixels.reshape(height, width, image.channels))
        key = (image.session_uid, zlib.crc32(pixels.tobytes()), width)
        if not image.is_float:
            return self._kept(key, ".png", png((rows * 255).round().astype(np.uint8)))
        if key not in self._known:
            import steradian

            self._known[key] = os.path.join(self._folder.name, f"{len(self._known):04}.exr")
            names: list[Any] = (
                ["R", "G", "B", "A"][: image.channels] if image.channels >= 3 else ["Y", "A"][: image.channels]
            )
            planes = {name: np.ascontiguousarray(rows[..., k]) for k, name in enumerate(names)}
            if image.channels < 3:
                planes = {name: planes["Y"] for name in "RGB"}
            steradian.Image(planes).save(self._known[key])
        return self._known[key]


def png(rows: NDArray[np.uint8]) -> bytes:
    """The bytes of a PNG file of rows from the top, height × width × 1 to 4 channels of stored values."""
    height, width, channels = rows.shape

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, {1: 0, 2: 4, 3: 2, 4: 6}[channels], 0, 0, 0)
    lines = np.concatenate([np.zeros((height, 1), np.uint8), rows.reshape(height, -1)], axis=1)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", head)
        + chunk(b"IDAT", zlib.compress(lines.tobytes(), 1))
        + chunk(b"IEND", b"")
    )
