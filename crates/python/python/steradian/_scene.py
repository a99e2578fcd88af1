"""Scenes: mappings from the names of nodes to their parameters."""

from __future__ import annotations

import os
import warnings
import webbrowser
from collections.abc import Callable, Iterator, Mapping, MutableMapping, Sequence
from typing import Any, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _frames, _rays, _samples, _steradian
from ._describe import PARTS, mesh_arrays, text
from ._look import LookAt, camera_settings
from ._progress import is_notebook, shown
from ._rays import Hits, Material
from ._samples import CameraRays, EmitterSamples, MeterReadings
from ._steradian import Image, Message, Parameter, Progress, SceneError, View

StrPath = Union[str, "os.PathLike[str]"]


class SceneWarning(UserWarning):
    """Part of a scene that is not rendered as the scene says: approximated, left out, or without effect."""


class _Parts(dict[str, Any]):
    """Value with parts: setting a part sets the whole value."""

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
        self._scene.set_text(self._name, parameter, text(value, f"{self._name}.{parameter}"))

    def __delitem__(self, parameter: str) -> None:
        self[parameter]
        self._scene.set_text(self._name, parameter, "null")

    def __iter__(self) -> Iterator[str]:
        return iter(self._scene.parameters(self._name))

    def __len__(self) -> int:
        return len(self._scene.parameters(self._name))

    @property
    def positions(self) -> NDArray[np.float32]:
        """Vertices of a mesh, (n, 3), in the shape's own space. To be read; assigning an array changes the mesh."""
        return self._part("positions")

    @positions.setter
    def positions(self, value: ArrayLike) -> None:
        self.set_mesh(positions=value)

    @property
    def normals(self) -> NDArray[np.float32]:
        """Normals at the vertices of a mesh, (n, 3), or (0, 3) where there are none."""
        return self._part("normals")

    @normals.setter
    def normals(self, value: ArrayLike | None) -> None:
        self.set_mesh(normals=value)

    @property
    def uvs(self) -> NDArray[np.float32]:
        """Texture coordinates at the vertices of a mesh, (n, 2), or (0, 2)."""
        return self._part("uvs")

    @uvs.setter
    def uvs(self, value: ArrayLike | None) -> None:
        self.set_mesh(uvs=value)

    @property
    def tangents(self) -> NDArray[np.float32]:
        """Tangents at the vertices of a mesh, (n, 3), or (0, 3)."""
        return self._part("tangents")

    @tangents.setter
    def tangents(self, value: ArrayLike | None) -> None:
        self.set_mesh(tangents=value)

    @property
    def triangles(self) -> NDArray[np.uint32]:
        """Indices of the vertices of a mesh's triangles, (m, 3)."""
        return self._part("triangles")

    @triangles.setter
    def triangles(self, value: ArrayLike | None) -> None:
        self.set_mesh(triangles=value)

    @property
    def patches(self) -> NDArray[np.uint32]:
        """Indices of the vertices of a mesh's bilinear patches, (m, 4), in the order p00 p10 p01 p11."""
        return self._part("patches")

    @patches.setter
    def patches(self, value: ArrayLike | None) -> None:
        self.set_mesh(patches=value)

    @property
    def attributes(self) -> dict[str, tuple[str, NDArray[np.float32]]]:
        """Further data of a mesh by name, such as colours: `vertex` or `face`, and an array of one row for each."""
        return {name: (domain, _fixed(data)) for name, domain, data in _steradian.mesh(self._scene, self._name)["attributes"]}

    @attributes.setter
    def attributes(self, value: Mapping[str, Any] | None) -> None:
        self.set_mesh(attributes=value)

    @property
    def to_world(self) -> NDArray[np.float64]:
        """Transform of a shape into the world, or its group, (4, 4). Of other nodes it is a parameter."""
        return _fixed(_steradian.placement(self._scene, self._name))

    @to_world.setter
    def to_world(self, value: ArrayLike) -> None:
        matrix = np.asarray(value)
        if matrix.shape != (4, 4) or matrix.dtype.kind not in "iuf":
            found = f"the shape {matrix.shape} and the dtype {matrix.dtype}"
            raise SceneError(f"'{self._name}.to_world' has {found}, where (4, 4) numbers are needed")
        _steradian.set_placement(self._scene, self._name, matrix.astype(float).ravel().tolist())

    def set_mesh(self, **parts: Any) -> None:
        """Changes arrays of a mesh together, for one with more vertices: `node.set_mesh(positions=p, triangles=t, normals=None)`.

        Arrays that are None are left out, those that are not named stay. All shapes that share the mesh change.
        """
        arrays = _steradian.mesh(self._scene, self._name)
        given = mesh_arrays(parts, self._name)
        for name, value in parts.items():
            if value is None:
                arrays.pop(name, None)
            else:
                arrays[name] = given[name]
        _steradian.set_mesh(self._scene, self._name, arrays)

    def _part(self, name: str) -> NDArray[Any]:
        columns, whole = PARTS[name]
        found = _steradian.mesh(self._scene, self._name).get(name)
        return _fixed(np.empty((0, columns), np.uint32 if whole else np.float32) if found is None else found)

    def __repr__(self) -> str:
        return f"<steradian.Node '{self._name}' {dict(self)}>"


def _fixed(array: NDArray[Any]) -> NDArray[Any]:
    """Makes the copy of a scene's value read-only, since the scene would not know of a change."""
    array.flags.writeable = False
    return array


class Parameters(Mapping[str, Parameter]):
    """All parameters of a scene, by `node.parameter`, those at their defaults too. Setting takes effect at the next render.

    A snapshot: values that are set later by other ways are not in it.
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
        self._scene.set_text(node, parameter, text(value, key))
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
        """Warns once of each loss; notes are for those who ask."""
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
        """Messages of reading and compiling: approximations, parameters that nothing reads, …"""
        return self._inner.messages

    def params(self) -> Parameters:
        """All parameters, each with its value, default, type, unit, range and meaning: `scene.params()["clay.reflectance"].doc`."""
        return Parameters(self._inner)

    def material(self, name: str, *, color: str = "auto") -> Material:
        """A material by its name, to be evaluated."""
        return Material(self._inner.material(name, color=color))

    def trace(
        self, origins: ArrayLike, directions: ArrayLike, *, max_distance: ArrayLike = np.inf, time: float = 0.0
    ) -> Hits:
        """Nearest hits of rays, given as arrays (…, 3), which are broadcast.

        Distances are in units of the length of the direction. `time` is the moment of the exposure, from 0 to 1.
        """
        return _rays.trace(self._inner, origins, directions, max_distance, time)

    def occluded(
        self, origins: ArrayLike, directions: ArrayLike, max_distance: ArrayLike = np.inf, *, time: float = 0.0
    ) -> NDArray[np.bool_]:
        """True for rays that meet anything that scatters light before a distance, in units of the length of the direction.

        Rays that start at surfaces meet these, unless they start a little off: `hits.position + 1e-4 * hits.normal`.
        """
        return _rays.occluded(self._inner, origins, directions, max_distance, time)

    def sample_ray(
        self,
        xy: ArrayLike,
        *,
        u_lens: ArrayLike = (0.5, 0.5),
        time: ArrayLike = 0.0,
        camera: str | int | LookAt | None = None,
        size: tuple[int, int] | None = None,
    ) -> CameraRays:
        """Camera rays through points of the film, (…, 2), in pixels of the whole picture: (0.5, 0.5) is the middle of the top left one.

        `u_lens`, (…, 2) from 0 to 1, chooses points on the lens, whose middle is (0.5, 0.5); `time`, (…), from 0 to 1, moments of
        the exposure. All are broadcast. `camera` and `size` are those of `render`.
        """
        settings = _steradian.Settings(size=size, **camera_settings(camera))
        return _samples.sample_ray(self._inner, settings, xy, u_lens, time)

    def sample_emitter(
        self, points: ArrayLike, u: ArrayLike, *, normals: ArrayLike | None = None, time: ArrayLike = 0.0
    ) -> EmitterSamples:
        """Draws for each point, (…, 3), a light and a point on it by numbers u from 0 to 1, (…, 3): one for the light, two for the point.

        What is in between does not count: `occluded` tells. With `normals` only light from their side is drawn, by what it can give.
        Left out is light that only paths find: of media, and of surfaces given by equations or distances.
        """
        return _samples.sample_emitter(self._inner, points, u, normals, time)

    def meter(
        self,
        points: ArrayLike,
        *,
        normals: ArrayLike | None = None,
        directions: ArrayLike | None = None,
        flux: float | None = None,
        spp: int = 64000,
        error: float | None = None,
        seed: int = 0,
        max_depth: int | None = None,
        integrator: str | None = None,
        color: str = "auto",
    ) -> MeterReadings:
        """Light at points, (…, 3), with the numbers of `steradian meter`: scalar irradiance; irradiance of planes with `normals`; radiance
        from `directions`, which point away from the meter; flux with a radius, of discs with normals, else out of balls.

        Each reading takes `spp` samples, or goes on until half the width of its confidence interval is the part `error` of it.
        """
        return _samples.meter(
            self._inner, points, normals, directions, flux, spp=spp, error=error, seed=seed, max_depth=max_depth, integrator=integrator, color=color
        )

    @overload
    def render(
        self,
        *,
        spp: int | None = None,
        size: tuple[int, int] | None = None,
        crop: Sequence[int] | None = None,
        camera: str | int | LookAt | None = None,
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
        aov: Sequence[str] = (),
        transparent: bool = False,
        denoise: bool | str | None = None,
        resume: StrPath | None = None,
        frames: None = None,
        fps: float = 24.0,
        progress: bool | Callable[[Progress], Any] = False,
        client: Any = None,
        chunks: int | None = None,
    ) -> Image: ...

    @overload
    def render(self, *, frames: range | tuple[int, int], fps: float = 24.0, **settings: Any) -> Iterator[Image]: ...

    def render(
        self,
        *,
        spp: int | None = None,
        size: tuple[int, int] | None = None,
        crop: Sequence[int] | None = None,
        camera: str | int | LookAt | None = None,
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
        aov: Sequence[str] = (),
        transparent: bool = False,
        denoise: bool | str | None = None,
        resume: StrPath | None = None,
        frames: range | tuple[int, int] | None = None,
        fps: float = 24.0,
        progress: bool | Callable[[Progress], Any] = False,
        client: Any = None,
        chunks: int | None = None,
    ) -> Image | Iterator[Image]:
        """Renders the scene; all is as the options of `steradian render` of the same names say.

        `aov` is another name of `layers`. `camera` is the name or number of one, or a free viewpoint, `look_at(origin, target)`.
        `denoise` is True, or the name of a denoiser: "nlm", "atrous", "oidn". `resume` is a file that keeps the render: it goes
        on from there where the file is there, and is kept at the end and every half minute.

        With `transparent` the background is left out, and the ground that a model was given, unless `load` had `ground` in its
        `defines`; the layer `alpha` is coverage.

        `frames` of an animation, a range or (first, last), give an iterator of pictures, `fps` of them a second.

        `progress` is True for a line in the terminal or notebook, or called with a Progress about twenty times a second; if it returns
        False, the render ends. Ctrl-C ends it too. In both cases the picture of the samples that there are is returned, and its
        `stopped` says why.

        With a `client`, a distributed.Client, the workers of its Dask cluster render, in `chunks` parts; the picture has the same bits.
        `progress` is then called when a part has come, and `image` of the Progress is the picture so far.
        """
        if layers and aov:
            raise ValueError("layers and aov are two names of one setting: give one of them")
        if chunks is not None and client is None:
            raise ValueError("chunks are parts that workers compute: give a client, too")
        if resume is not None and (client is not None or frames is not None):
            raise ValueError("resume keeps one picture that is rendered here: it cannot go with client or frames")
        settings = dict(
            spp=spp, size=size, crop=crop, integrator=integrator, sampler=sampler, max_depth=max_depth, seed=seed, threads=threads,
            color=color, adaptive=adaptive, error=error, time=time, layers=list(layers or aov), transparent=transparent,
            denoise="nlm" if denoise is True else denoise or None,
            **camera_settings(camera),
        )
        if frames is not None:
            if client is not None:
                raise ValueError("frames go on from those before, which are here: they cannot go with client")
            return _frames.rendered(self, settings, frames, fps, progress)
        image = self._rendered(settings, progress, resume=resume, client=client, chunks=chunks)
        self._warn(self._inner.messages, 3)
        return image

    def _rendered(
        self,
        settings: dict[str, Any],
        progress: bool | Callable[[Progress], Any],
        *,
        resume: StrPath | None = None,
        before: _steradian.Frames | None = None,
        client: Any = None,
        chunks: int | None = None,
    ) -> Image:
        with shown(progress) as show:
            if client is None:
                image = self._inner.render(_steradian.Settings(**settings), show, resume=resume, before=before)
            else:
                from . import _dask

                image = _dask.render(self, settings, client, chunks, show)
        return image.denoise(settings["denoise"]) if settings["denoise"] else image

    def view(
        self,
        *,
        integrator: str | None = None,
        spp: int | None = None,
        size: tuple[int, int] | None = None,
        denoise: str | None = None,
        bind: str = "127.0.0.1",
        port: int = 0,
        open: bool | None = None,
    ) -> View:
        """Shows the scene, as it is now, in a page that renders while one looks: `steradian view` of the command line.

        The View ends with `close()`, at the end of a `with`, or when it goes away. In notebooks it is shown as a frame where a
        cell ends with it; elsewhere the browser opens, unless `open` is false. Anyone who knows the address may edit the page's copy of
        the scene, and save pictures into its folder. Noise is removed by the denoiser of a name, by default by the best there is,
        and with "off" not at all.
        """
        view = self._inner.view(integrator=integrator, spp=spp, size=size, denoise=denoise, bind=bind, port=port)
        if open or (open is None and not is_notebook()):
            webbrowser.open(view.url)
        return view

    def text(self, path: StrPath = "scene.steradian") -> str:
        """The scene in Steradian's own language; files are named as from `path`."""
        return self._inner.text(path)[0]

    def save(self, path: StrPath, *, overwrite: bool = False) -> None:
        """Writes the scene in the format of the extension (.steradian, .xml, .pbrt, .gltf, .glb), and meshes and pictures beside it.

        Losses by the format are warnings. FileExistsError where `path` is a file that the scene was read from, unless
        `overwrite` is true.
        """
        self._warn(self._inner.save(path, overwrite=overwrite), 3)

    def __copy__(self) -> Scene:
        return self._like(self._inner.copy())

    def __deepcopy__(self, memo: dict[int, Any]) -> Scene:
        return self._like(self._inner.copy())

    def _like(self, inner: _steradian.Scene) -> Scene:
        copy = Scene.__new__(Scene)
        copy._inner, copy._told = inner, set(self._told)
        return copy

    def __reduce__(self) -> tuple[Any, ...]:
        origin, search = self._inner.origin()
        path = os.path.abspath(origin or "scene")
        document, files = self._inner.text(path)
        return _restored, (document, {os.fspath(name): data for name, data in files}, path, [os.path.abspath(p) for p in search])

    def __repr__(self) -> str:
        return repr(self._inner)


def _restored(document: str, files: dict[str, bytes], path: str, search: list[str]) -> Scene:
    """Scene from its pickled form: its text, and meshes and pictures that it has in memory."""
    return Scene(_steradian.Scene.describe(document, files=files, path=path, search=search))
