"""OpenVDB volumes as media in boxes."""

from __future__ import annotations

import os
from typing import Any

import bpy
import numpy as np

from . import surface
from .context import Context
from .matrix import array

# Corners of a box by bits, and its triangles, outwards.
CORNERS = np.array([[i & 1, i >> 1 & 1, i >> 2 & 1] for i in range(8)], np.float64)
FACES = [
    [0, 2, 1],
    [1, 2, 3],
    [4, 5, 6],
    [5, 7, 6],
    [0, 1, 4],
    [1, 5, 4],
    [2, 6, 3],
    [3, 6, 7],
    [0, 4, 2],
    [2, 4, 6],
    [1, 3, 5],
    [3, 7, 5],
]


def parts(context: Context, thing: bpy.types.Object) -> list[dict[str, Any]]:
    """The box around a volume, with the medium of its file; the coefficients are those of its material."""
    data = thing.data
    path = bpy.path.abspath(data.filepath, library=data.library)
    if data.packed_file or not os.path.isfile(path):
        context.report(thing.name, f"the volume file '{data.filepath}' is not there")
        return []
    if data.is_sequence:
        context.report(thing.name, "of a sequence of volumes the first file is read")
    of = surface.of_slot(context, thing, 0)
    place = array(thing.matrix_world)
    entry = dict(context.sections["media"].get(of.get("interior", ""), {"sigma_s": 0.5, "sigma_a": 0.5}))
    medium = {
        key: value
        for key, value in entry.items()
        if key in {"sigma_a", "sigma_s", "sigma_t", "albedo", "g", "phase", "Lescale"}
    }
    scale = abs(float(np.linalg.det(place[:3, :3]))) ** (-1 / 3) if data.render.space == "OBJECT" else 1.0
    medium = {
        "medium": "vdb",
        "file": {"file": path},
        "to_world": place,
        "scale": scale * entry.get("scale", 1.0),
        **medium,
    }
    low, high = np.array(thing.bound_box).min(axis=0), np.array(thing.bound_box).max(axis=0)
    box = {"positions": low + CORNERS * (high - low), "triangles": np.array(FACES)}
    if context.clear is None:
        context.clear = context.material("boundary", {"material": "interface"})
    return [{"shape": "mesh", "mesh": box, "material": context.clear, "interior": context.medium(thing.name, medium)}]
