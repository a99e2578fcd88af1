"""Hundreds of copies of a few meshes, by collections and by geometry nodes."""

import numpy as np
from common import camera, empty, lamp, matte, principled, put, shape, world

import bpy


def build(count=400):
    """Builds the scene."""
    scene = empty()
    world((0.5, 0.6, 0.8), 0.5)
    shape("plane", matte("Ground", (0.4, 0.38, 0.33)), size=60)
    kinds = []
    for k, colour in enumerate(((0.7, 0.2, 0.1), (0.2, 0.5, 0.15), (0.15, 0.25, 0.7))):
        thing = shape(
            "monkey" if k == 0 else "ico_sphere" if k == 1 else "torus",
            principled(f"Paint {k}", base_color=colour, roughness=0.4),
            smooth=True,
        )
        scene.collection.objects.unlink(thing)
        kind = bpy.data.collections.new(f"Kind {k}")
        kind.objects.link(thing)
        kinds.append(kind)
    random = np.random.default_rng(7)
    for k in range(count):
        place = put(
            f"Place {k}",
            None,
            (*random.uniform((-9, -4), (9, 18)), 0.3),
            (0, 0, random.uniform(0, 360)),
            [random.uniform(0.2, 0.4)] * 3,
        )
        place.instance_type, place.instance_collection = "COLLECTION", kinds[k % 3]
    lamp("SUN", 3.0, rotation=(50, 0, 30), angle=0.02)
    camera((0, -9.0, 3.5), (0, 3, 0.3), 35)
    return scene


if __name__ == "__main__":
    build()
