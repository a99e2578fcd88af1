"""Scenes that tests share."""

import numpy as np

BALL = {
    "film": {"film": "rgb", "width": 32, "height": 24},
    "materials": {"clay": {"material": "diffuse", "reflectance": {"rgb": [0.7, 0.3, 0.2]}}},
    "cameras": {"front": {"camera": "perspective", "fov": 40.0, "to_world": {"look_at": [0, 0, 0], "from": [0, 0, -4]}}},
    "lights": {"sky": {"light": "environment", "radiance": 1.0}},
    "shapes": [{"shape": "sphere", "radius": 1.0, "material": "clay"}],
}

# A unit square in the plane z = 0, of two triangles, seen from +z.
SQUARE = {
    "positions": np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], np.float32),
    "triangles": np.array([[0, 1, 2], [1, 3, 2]], np.uint32),
}


def of_mesh(mesh, **shape):
    """A scene of one mesh, `sheet`, under a white sky."""
    return {
        "film": {"film": "rgb", "width": 16, "height": 16},
        "materials": {"clay": {"material": "diffuse", "reflectance": (0.5, 0.25, 0.125)}},
        "camera": {"camera": "perspective", "fov": 20.0, "to_world": {"look_at": [0.5, 0.5, 0], "from": [0.5, 0.5, 4]}},
        "lights": {"sky": {"light": "environment", "radiance": 1.0}},
        "shapes": {"sheet": {"shape": "mesh", "mesh": mesh, "material": "clay", **shape}},
    }
