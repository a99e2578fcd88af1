"""Rays through scenes and directions at materials: arrays in, arrays out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _steradian


@dataclass(frozen=True, eq=False)
class Hits:
    """Nearest hits of rays, each field an array of one row for each ray.

    Where a ray met nothing, `t` is infinite, `shape` and `material` are 0, and `primitive` is -1.
    """

    t: NDArray[np.float32]
    """Distances, in units of the length of the direction."""
    position: NDArray[np.float32]
    """Points in the world; infinite where there is none."""
    geometric_normal: NDArray[np.float32]
    """Unit normals of the surfaces, as these are oriented."""
    normal: NDArray[np.float32]
    """Unit shading normals, with normal and bump maps; on the viewer's side for materials that only reflect."""
    uv: NDArray[np.float32]
    """Surface parameters."""
    primitive: NDArray[np.int32]
    """Numbers of triangles within meshes, from 0."""
    instance: NDArray[np.int32]
    """Numbers of instances, from 0; -1 for what is in the world itself."""
    shape: NDArray[np.uint32]
    """Numbers of shapes, from 1, as in the layer `ids`."""
    material: NDArray[np.uint32]
    """Numbers of materials, from 1, as in the layer `ids`."""
    shape_names: dict[int, str]
    """The names of shapes by their numbers."""
    material_names: dict[int, str]
    """The names of materials by their numbers."""

    @property
    def hit(self) -> NDArray[np.bool_]:
        """True for rays that met anything."""
        return np.isfinite(self.t)

    @property
    def shape_name(self) -> NDArray[Any]:
        """Names of the shapes; empty where nothing was met."""
        return named(self.shape, self.shape_names)

    @property
    def material_name(self) -> NDArray[Any]:
        """Names of the materials; empty where nothing was met."""
        return named(self.material, self.material_names)

    def __repr__(self) -> str:
        return f"<steradian.Hits: {int(self.hit.sum())} of {self.t.size} rays>"


def named(numbers: NDArray[Any], names: dict[int, str]) -> NDArray[Any]:
    """Names by numbers; empty for those that have none."""
    table = np.full(max([int(numbers.max(initial=0)), *names]) + 1, "", dtype=object)
    for number, name in names.items():
        table[number] = name
    named: NDArray[Any] = table[numbers]
    return named


@dataclass(frozen=True, eq=False)
class BsdfSamples:
    """Sampled directions, each field an array of one row for each; where none was drawn, weight and pdf are zero."""

    wi: NDArray[np.float32]
    """Unit directions, away from the surface; zero where none was drawn, for which eval and pdf are zero."""
    weight: NDArray[np.float32]
    """f·|cos θi| / pdf: colours, or four wavelengths."""
    pdf: NDArray[np.float32]
    """Densities in 1/sr; of specular lobes the probability with which they were chosen."""
    eta: NDArray[np.float32]
    """Relative index of refraction that a transmitted ray met, else 1."""
    specular: NDArray[np.bool_]
    """True for lobes of mirrors and clear panes, which eval and pdf leave out."""

    def __repr__(self) -> str:
        return f"<steradian.BsdfSamples: {int((self.pdf > 0).sum())} of {self.pdf.size} directions>"


def vectors(name: str, value: ArrayLike, columns: tuple[int, ...] = (3,)) -> NDArray[np.float32]:
    """Array of rows of so many numbers."""
    array = np.asarray(value)
    if array.dtype.kind not in "iuf":
        raise ValueError(f"{name} has the dtype {array.dtype}, where numbers are needed")
    if array.ndim == 0 or array.shape[-1] not in columns:
        raise ValueError(f"{name} has the shape {array.shape}, where (…, {' or '.join(map(str, columns))}) is needed")
    return array.astype(np.float32, copy=False)


def together(**arrays: tuple[NDArray[Any], int]) -> tuple[tuple[int, ...], list[NDArray[Any]]]:
    """Broadcasts arrays of rows to one shape but for their columns; returns that shape, and the rows of each."""
    try:
        shape = np.broadcast_shapes(*(a.shape[: a.ndim - columns] for a, columns in arrays.values()))
    except ValueError:
        found = ", ".join(f"{name} {a.shape}" for name, (a, _) in arrays.items())
        raise ValueError(f"these shapes do not go together: {found}") from None
    rows = int(np.prod(shape))
    whole = [np.broadcast_to(a, shape + a.shape[a.ndim - columns :]) for a, columns in arrays.values()]
    return shape, [np.ascontiguousarray(a).reshape((rows,) + a.shape[len(shape) :]) for a in whole]


def _query(
    origins: ArrayLike, directions: ArrayLike, max_distance: ArrayLike
) -> tuple[tuple[int, ...], list[NDArray[np.float32]]]:
    end = np.asarray(max_distance, np.float32)
    return together(origins=(vectors("origins", origins), 1), directions=(vectors("directions", directions), 1), max_distance=(end, 0))


def trace(scene: _steradian.Scene, origins: ArrayLike, directions: ArrayLike, max_distance: ArrayLike, time: float) -> Hits:
    """As Scene.trace."""
    shape, rows = _query(origins, directions, max_distance)
    found = _steradian.trace(scene, *rows, time=time)
    names = {"shape_names": found.pop("shape_names"), "material_names": dict(found.pop("material_names"))}
    return Hits(**{name: a.reshape(shape + a.shape[1:]) for name, a in found.items()}, **names)


def occluded(
    scene: _steradian.Scene, origins: ArrayLike, directions: ArrayLike, max_distance: ArrayLike, time: float
) -> NDArray[np.bool_]:
    """As Scene.occluded."""
    shape, rows = _query(origins, directions, max_distance)
    return _steradian.occluded(scene, *rows, time=time).reshape(shape)


class Material:
    """A material as a function of directions. They point away from the surface, whose normal is +z, and have length one."""

    def __init__(self, inner: _steradian.Material):
        self._inner = inner

    def _evaluate(self, wo: ArrayLike, wi: ArrayLike, uv: tuple[float, float]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        shape, rows = together(wo=(vectors("wo", wo), 1), wi=(vectors("wi", wi), 1))
        values, densities = self._inner.evaluate(*rows, uv=uv)
        return values.reshape(*shape, values.shape[1]), densities.reshape(shape)

    def eval(self, wo: ArrayLike, wi: ArrayLike, *, uv: tuple[float, float] = (0.5, 0.5)) -> NDArray[np.float32]:
        """f·|cos θi| in 1/sr for arrays of directions (…, 3), which are broadcast: (…, 3) colours, or (…, 4) wavelengths."""
        return self._evaluate(wo, wi, uv)[0]

    def pdf(self, wo: ArrayLike, wi: ArrayLike, *, uv: tuple[float, float] = (0.5, 0.5)) -> NDArray[np.float32]:
        """Density in 1/sr with which `sample` draws wi."""
        return self._evaluate(wo, wi, uv)[1]

    def sample(self, wo: ArrayLike, u: ArrayLike, *, uv: tuple[float, float] = (0.5, 0.5)) -> BsdfSamples:
        """Draws a direction for each of wo by numbers u from 0 to 1, (…, 3): one for the lobe, two for the direction.

        A fourth chooses the part of mixtures; by default it is a hash of the other three.
        """
        shape, rows = together(wo=(vectors("wo", wo), 1), u=(vectors("u", u, (3, 4)), 1))
        wi, weight, pdf, eta, specular = self._inner.sample(*rows, uv=uv)
        lanes = (*shape, weight.shape[1])
        return BsdfSamples(wi.reshape(*shape, 3), weight.reshape(lanes), pdf.reshape(shape), eta.reshape(shape), specular.reshape(shape))

    def albedo(self, wo: ArrayLike, *, samples: int = 1024, uv: tuple[float, float] = (0.5, 0.5)) -> NDArray[np.float32]:
        """Albedo for light from each direction: the part that is reflected or transmitted, estimated from so many samples."""
        shape, rows = together(wo=(vectors("wo", wo), 1))
        found = self._inner.albedo(*rows, samples=samples, uv=uv)
        return found.reshape(*shape, found.shape[1])

    def laws(self, *, samples: int = 20_000, uv: tuple[float, float] = (0.5, 0.5)) -> list[dict[str, Any]]:
        """The laws of scattering, as `steradian material --laws` tests them: positivity, reciprocity, energy, and χ² of samples.

        A dictionary for each: law, angle (degrees, or None), found, expected, p (or None), holds.
        """
        names = ("law", "angle", "found", "expected", "p", "holds")
        return [dict(zip(names, row)) for row in self._inner.laws(samples=samples, uv=uv)]

    def __repr__(self) -> str:
        return repr(self._inner)
