"""Measures the viewport: milliseconds from an edit of a scene to the first coarse picture, and to a whole one of one sample.

    python blender/latency.py [--size 640x360] [--triangles 65000]

It runs where `import bpy` and `import steradian` work.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable

import addon

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "scenes"))


def main() -> None:
    """Builds a scene, edits it step by step, and prints a table."""
    parser = argparse.ArgumentParser(description="Measures the viewport.")
    parser.add_argument("--size", default="640x360", help="size of the viewport in pixels")
    parser.add_argument("--triangles", type=int, default=65000, help="triangles of the ball that is edited")
    given = parser.parse_args()
    width, height = (int(n) for n in given.size.split("x"))
    import bpy
    import common

    addon.load().register()
    scene = common.empty((width, height))
    common.world((0.2, 0.25, 0.3))
    common.shape("plane", common.matte("Ground", (0.5, 0.5, 0.5)), size=8)
    side = max(int((given.triangles / 4) ** 0.5), 3)
    paint = common.principled("Paint", base_color=(0.6, 0.2, 0.1))
    ball = common.shape("uv_sphere", paint, smooth=True, segments=2 * side, ring_count=side, location=(0, 0, 1))
    lamp = common.lamp("POINT", 300, (2, -2, 4), shadow_soft_size=0.3)
    eye = common.camera((0, -6, 3), (0, 0, 0.8))
    session = addon.load("viewport").Session()
    bpy.app.handlers.depsgraph_update_post.append(lambda _, depsgraph: session.update(depsgraph))
    depsgraph = bpy.context.evaluated_depsgraph_get()

    def look() -> None:
        bpy.context.view_layer.update()
        session.camera(
            eye.matrix_world.inverted(), eye.calc_matrix_camera(depsgraph, x=width, y=height), (width, height)
        )

    def sculpt() -> None:
        for vertex in ball.data.vertices:
            vertex.co.z *= 1.1
        ball.data.update()

    def turn() -> None:
        eye.location.x += 0.5
        look()

    def first() -> None:
        session.update(depsgraph)
        look()

    node = next(n for n in paint.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    edits: dict[str, Callable[[], None]] = {
        "the first picture": first,
        "the camera moves": turn,
        "an object moves": lambda: setattr(ball.location, "x", ball.location.x + 0.3),
        "a lamp grows brighter": lambda: setattr(lamp.data, "energy", lamp.data.energy + 50),
        "a colour changes": lambda: setattr(node.inputs["Base Color"], "default_value", (0.1, 0.5, 0.2, 1.0)),
        "the mesh is sculpted": sculpt,
        "an object is added": lambda: common.shape("cube", location=(-2, 0, 0.5)),
    }
    print("| edit | coarse, ms | whole, ms |\n|---|---|---|")
    for name, edit in edits.items():
        times = []
        for spp in (0, 1):
            if name == "the mesh is sculpted":
                edit()
                begin = time.perf_counter()
            else:
                begin = time.perf_counter()
                edit()
            bpy.context.view_layer.update()
            if session.wait(spp) is None:
                raise SystemExit(f"{name}: {session.error or 'no picture came'}")
            times.append(1000 * (time.perf_counter() - begin))
            session.wait(2)
        print(f"| {name} | {times[0]:.0f} | {times[1]:.0f} |", flush=True)
    session.close()
    del scene


if __name__ == "__main__":
    main()
