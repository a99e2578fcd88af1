"""Steradian in Python: load a scene, change it, render it into NumPy arrays.

    import steradian as st
    img = st.load("scene.gltf").render(spp=64)
    img.save("a.exr")

A scene may also be a dictionary in the form of Steradian's own language, see docs/scene-format.md.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _describe, _rays, _steradian
from ._look import LookAt, look_at
from ._rays import BsdfSamples, Hits, Material
from ._samples import CameraRays, EmitterSamples, MeterReadings
from ._scene import Node, Parameters, Scene, SceneWarning, StrPath
from ._steradian import Image, Message, Parameter, Progress, SceneError, View, Wave, __version__, read_image, registry

__all__ = [
    "BsdfSamples", "CameraRays", "EmitterSamples", "Hits", "Image", "LookAt", "Material", "Message", "MeterReadings", "Node", "Parameter",
    "Parameters", "Progress", "Scene", "SceneError", "SceneWarning", "View", "Wave", "__version__", "compare", "integrator", "load",
    "look_at", "material", "read_image", "registry", "scene", "spectrum", "texture",
]


def load(
    path: StrPath, *, defines: Mapping[str, Any] | None = None, search: Sequence[StrPath] = (), strict: bool = False
) -> Scene:
    """Reads a scene: .pbrt, .xml, .gltf, .glb, .usd, .usda, .usdc, .usdz, .mtlx, .obj, .ply, .stl, .steradian, or `builtin:cornell-box`. SceneError says what is wrong with it."""
    words = {k: str(v) for k, v in (defines or {}).items()}
    return Scene(_steradian.Scene.load(path, defines=words, search=[os.fspath(p) for p in search], strict=strict))


def scene(
    description: Mapping[str, Any] | str, *, format: str | None = None, search: Sequence[StrPath] = (), strict: bool = False
) -> Scene:
    """A scene from a dictionary in the form of Steradian's own language, or from a text in any format that can be read.

    Numbers may be NumPy arrays: (3,) for colours and vectors, (4, 4) for transforms, and one row for each vertex or face in meshes.
    """
    folders = [os.fspath(p) for p in search]
    if isinstance(description, str):
        return Scene(_steradian.Scene.parse(description, format=format, search=folders, strict=strict))
    text, meshes = _describe.document(description)
    return Scene(_steradian.Scene.describe(text, meshes=meshes, search=folders, strict=strict))


def material(
    kind: str,
    *,
    wavelengths: Sequence[float] | None = None,
    eval: Callable[..., ArrayLike] | None = None,
    sample: Callable[..., ArrayLike] | None = None,
    pdf: Callable[..., ArrayLike] | None = None,
    colors: Mapping[str, ArrayLike] | None = None,
    numbers: Mapping[str, float] | None = None,
    transmits: bool = False,
    reciprocal: bool = True,
    **parameters: Any,
) -> Material:
    """A material by its kind: `material("conductor", eta="metal-Au-eta", k="metal-Au-k", alpha_u=0.2)`.

    Parameters are numbers, colours of three numbers, names of spectra and files. With four `wavelengths` in nm values are spectral.

    With `eval` the kind is one of your own, which scenes loaded from then on may name; `colors` and `numbers` are its parameters with
    their defaults. Functions take arrays of a row for each of n vertices, which threads that wait at the same time share:

    * `eval(wo, wi, at)`: f·|cos θi| in 1/sr, (n,), (n, 3) or (n, 4); `at` has the parameters, colours (n, 4), numbers (n,).
    * `sample(wo, u, at)`: directions (n, 3) by numbers u (n, 3) in [0, 1): one to choose a lobe, two for a direction. Zero for none.
    * `pdf(wo, wi, at)`: the density of `sample`, (n,). Without both a cosine lobe is drawn from.

    Directions (n, 3) point away from the surface, whose normal is +z. Lanes of colours are red, green, blue and one without meaning, or
    four wavelengths. Materials that do not transmit are asked above the surface alone.
    """
    if eval is None:
        given = {"sample": sample, "pdf": pdf, "colors": colors, "numbers": numbers}
        if absent := [name for name, value in given.items() if value is not None]:
            raise ValueError(f"'{absent[0]}' is of a material of your own, which needs 'eval'")
    else:
        if (sample is None) != (pdf is None):
            raise ValueError("'sample' and 'pdf' go together")
        rows = [(name, _color(name, value)) for name, value in (colors or {}).items()]
        plain = [(name, float(value)) for name, value in (numbers or {}).items()]
        _steradian.own_material(kind, eval, sample, pdf, rows, plain, transmits, reciprocal)

    def word(value: Any) -> str:
        if isinstance(value, bool):
            return str(value).lower()
        return str(value)

    def given(name: str, value: Any) -> str:
        if not isinstance(value, (list, tuple, np.ndarray)):
            return word(value)
        array = _describe.numbers(value, name)
        if array.ndim != 1:
            raise SceneError(f"'{name}' has the shape {array.shape}, where (3,) for a colour or vector, or (n,) for a list is needed")
        return ",".join(str(float(v)) for v in array)

    words = [(name, given(name, value)) for name, value in parameters.items()]
    return Material(_steradian.Material.describe(kind, words, wavelengths=None if wavelengths is None else list(wavelengths)))


def _color(name: str, value: ArrayLike) -> list[float]:
    array = np.asarray(value, np.float64)
    if array.ndim > 1 or array.size not in (1, 3):
        raise ValueError(f"the colour '{name}' has the shape {array.shape}, where a number or (3,) is needed")
    color: list[float] = np.broadcast_to(array.ravel(), 3).tolist()
    return color


def texture(kind: str, function: Callable[[NDArray[np.float32], NDArray[np.float32]], ArrayLike]) -> None:
    """A texture of your own, which scenes loaded from then on may name: `function(uv, p)` gives values (n,), or linear Rec.709 (n, 3), at
    coordinates (n, 2) and points of the texture's space (n, 3). Parameters of mappings (`scale_u`, `texture_from_world`, …) count."""
    _steradian.own_texture(kind, function)


def integrator(name: str, function: Callable[[Wave], ArrayLike]) -> None:
    """An integrator of your own for `render(integrator=name)` and for scenes that name it: `function(wave)` gives the linear Rec.709
    radiance (n, 3) along the camera rays of a wave: `wave.origins`, `wave.directions`, `wave.times`, and `wave.random(purpose, count)`.
    `Scene.trace` and `Scene.occluded` take such arrays."""
    _steradian.own_integrator(name, function)


def compare(image: Image, reference: Image) -> dict[str, Any]:
    """Figures of a picture against a reference, by the names of `steradian compare --json`: mse, rmse, relmse (also rel_mse), mape,
    smape, psnr (dB), ssim, flip, delta_e_76, delta_e_94, delta_e_2000, delta_e_max, max_abs, mean, reference_mean, ratio, nonfinite.

    A reference of another size is resampled by area, with a warning; `resampled_from` is its size then. Where both have the layer
    `variance`, `z_test` has samples, accepted, level, min_p and passes; where only one has it, `no_z_test` says so.
    """
    return image.compare(reference)


def spectrum(name: str, wavelengths: ArrayLike) -> NDArray[Any]:
    """A measured spectrum known by name (`metal-Au-eta`, `glass-BK7`, `stdillum-D65`) at wavelengths in nm."""
    at = np.asarray(wavelengths, np.float32)
    return _steradian.spectrum(name, at.ravel()).reshape(at.shape)
