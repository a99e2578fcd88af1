"""Samples of cameras and lights, and light meters: arrays in, arrays out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _steradian
from ._rays import named, together, vectors


@dataclass(frozen=True, eq=False)
class CameraRays:
    """Rays of a camera, each field an array of one row for each."""

    origin: NDArray[np.float32]
    """Points in the world."""
    direction: NDArray[np.float32]
    """Unit directions."""
    weight: NDArray[np.float32]
    """Share of the radiance that counts: 1, but for lenses of several elements; 0 where these stop the ray."""

    def __repr__(self) -> str:
        return f"<steradian.CameraRays: {self.weight.size} rays>"


@dataclass(frozen=True, eq=False)
class EmitterSamples:
    """Samples of lights, each field an array of one row for each; where no light was drawn, weight and pdf are zero."""

    wi: NDArray[np.float32]
    """Unit directions to the light."""
    distance: NDArray[np.float32]
    """Distances to the point on the light; infinite for light from afar."""
    weight: NDArray[np.float32]
    """Radiance / pdf, colours; the mean of weight·cos is the irradiance without shadows."""
    pdf: NDArray[np.float32]
    """Densities in 1/sr, choice of light included; of light from a point or in parallel the probability of its choice."""
    delta: NDArray[np.bool_]
    """True for light from a point or in parallel, which no ray finds by chance."""
    light: NDArray[np.uint32]
    """Numbers of groups of lights, from 1; 0 where none was drawn."""
    light_names: dict[int, str]
    """The names of groups of lights by their numbers."""

    @property
    def light_name(self) -> NDArray[Any]:
        """Names of the lights' groups; empty where none was drawn."""
        return named(self.light, self.light_names)

    def __repr__(self) -> str:
        return f"<steradian.EmitterSamples: {int((self.pdf > 0).sum())} of {self.pdf.size} samples>"


@dataclass(frozen=True, eq=False)
class MeterReadings:
    """Readings of a light meter, each field an array of one row for each point.

    Errors are half the widths of confidence intervals of 95 %.
    """

    quantity: str
    """`scalar irradiance`, `irradiance`, `radiance` or `flux`."""
    rgb: NDArray[np.float64]
    """The quantity in linear Rec.709."""
    rgb_error: NDArray[np.float64]
    """Errors of these."""
    luminous: NDArray[np.float64]
    """Photometric values: lx, cd/m² of a radiance, lm of a flux."""
    luminous_error: NDArray[np.float64]
    """Errors of these."""
    radiant: NDArray[np.float64] | None
    """Radiometric values from 360 to 830 nm: W/m², W/(m²·sr) of a radiance, W of a flux; None in RGB mode."""
    radiant_error: NDArray[np.float64] | None
    """Errors of these; None in RGB mode."""
    samples: NDArray[np.uint32]
    """Numbers of samples taken."""

    def __repr__(self) -> str:
        return f"<steradian.MeterReadings: {self.quantity} at {self.samples.size} points>"


def _numbers(name: str, value: ArrayLike) -> NDArray[np.float32]:
    """Numbers of any shape as rows of one."""
    return vectors(name, np.asarray(value)[..., None], (1,))


def sample_ray(
    scene: _steradian.Scene, settings: _steradian.Settings, xy: ArrayLike, u_lens: ArrayLike, time: ArrayLike
) -> CameraRays:
    """As Scene.sample_ray."""
    shape, rows = together(xy=(vectors("xy", xy, (2,)), 1), u_lens=(vectors("u_lens", u_lens, (2,)), 1), time=(_numbers("time", time), 1))
    found = _steradian.sample_ray(scene, settings, *rows)
    return CameraRays(**{name: a.reshape(shape + a.shape[1:]) for name, a in found.items()})


def sample_emitter(
    scene: _steradian.Scene, points: ArrayLike, u: ArrayLike, normals: ArrayLike | None, time: ArrayLike
) -> EmitterSamples:
    """As Scene.sample_emitter."""
    sides = np.zeros(3, np.float32) if normals is None else vectors("normals", normals)
    shape, rows = together(
        points=(vectors("points", points), 1), normals=(sides, 1), u=(vectors("u", u), 1), time=(_numbers("time", time), 1)
    )
    found = _steradian.sample_emitter(scene, *rows)
    names = dict(found.pop("light_names"))
    return EmitterSamples(**{name: a.reshape(shape + a.shape[1:]) for name, a in found.items()}, light_names=names)


def meter(
    scene: _steradian.Scene, points: ArrayLike, normals: ArrayLike | None, directions: ArrayLike | None, flux: float | None, **settings: Any
) -> MeterReadings:
    """As Scene.meter."""
    if directions is not None and (normals is not None or flux is not None):
        raise ValueError("with directions the meter has neither normals nor a flux")
    vectors("points", points)
    given: dict[str, tuple[NDArray[Any], int]] = dict(points=(np.asarray(points, np.float64), 1))
    for name, value in dict(normals=normals, directions=directions).items():
        if value is not None:
            given[name] = vectors(name, value), 1
    shape, (at, *aims) = together(**given)
    found = _steradian.meter(scene, at, aims[0] if aims else None, are_directions=directions is not None, flux=flux, **settings)
    plain = "radiance" if directions is not None else "irradiance" if normals is not None else "scalar irradiance"
    arrays = {name: None if a is None else a.reshape(shape + a.shape[1:]) for name, a in found.items()}
    return MeterReadings("flux" if flux is not None else plain, **arrays)
