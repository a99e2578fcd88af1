"""Passes of Blender and the layers that they are made of."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

FAR = 1e10


@dataclass(frozen=True)
class Pass:
    """A pass: its name, channels and kind in Blender, the layer that is rendered for it, and that layer's planes."""

    name: str
    channels: str
    kind: str
    layer: str
    planes: tuple[str, ...]


def wanted(view_layer: bpy.types.ViewLayer, scene: bpy.types.Scene) -> list[Pass]:
    """The passes of a view layer beside Combined."""
    found = []
    if view_layer.use_pass_z:
        found.append(Pass("Depth", "Z", "VALUE", "depth", ("Z",)))
    if view_layer.use_pass_normal:
        found.append(Pass("Normal", "XYZ", "VECTOR", "normal", ("N.X", "N.Y", "N.Z")))
    if view_layer.use_pass_position:
        found.append(Pass("Position", "XYZ", "VECTOR", "position", ("P.X", "P.Y", "P.Z")))
    if view_layer.use_pass_uv:
        found.append(Pass("UV", "UVA", "VECTOR", "uv", ("uv.U", "uv.V", "=1")))
    if view_layer.use_pass_diffuse_color:
        found.append(Pass("Diffuse Color", "RGB", "COLOR", "albedo", _rgb("albedo")))
    for kind, short in (("object", "Object"), ("material", "Material")):
        if getattr(view_layer, f"use_pass_cryptomatte_{kind}"):
            for level in range(min((view_layer.pass_cryptomatte_depth + 1) // 2, 3)):
                planes = tuple(f"crypto_{kind}{level:02}.{c}" for c in "rgba")
                found.append(Pass(f"Crypto{short}{level:02}", "RGBA", "COLOR", "cryptomatte", planes))
    if scene.steradian.store_guides:
        found.append(Pass("Denoising Albedo", "RGB", "COLOR", "denoise_albedo", _rgb("denoise_albedo")))
        found.append(
            Pass("Denoising Normal", "XYZ", "VECTOR", "denoise_normal", tuple(f"denoise_normal.{c}" for c in "XYZ"))
        )
        found.append(Pass("Noisy Image", "RGBA", "COLOR", "", ("raw.R|R", "raw.G|G", "raw.B|B", "A|=1")))
    for group in view_layer.lightgroups:
        found.append(Pass(f"Combined_{group.name}", "RGB", "COLOR", "light_groups", _rgb(f"RGBA_{group.name}")))
    return found


def _rgb(name: str) -> tuple[str, ...]:
    return tuple(f"{name}.{c}" for c in "RGB")


MISSING = {
    "use_pass_vector": "Vector",
    "use_pass_mist": "Mist",
    "use_pass_object_index": "Object Index",
    "use_pass_material_index": "Material Index",
    "use_pass_shadow": "Shadow",
    "use_pass_ambient_occlusion": "Ambient Occlusion",
    "use_pass_emit": "Emission",
    "use_pass_environment": "Environment",
    "use_pass_diffuse_direct": "Diffuse Direct",
    "use_pass_diffuse_indirect": "Diffuse Indirect",
    "use_pass_glossy_direct": "Glossy Direct",
    "use_pass_glossy_indirect": "Glossy Indirect",
    "use_pass_glossy_color": "Glossy Color",
    "use_pass_transmission_direct": "Transmission Direct",
    "use_pass_transmission_indirect": "Transmission Indirect",
    "use_pass_transmission_color": "Transmission Color",
    "use_pass_cryptomatte_asset": "Cryptomatte Asset",
}


def missing(view_layer: bpy.types.ViewLayer) -> list[str]:
    """Names of passes that the view layer asks for, and that there are not."""
    return [name for flag, name in MISSING.items() if getattr(view_layer, flag, False)]


def layers(passes: list[Pass], *, alpha: bool, denoise: bool) -> list[str]:
    """Layers to render."""
    found = {p.layer for p in passes if p.layer}
    if alpha:
        found.add("alpha")
    if denoise:
        found |= {"albedo", "normal", "depth", "variance"}
    return sorted(found)


def combined(image: Any, *, transparent: bool, background: NDArray[np.float32] | None = None) -> NDArray[np.float32]:
    """The picture with its coverage, rows from the bottom, height × width × 4; before a background, height × width × 3."""
    colour = np.stack([image["R"], image["G"], image["B"]], axis=-1)
    alpha = image["A"] if "A" in image.channels else np.ones((image.height, image.width), np.float32)
    if background is not None:
        colour = colour + (1 - alpha[..., None]) * background
    if not transparent:
        alpha = np.ones_like(alpha)
    return np.flipud(np.concatenate([colour, alpha[..., None]], axis=-1))


def values(image: Any, wanted: Pass) -> NDArray[np.float32]:
    """Values of a pass, rows from the bottom, height × width × channels; zero where the picture lacks them."""
    found = np.zeros((image.height, image.width, len(wanted.planes)), np.float32)
    for k, names in enumerate(wanted.planes):
        for name in names.split("|"):
            if name.startswith("="):
                found[..., k] = float(name[1:])
                break
            if name in image.channels:
                found[..., k] = image[name]
                break
    if wanted.name == "Depth":
        found = np.where(np.isfinite(found), found, FAR).astype(np.float32)
    return np.flipud(found)
