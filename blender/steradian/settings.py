"""Settings of the renderer, kept with each scene."""

from __future__ import annotations

from typing import Any

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
)

METHODS = [
    ("path", "Path tracing", "Paths from the camera, with light samples; media are followed where there are any"),
    (
        "bdpt",
        "Bidirectional",
        "Paths from the camera and from lights, joined: for lamps in fittings, and light from small openings",
    ),
    ("vcm", "Vertex merging", "Bidirectional paths and photons: for caustics that are seen in mirrors, too"),
    ("sppm", "Photon mapping", "Progressive photon maps: for caustics"),
    ("pssmlt", "Metropolis", "Paths that change little by little from bright ones: for light that is hard to find"),
    ("direct", "Direct light", "Light that is scattered once"),
    ("ao", "Ambient occlusion", "How open surfaces are, without lights"),
    ("raster", "Rasterised preview", "A picture without noise in about a second, with approximated indirect light"),
]
DENOISERS = [
    ("none", "None", "Leave the noise"),
    ("nlm", "Non-local means", "The renderer's own denoiser, guided by albedo, normals and depth"),
    ("atrous", "À-trous", "The renderer's own faster denoiser"),
    ("oidn", "Open Image Denoise", "Intel's denoiser, where its library is found"),
]
FILTERS = [
    ("BLACKMAN_HARRIS", "Blackman–Harris", "A smooth window"),
    ("GAUSSIAN", "Gaussian", "A Gaussian"),
    ("BOX", "Box", "Each pixel by itself"),
]


class SteradianSettings(bpy.types.PropertyGroup):
    """Settings of a scene."""

    method: EnumProperty(name="Method", description="Algorithm that finds light", items=METHODS, default="path")
    samples: IntProperty(
        name="Samples", description="Samples per pixel of final renders", default=128, min=1, max=1 << 20
    )
    preview_samples: IntProperty(
        name="Viewport Samples",
        description="Samples per pixel of the viewport, after which it rests",
        default=64,
        min=1,
        max=1 << 20,
    )
    time_limit: FloatProperty(
        name="Time Limit",
        description="Seconds after which a render ends with the samples that it has; 0 for no limit",
        default=0,
        min=0,
        unit="TIME_ABSOLUTE",
    )
    error: FloatProperty(
        name="Error",
        description="Estimated relative error of pixels at which a render ends; 0 for none",
        default=0,
        min=0,
        max=1,
        precision=4,
    )
    max_depth: IntProperty(
        name="Depth", description="Most scattering events of a path; -1 for no limit", default=24, min=-1, max=1 << 16
    )
    clamp: FloatProperty(
        name="Clamp",
        description="Samples whose largest component is above are scaled down to it: fewer bright spots, less light; 0 for none",
        default=0,
        min=0,
    )
    adaptive: BoolProperty(
        name="Adaptive", description="Spend more samples where there is more noise; Samples is the mean", default=False
    )
    caustics: EnumProperty(
        name="Caustics",
        description="Photons that guide paths to light behind mirrors and glass",
        items=[
            ("auto", "By a trial", "Where a trial says that it pays"),
            ("true", "Always", "Always"),
            ("false", "Never", "Never"),
        ],
        default="auto",
    )
    denoiser: EnumProperty(
        name="Denoiser", description="What removes the noise of final renders", items=DENOISERS, default="none"
    )
    preview_denoise: BoolProperty(
        name="Denoise Viewport", description="Remove the noise in the viewport", default=False
    )
    store_guides: BoolProperty(
        name="Denoising Data",
        description="Passes for denoising in the compositor: Denoising Albedo, Denoising Normal, Noisy Image",
        default=False,
    )
    seed: IntProperty(name="Seed", description="Random seed", default=0, min=0)
    animate_seed: BoolProperty(
        name="New Seed for Each Frame", description="Other noise in each frame of an animation", default=False
    )
    filter: EnumProperty(
        name="Pixel Filter", description="How samples are weighted in pixels", items=FILTERS, default="BLACKMAN_HARRIS"
    )
    filter_width: FloatProperty(
        name="Width", description="Width of the pixel filter in pixels", default=1.5, min=0.1, max=10
    )
    spectral: BoolProperty(
        name="Spectral",
        description="Light by wavelengths instead of red, green and blue: glass disperses",
        default=False,
    )
    threads: IntProperty(
        name="Threads", description="Threads that render; 0 for all processors", default=0, min=0, max=1024
    )


def options(scene: bpy.types.Scene, *, is_preview: bool = False, **how: bool) -> dict[str, Any]:
    """Settings of a scene as arguments of `Scene.render`, without size, layers and progress; `how` is for `method`."""
    own = scene.steradian
    found: dict[str, Any] = {
        "spp": own.preview_samples if is_preview else own.samples,
        "max_depth": own.max_depth,
        "integrator": method(scene, **how),
        "seed": own.seed + (scene.frame_current if own.animate_seed else 0),
        "threads": own.threads,
        "color": "spectral" if own.spectral else "rgb",
    }
    if own.method == "raster":
        found.pop("spp")
    if own.time_limit > 0 and not is_preview:
        found["time"] = own.time_limit
    if own.error > 0 and not is_preview:
        found["error"] = own.error
    if own.adaptive and not is_preview:
        found["adaptive"] = True
    return found


def method(scene: bpy.types.Scene, *, groups: bool = False, hides_lamps: bool = False, media: bool = False) -> str:
    """Integrator with its parameters; light groups need plain paths."""
    own = scene.steradian
    name, given = ("volpath" if media and own.method == "path" else own.method), []
    if own.method == "path":
        given += ["reuse=1", "effort=even"] if groups else [f"caustics={own.caustics}"]
    if hides_lamps and own.method != "ao":
        given.append("hide_emitters=true")
    return f"{name}:{','.join(given)}" if given else str(name)


def register() -> None:
    """Adds the settings to scenes."""
    bpy.utils.register_class(SteradianSettings)
    bpy.types.Scene.steradian = PointerProperty(type=SteradianSettings)


def unregister() -> None:
    """Takes them away."""
    del bpy.types.Scene.steradian
    bpy.utils.unregister_class(SteradianSettings)
