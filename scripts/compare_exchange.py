#!/usr/bin/env python3
"""Converted scenes against their originals, and against Mitsuba 3 where it can load them.

    python3 -m venv venv && venv/bin/pip install mitsuba==3.9.1 numpy OpenEXR
    venv/bin/python scripts/compare_exchange.py path/to/steradian ASSETS [--only WORD] [--spp 64] [--trips xml,pbrt,...]

For each scene file below ASSETS (.pbrt, .xml, .gltf, .glb) and each round trip the program converts the scene step by
step, renders the original and the result small and in the same colour mode (RGB), and prints the ratio of their means
for red, green and blue, with the standard error that halves of the samples give. A scene whose first step is Mitsuba's
language is rendered by Mitsuba (variant `llvm_ad_rgb`, else `scalar_rgb`), too; its mean is printed against ours of the
same file. Where a mean is off by more than 0.5 % and four standard errors, the losses that the program names are
printed below. The last line counts what is off without a named loss; the exit status is 1 if there is any.
docs/exchange.md has one run. It is no part of the gate.
"""

import argparse
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import OpenEXR

PIXELS = 6144


def run(*command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=900)
    return done.returncode, done.stdout + done.stderr


def read(path):
    channels = OpenEXR.File(str(path)).channels()
    if "RGB" in channels:
        return np.array(channels["RGB"].pixels)
    return np.stack([np.array(channels[c].pixels) for c in "RGB"], -1)


def size_of(program, scene, folder):
    """A small frame of the film's shape, since angles of view may be of either axis."""
    film = folder / "film.pbrt"
    run(program, "convert", scene, film)
    text = film.read_text() if film.exists() else ""
    found = [re.search(rf'"integer {axis}resolution" \[ (\d+) \]', text) for axis in "xy"]
    width, height = (int(f[1]) for f in found) if all(found) else (96, 64)
    scale = (PIXELS / (width * height)) ** 0.5
    # Even shares of the film: a common divisor keeps the shape where there is one.
    return max(8, round(width * scale / 4) * 4), max(8, round(width * scale / 4) * 4 * height // width)


def ours(program, scene, folder, spp, size):
    """Mean colour and its standard error, from four renders."""
    means = []
    for seed in range(4):
        out = folder / f"{seed}.exr"
        code, text = run(program, "render", scene, "--color", "rgb", "--size", "x".join(map(str, size)), "--spp", max(1, spp // 4), "--seed", seed,
                         "--threads", 3, "-q", "-o", out)
        if code:
            raise RuntimeError(text.strip().splitlines()[0] if text.strip() else "no picture")
        means.append(read(out).mean((0, 1)))
    return np.mean(means, 0), np.std(means, 0, ddof=1) / 2


def small(scene, size):
    """A copy with the size that both programs render, and a filter that does not reach across the film's edge."""
    text = Path(scene).read_text()
    for name, value in zip(("width", "height"), size):
        text = re.sub(rf'<integer name="{name}" value="\d+"/>', f'<integer name="{name}" value="{value}"/>', text)
    text = re.sub(r'<integer name="crop_\w+" value="\d+"/>', "", text)
    text = re.sub(r'<rfilter [^>]*/>|<rfilter .*?</rfilter>', '<rfilter type="box"/>', text, flags=re.S)
    copy = Path(scene).with_suffix(".small.xml")
    copy.write_text(text)
    return copy


def theirs(scene, spp):
    """The same by Mitsuba."""
    import mitsuba as mi
    if mi.variant() is None:
        try:
            mi.set_variant("llvm_ad_rgb")
            mi.Float(1) + 1
        except Exception:
            mi.set_variant("scalar_rgb")
    loaded = mi.load_file(str(scene))
    means = [np.array(mi.render(loaded, spp=max(1, spp // 4), seed=seed))[..., :3].mean((0, 1)) for seed in range(4)]
    return np.mean(means, 0), np.std(means, 0, ddof=1) / 2


def convert(program, scene, steps, folder):
    """The last file of a chain of conversions, the first one in Mitsuba's language, and the losses on the way."""
    losses, first, current = [], None, scene
    for i, extension in enumerate(steps):
        target = folder / f"step{i}.{extension}"
        report = folder / f"step{i}.md"
        code, text = run(program, "convert", current, target, "--report", report)
        if code:
            raise RuntimeError(text.strip().splitlines()[0] if text.strip() else "not converted")
        body = report.read_text().split("## Exact")[0].split("## Without effect")[0]
        losses += [re.sub(r" \([^()]*:\d+:\d+\)$", "", line[2:]) for line in body.splitlines() if line.startswith("- ")]
        if extension == "xml" and first is None:
            first = target
        current = target
    return current, first, sorted(set(losses))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("assets", type=Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--trips", default="xml")
    parser.add_argument("--from", dest="source", default="pbrt", help="extensions of scenes, separated by commas")
    parser.add_argument("--no-mitsuba", action="store_true")
    options = parser.parse_args()
    trips = [trip.split("-") for trip in options.trips.split(",")]
    scenes = [p for p in sorted(options.assets.rglob("*")) if p.suffix[1:] in options.source.split(",") and options.only in str(p)]
    print("| scene | steps | ours after / before (R G B) | standard error | Mitsuba / ours after | standard error | losses named |")
    print("|---|---|---|---|---|---|---|")
    unexplained = 0
    for scene in scenes:
        name = scene.relative_to(options.assets)
        with tempfile.TemporaryDirectory() as temporary:
            folder = Path(temporary)
            try:
                size = size_of(options.program, scene, folder)
                before, error = ours(options.program, scene, folder, options.spp, size)
            except RuntimeError:
                continue  # Parts of scenes are not scenes.
            for steps in trips:
                label = " → ".join([scene.suffix[1:], *steps])
                try:
                    last, mitsuba, losses = convert(options.program, scene, steps, folder)
                    after, other = ours(options.program, last, folder, options.spp, size)
                    ratio = (after + 1e-9) / (before + 1e-9)
                    sigma = np.hypot(error, other) / (before + 1e-9)
                    cells = [" ".join(f"{r:.4f}" for r in ratio), f"{sigma.max():.4f}", "", ""]
                    off = np.any(np.abs(ratio - 1) > np.maximum(0.005, 4 * sigma))
                    if mitsuba is not None and not options.no_mitsuba:
                        try:
                            copy = small(mitsuba, size)
                            mean, spread = theirs(copy, options.spp)
                            against, width = ours(options.program, copy, folder, options.spp, size)
                            quotient = (mean + 1e-9) / (against + 1e-9)
                            cells[2] = " ".join(f"{r:.4f}" for r in quotient)
                            cells[3] = f"{(np.hypot(spread, width) / (against + 1e-9)).max():.4f}"
                        except Exception as fault:  # noqa: BLE001, whatever Mitsuba says
                            cells[2] = f"refused: {str(fault).splitlines()[0][:80]}"
                            off = True
                    unexplained += bool(off and not losses)
                    print(f"| {name} | {label} | {' | '.join(cells)} | {len(losses)}{' (off)' if off else ''} |", flush=True)
                    if off:
                        for loss in losses:
                            print(f"|   | | {loss} | | | | |", flush=True)
                except RuntimeError as fault:
                    unexplained += 1
                    print(f"| {name} | {label} | failed: {fault} | | | | |", flush=True)
    print(f"\n{unexplained} off without a named loss")
    sys.exit(unexplained > 0)


if __name__ == "__main__":
    main()
