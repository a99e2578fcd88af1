"""Renders scenes by Cycles and by Steradian, and writes pictures side by side and a table of their differences.

    python blender/compare.py [--samples 64] [--out FOLDER] SCENE…

It runs where `import bpy` and `import steradian` work. A scene is a script with a function `build`, such as
blender/scenes/interior.py. Pictures have Cycles on the left.
"""

from __future__ import annotations

import argparse
import importlib.util
import math
import os
import sys
import time
from typing import Any

import addon
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
GRID = 4


def built(path: str) -> Any:
    """The scene that a script builds."""
    sys.path.append(os.path.dirname(os.path.abspath(path)))
    spec = importlib.util.spec_from_file_location("scene_" + os.path.splitext(os.path.basename(path))[0], path)
    if spec is None or spec.loader is None:
        raise SystemExit(f"{path}: no script there")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.build()


def rendered(engine: str, samples: int, seed: int, folder: str) -> tuple[np.ndarray, float]:
    """A picture by an engine, height × width × 3, and the processor seconds that it took."""
    import bpy
    import steradian

    scene = bpy.context.scene
    scene.render.engine = engine
    scene.cycles.samples, scene.cycles.seed = samples, seed
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.diffuse_bounces = scene.cycles.glossy_bounces = scene.cycles.transmission_bounces = 24
    scene.cycles.volume_bounces = scene.cycles.max_bounces = 24
    scene.cycles.sample_clamp_indirect = 0.0
    scene.cycles.blur_glossy = 0.0
    scene.steradian.samples, scene.steradian.seed = samples, seed
    scene.render.filepath = os.path.join(folder, f"{engine}-{seed}.exr")
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    begin = time.process_time()
    bpy.ops.render.render(write_still=True)
    seconds = time.process_time() - begin
    image = steradian.read_image(scene.render.filepath)
    os.remove(scene.render.filepath)
    return np.stack([image[c] for c in "RGB"], axis=-1), seconds


def regions(picture: np.ndarray) -> np.ndarray:
    """Means over a grid of regions."""
    rows = np.array_split(picture, GRID, axis=0)
    return np.array([[part.mean() for part in np.array_split(row, GRID, axis=1)] for row in rows])


def compared(path: str, samples: int, seeds: int, folder: str) -> dict[str, Any]:
    """Renders a scene with several seeds by both, and gives the figures."""
    built(path)
    runs = {
        engine: [rendered(engine, samples, seed, folder) for seed in range(1, seeds + 1)]
        for engine in ("CYCLES", "STERADIAN")
    }
    found: dict[str, Any] = {"scene": os.path.splitext(os.path.basename(path))[0]}
    mean, error = {}, {}
    for engine, pictures in runs.items():
        stack = np.array([picture for picture, _ in pictures])
        cells = np.array([regions(picture) for picture in stack])
        mean[engine], error[engine] = cells.mean(axis=0), cells.std(axis=0, ddof=1) / math.sqrt(seeds)
        found[engine] = stack.mean(axis=0)
        found[engine, "seconds"] = sum(seconds for _, seconds in pictures) / seeds
        noise = stack.std(axis=0, ddof=1).mean() / max(stack.mean(), 1e-9)
        found[engine, "noise"] = noise * math.sqrt(found[engine, "seconds"])
    level = mean["CYCLES"].mean()
    relative = (mean["STERADIAN"] - mean["CYCLES"]) / np.maximum(mean["CYCLES"], 0.05 * level)
    sigma = np.sqrt(error["CYCLES"] ** 2 + error["STERADIAN"] ** 2)
    found["ratio"] = mean["STERADIAN"].mean() / level
    found["worst"] = float(np.abs(relative).max())
    found["z"] = float(np.abs((mean["STERADIAN"] - mean["CYCLES"]) / np.maximum(sigma, 1e-3 * level)).max())
    found["regions"] = relative
    return found


def side_by_side(found: dict[str, Any], path: str) -> None:
    """Writes both pictures beside each other."""
    import steradian

    pair = np.concatenate([found["CYCLES"], found["STERADIAN"]], axis=1).astype(np.float32)
    steradian.Image({c: np.ascontiguousarray(pair[..., k]) for k, c in enumerate("RGB")}).save(path)


HEAD = """| scene | ratio of means | worst region of 16 | largest z | Cycles, CPU s | Steradian, CPU s | Cycles, noise | Steradian, noise |
|---|---|---|---|---|---|---|---|"""


def row(found: dict[str, Any]) -> str:
    """A line of the table."""
    c, s = "CYCLES", "STERADIAN"
    return (
        f"| {found['scene']} | {found['ratio']:.4f} | {100 * found['worst']:.1f} % | {found['z']:.1f} | {found[c, 'seconds']:.1f} | "
        f"{found[s, 'seconds']:.1f} | {100 * found[c, 'noise']:.1f} % | {100 * found[s, 'noise']:.1f} % |"
    )


def main() -> None:
    """Reads the command line."""
    parser = argparse.ArgumentParser(description="Compares Steradian with Cycles in Blender.")
    parser.add_argument("scenes", nargs="*", help="scripts with a function build; by default those of blender/scenes")
    parser.add_argument("--samples", type=int, default=64, help="samples per pixel of each picture")
    parser.add_argument("--seeds", type=int, default=4, help="pictures by each, whose spread is the noise")
    parser.add_argument("--out", default="compared", help="folder of the pictures and the table")
    given = parser.parse_args()
    folder = os.path.join(HERE, "scenes")
    scenes = given.scenes or sorted(
        os.path.join(folder, n) for n in os.listdir(folder) if n.endswith(".py") and n != "common.py"
    )
    addon.load().register()
    os.makedirs(given.out, exist_ok=True)
    lines = [HEAD]
    for scene in scenes:
        found = compared(scene, given.samples, max(given.seeds, 2), given.out)
        side_by_side(found, os.path.join(given.out, f"{found['scene']}.png"))
        lines.append(row(found))
        print(lines[-1], flush=True)
        print(np.array2string(100 * found["regions"], precision=1, suppress_small=True), flush=True)
    with open(os.path.join(given.out, "table.md"), "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
