"""A ball with fur, of a hair curves object."""

import numpy as np
from common import camera, empty, lamp, matte, put, shape, world

import bpy


def build(strands=4000, points=6):
    """Builds the scene."""
    scene = empty()
    world((0.35, 0.4, 0.5), 0.6)
    shape("plane", matte("Ground", (0.5, 0.48, 0.45)), size=12)
    shape("uv_sphere", matte("Skin", (0.3, 0.2, 0.15)), smooth=True, radius=0.98, location=(0, 0, 1.2))
    random = np.random.default_rng(1)
    root = random.normal(size=(strands, 3))
    root /= np.linalg.norm(root, axis=1, keepdims=True)
    bend = np.array([0.3, 0.0, -0.5]) + random.normal(scale=0.15, size=(strands, 3))
    along = np.linspace(0, 1, points)[None, :, None]
    at = root[:, None] * (0.97 + 0.45 * along) + bend[:, None] * 0.35 * along**2
    data = bpy.data.hair_curves.new("Fur")
    data.add_curves([points] * strands)
    data.position_data.foreach_set("vector", at.astype(np.float32).ravel())
    radius = data.attributes.get("radius") or data.attributes.new("radius", "FLOAT", "POINT")
    radius.data.foreach_set("value", np.tile(np.linspace(0.009, 0.001, points), strands).astype(np.float32))
    data.materials.append(matte("Hair", (0.45, 0.25, 0.1)))
    put("Fur", data, (0, 0, 1.2))
    lamp("AREA", 250, (3, -3, 5), (40, 0, 45), size=1.0)
    camera((0, -5.5, 2.0), (0, 0, 1.2), 40)
    return scene


if __name__ == "__main__":
    build()
