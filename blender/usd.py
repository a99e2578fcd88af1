"""Exports scenes as USD from Blender, and holds pictures of the files against those of the add-on.

    python blender/usd.py [--samples 64] [--out FOLDER] SCENE…

It runs where `import bpy` and `import steradian` work. Lamps are seen in all pictures, as USD cannot hide them; the second
figure is with suns four times as strong in the file, as Blender writes a quarter of their irradiance. A file
(.gltf, .glb) in place of a script goes through Blender to USD and is held against itself.
"""

from __future__ import annotations

import argparse
import os
from typing import Any

import addon
import compare
import numpy as np


def exported(path: str) -> None:
    """Writes Blender's scene as USD."""
    import bpy

    os.makedirs(os.path.dirname(path), exist_ok=True)
    bpy.ops.wm.usd_export(
        filepath=path,
        export_hair=True,
        use_instancing=True,
        export_materials=True,
        generate_preview_surface=True,
        generate_materialx_network=True,
    )


def picture(path: str, samples: int, size: tuple[int, int]) -> np.ndarray:
    """A picture of a file, height × width × 3."""
    import steradian

    image = steradian.load(path).render(spp=samples, size=size)
    return np.stack([np.array(image[c]) for c in "RGB"], axis=-1)


def figures(found: np.ndarray, wanted: np.ndarray) -> str:
    """The ratio of means, and the largest deviation of a region."""
    a, b = compare.regions(wanted), compare.regions(found)
    worst = np.abs((b - a) / np.maximum(a, 0.05 * a.mean())).max()
    return f"{b.mean() / a.mean():.4f}, {100 * worst:.1f} %"


def of_script(path: str, samples: int, folder: str) -> tuple[str, list[np.ndarray]]:
    """A row for a scene of Blender, and its pictures."""
    import bpy

    compare.built(path)
    lamps = [thing for thing in bpy.data.objects if thing.type == "LIGHT"]
    for lamp in lamps:
        lamp.visible_camera = True
    size = (bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y)
    pictures = [compare.rendered("STERADIAN", samples, 1, folder)[0]]
    name = os.path.splitext(os.path.basename(path))[0]
    cells = [name]
    for factor in (1.0, 4.0):
        suns = [lamp.data for lamp in lamps if lamp.data.type == "SUN"]
        for sun in suns:
            sun.energy *= factor
        if factor == 1.0 or suns:
            file = os.path.join(folder, f"{name}-{factor:.0f}", f"{name}.usdc")
            exported(file)
            pictures.append(picture(file, samples, size))
        cells.append(figures(pictures[-1], pictures[0]))
    return f"| {' | '.join(cells)} |", pictures


def of_file(path: str, samples: int, folder: str) -> tuple[str, list[np.ndarray]]:
    """A row for a file that goes through Blender to USD, with its camera and the lights that it brings."""
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=os.path.abspath(path))
    name = os.path.splitext(os.path.basename(path))[0]
    file = os.path.join(folder, name, f"{name}.usdc")
    exported(file)
    pictures = [picture(p, samples, (240, 135)) for p in (path, file)]
    return f"| {name} | {figures(pictures[1], pictures[0])} | |", pictures


def main() -> None:
    """Reads the command line."""
    parser = argparse.ArgumentParser(description="Holds USD of Blender against the add-on.")
    parser.add_argument("scenes", nargs="+", help="scripts with a function build, or glTF files")
    parser.add_argument("--samples", type=int, default=64, help="samples per pixel")
    parser.add_argument("--out", default="usd", help="folder of the files and pictures")
    given: Any = parser.parse_args()
    addon.load().register()
    import steradian

    os.makedirs(given.out, exist_ok=True)
    for scene in given.scenes:
        make = of_script if scene.endswith(".py") else of_file
        row, pictures = make(scene, given.samples, given.out)
        print(row, flush=True)
        wide = np.concatenate(pictures, axis=1).astype(np.float32)
        name = os.path.splitext(os.path.basename(scene))[0]
        planes = {c: np.ascontiguousarray(wide[..., k]) for k, c in enumerate("RGB")}
        steradian.Image(planes).save(os.path.join(given.out, f"{name}.png"))


if __name__ == "__main__":
    main()
