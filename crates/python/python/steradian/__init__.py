"""Steradian in Python: load a scene, change it, render it into NumPy arrays.

    import steradian as st
    img = st.load("scene.gltf").render(spp=64)
    img.save("a.exr")

A scene may also be a dictionary in the form of Steradian's own language, see docs/scene-format.md.
"""

from __future__ import annotations

import json
import os
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping, MutableMapping, Sequence
from typing import Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _steradian
from ._steradian import Image, Message, Parameter, Progress, SceneError, __version__, read_image, registry

__all__ = [
    "Image", "Material", "Message", "Node", "Parameter", "Parameters", "Progress", "Scene", "SceneError", "SceneWarning", "__version__",
    "compare", "load", "material", "read_image", "registry", "scene", "spectrum",
]


class SceneWarning(UserWarning):
    """What a scene asks for and does not get as it says: approximated, left out, without effect."""

StrPath = Union[str, "os.PathLike[str]"]


def _plain(value: Any) -> Any:
    """What JSON does not know by itself."""
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"a {type(value).__name__} has no place in a scene")


def _text(value: Any) -> str:
    return json.dumps(value, default=_plain, allow_nan=False)


class _Parts(dict[str, Any]):
    """A value of parts: a part that is set sets the whole value."""

    def __init__(self, value: dict[str, Any], put: Callable[[dict[str, Any]], None]):
        super().__init__(value)
        self._put = put

    def __setitem__(self, part: str, value: Any) -> None:
        self._put({**self, part: value})
        super().__setitem__(part, value)


class Node(MutableMapping[str, Any]):
    """The parameters of a node of a scene: reading gives the value that is set, setting takes effect at the next render."""

    def __init__(self, scene: _steradian.Scene, name: str):
        self._scene, self._name = scene, name

    def __getitem__(self, parameter: str) -> Any:
        if parameter not in self._scene.parameters(self._name):
            raise KeyError(f"'{self._name}' does not set '{parameter}'")
        value = self._scene.get(self._name, parameter)
        return _Parts(value, lambda whole: self.__setitem__(parameter, whole)) if isinstance(value, dict) else value

    def __setitem__(self, parameter: str, value: Any) -> None:
        self._scene.set_text(self._name, parameter, _text(value))

    def __delitem__(self, parameter: str) -> None:
        self[parameter]
        self._scene.set_text(self._name, parameter, "null")

    def __iter__(self) -> Iterator[str]:
        return iter(self._scene.parameters(self._name))

    def __len__(self) -> int:
        return len(self._scene.parameters(self._name))

    def __repr__(self) -> str:
        return f"<steradian.Node '{self._name}' {dict(self)}>"


class Parameters(Mapping[str, Parameter]):
    """All that can be set of a scene, by `node.parameter`, those at their defaults too. Setting takes effect at the next render.

    A snapshot: what is set later by other ways is not in it.
    """

    def __init__(self, scene: _steradian.Scene):
        self._scene = scene
        self._all = {f"{p.node}.{p.name}": p for p in scene.params()}

    def __getitem__(self, key: str) -> Parameter:
        if key not in self._all:
            node, _, parameter = key.rpartition(".")
            self._scene.parameters(node)
            raise KeyError(f"'{node}' has no parameter '{parameter}'")
        return self._all[key]

    def __setitem__(self, key: str, value: Any) -> None:
        node, _, parameter = key.rpartition(".")
        self._scene.set_text(node, parameter, _text(value))
        self._all = {f"{p.node}.{p.name}": p for p in self._scene.params()}

    def __iter__(self) -> Iterator[str]:
        return iter(self._all)

    def __len__(self) -> int:
        return len(self._all)

    def __repr__(self) -> str:
        def row(key: str, p: Parameter) -> str:
            value = f"default {p.default}" if p.value is None else str(p.value)
            return f"  {key:<32} {value if len(value) < 40 else value[:37] + '...':<40} {p.type}"

        return "\n".join(["Parameters[", *(row(key, p) for key, p in self._all.items()), "]"])


class Scene(Mapping[str, Node]):
    """A scene: a mapping from the names of its nodes to their parameters."""

    def __init__(self, inner: _steradian.Scene):
        self._inner = inner
        self._told: set[str] = set()
        self._warn(inner.messages, 4)

    def _warn(self, messages: Sequence[Message], depth: int) -> None:
        """Shows, once each, what was lost; notes are for those who ask."""
        for m in messages:
            if m.kind != "note" and m.text not in self._told:
                self._told.add(m.text)
                warnings.warn(m.text, SceneWarning, stacklevel=depth)

    def __getitem__(self, name: str) -> Node:
        self._inner.parameters(name)
        return Node(self._inner, name)

    def __iter__(self) -> Iterator[str]:
        return iter(dict(self._inner.nodes))

    def __len__(self) -> int:
        return len(self._inner.nodes)

    @property
    def nodes(self) -> dict[str, tuple[str, str]]:
        """Family and kind of each node by its name; names that begin with '#' are made for nodes that have none."""
        return dict(self._inner.nodes)

    @property
    def cameras(self) -> list[str]:
        """Names of the cameras; the first is the default."""
        return self._inner.cameras

    @property
    def messages(self) -> list[Message]:
        """What reading and compiling had to say: approximations, parameters that nothing reads, …"""
        return self._inner.messages

    def params(self) -> Parameters:
        """All that can be set, each with its value, default, type, unit, range and meaning: `scene.params()["clay.reflectance"].doc`."""
        return Parameters(self._inner)

    def material(self, name: str, *, color: str = "auto") -> Material:
        """A material by its name, to be evaluated."""
        return Material(self._inner.material(name, color=color))

    def render(
        self,
        *,
        spp: int | None = None,
        size: tuple[int, int] | None = None,
        crop: Sequence[int] | None = None,
        camera: str | int | None = None,
        integrator: str | None = None,
        sampler: str | None = None,
        max_depth: int | None = None,
        seed: int | None = None,
        threads: int = 0,
        color: str = "auto",
        adaptive: bool = False,
        error: float | None = None,
        time: float | None = None,
        layers: Sequence[str] = (),
        transparent: bool = False,
        progress: bool | Callable[[Progress], Any] = False,
    ) -> Image:
        """Renders the scene; all is as the options of `steradian render` of the same names say.

        `progress` is True for a line in the terminal or notebook, or called with a Progress about twenty times a second; if it returns
        False, the render ends. Ctrl-C ends it too. In both cases the picture of the samples that there are is returned, and its
        `stopped` says why.
        """
        bar = _Bar() if progress is True and _is_watched() else None
        try:
            image = self._inner.render(
                spp=spp, size=size, crop=crop, camera=None if camera is None else str(camera), integrator=integrator,
                sampler=sampler, max_depth=max_depth, seed=seed, threads=threads, color=color, adaptive=adaptive, error=error,
                time=time, layers=list(layers), transparent=transparent,
                progress=bar or (progress if callable(progress) else None),
            )
        finally:
            if bar:
                bar.close()
        self._warn(self._inner.messages, 3)
        return image

    def text(self, path: StrPath = "scene.steradian") -> str:
        """The scene in Steradian's own language; files are named as from `path`."""
        return self._inner.text(path)[0]

    def save(self, path: StrPath) -> None:
        """Writes the scene in the format of the extension (.steradian, .xml, .pbrt, .gltf, .glb), and meshes and pictures beside it.

        What the format cannot say is a warning.
        """
        self._warn(self._inner.save(path), 3)

    def __repr__(self) -> str:
        return repr(self._inner)


def _is_watched() -> bool:
    """Whether somebody sees lines that are written over: in a terminal or a notebook."""
    return sys.stderr.isatty() or "ipykernel" in sys.modules


class _Bar:
    """A line that tells how far a render is."""

    def __init__(self) -> None:
        self._told = False

    def __call__(self, p: Progress) -> None:
        done = int(30 * min(p.fraction, 1.0))
        print(f"\r[{'#' * done}{' ' * (30 - done)}] {100 * p.fraction:5.1f} %  {p.spp:.1f} spp  {p.seconds:.1f} s", end="",
              file=sys.stderr, flush=True)
        self._told = True

    def close(self) -> None:
        if self._told:
            print(file=sys.stderr)


class Material:
    """A material as a function of directions. They point away from the surface, whose normal is +z, and have length one."""

    def __init__(self, inner: _steradian.Material):
        self._inner = inner

    def _evaluate(self, wo: ArrayLike, wi: ArrayLike, uv: tuple[float, float]) -> tuple[NDArray[Any], NDArray[Any]]:
        o, i = np.broadcast_arrays(np.asarray(wo, np.float32), np.asarray(wi, np.float32))
        shape = o.shape[:-1]
        values, densities = self._inner.evaluate(
            np.ascontiguousarray(o).reshape(-1, o.shape[-1]), np.ascontiguousarray(i).reshape(-1, i.shape[-1]), uv=uv
        )
        return values.reshape(*shape, values.shape[1]), densities.reshape(shape)

    def eval(self, wo: ArrayLike, wi: ArrayLike, *, uv: tuple[float, float] = (0.5, 0.5)) -> NDArray[Any]:
        """f·|cos θi| in 1/sr for arrays of directions (…, 3), which are broadcast: (…, 3) colours, or (…, 4) wavelengths."""
        return self._evaluate(wo, wi, uv)[0]

    def pdf(self, wo: ArrayLike, wi: ArrayLike, *, uv: tuple[float, float] = (0.5, 0.5)) -> NDArray[Any]:
        """The density in 1/sr with which wi is sampled."""
        return self._evaluate(wo, wi, uv)[1]

    def __repr__(self) -> str:
        return repr(self._inner)


def load(
    path: StrPath, *, defines: Mapping[str, Any] | None = None, search: Sequence[StrPath] = (), strict: bool = False
) -> Scene:
    """Reads a scene: .pbrt, .xml, .gltf, .glb, .obj, .ply, .steradian, or `builtin:cornell-box`. SceneError says what is wrong with it."""
    words = {k: str(v) for k, v in (defines or {}).items()}
    return Scene(_steradian.Scene.load(path, defines=words, search=[os.fspath(p) for p in search], strict=strict))


def scene(
    description: Mapping[str, Any] | str, *, format: str | None = None, search: Sequence[StrPath] = (), strict: bool = False
) -> Scene:
    """A scene from a dictionary in the form of Steradian's own language, or from a text in any format that can be read."""
    if isinstance(description, str):
        text = description
    else:
        entries = dict(description)
        text = json.dumps({"steradian": entries.pop("steradian", 1), **entries}, default=_plain, allow_nan=False, indent=1)
        format = "steradian"
    folders = [os.fspath(p) for p in search]
    return Scene(_steradian.Scene.parse(text, format=format, name="dictionary" if format == "steradian" else "text",
                                        search=folders, strict=strict))


def material(kind: str, *, wavelengths: Sequence[float] | None = None, **parameters: Any) -> Material:
    """A material by its kind: `material("conductor", eta="metal-Au-eta", k="metal-Au-k", alpha_u=0.2)`.

    Parameters are numbers, colours of three numbers, names of spectra and files. With four `wavelengths` in nm values are spectral.
    """
    def word(value: Any) -> str:
        if isinstance(value, bool):
            return str(value).lower()
        if isinstance(value, (list, tuple, np.ndarray)):
            return ",".join(str(float(v)) for v in value)
        return str(value)

    words = [(name, word(value)) for name, value in parameters.items()]
    return Material(_steradian.Material.describe(kind, words, wavelengths=None if wavelengths is None else list(wavelengths)))


def compare(image: Image, reference: Image) -> dict[str, Any]:
    """How far a picture is from a reference of its size: mse, rmse, rel_mse, psnr (dB), max_abs, mean, reference_mean, ratio, non_finite."""
    return image.compare(reference)


def spectrum(name: str, wavelengths: ArrayLike) -> NDArray[Any]:
    """A measured spectrum known by name (`metal-Au-eta`, `glass-BK7`, `stdillum-D65`) at wavelengths in nm."""
    at = np.asarray(wavelengths, np.float32)
    return _steradian.spectrum(name, at.ravel()).reshape(at.shape)
