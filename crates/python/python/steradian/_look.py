"""Free viewpoints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

Point = tuple[float, float, float]


@dataclass(frozen=True)
class LookAt:
    """A viewpoint for `camera=` of renders: the scene's camera is moved there, and keeps its lens."""

    origin: Point
    """Position of the camera, in the world."""
    target: Point
    """Point that it looks at."""
    up: Point
    """Direction that the picture shows upwards."""
    fov: float | None
    """Angle of view, degrees, as the camera's `fov_axis` says; None for its own."""
    camera: str | None
    """Name or number of the camera that is moved; None for the first."""


def look_at(
    origin: ArrayLike, target: ArrayLike, up: ArrayLike = (0.0, 1.0, 0.0), fov: float | None = None, *, camera: str | int | None = None
) -> LookAt:
    """A viewpoint for `camera=` of renders: position, target, direction that is up, and the angle of view, degrees."""
    points = _point("origin", origin), _point("target", target), _point("up", up)
    return LookAt(*points, None if fov is None else float(fov), None if camera is None else str(camera))


def _point(name: str, value: ArrayLike) -> Point:
    array = np.asarray(value)
    if array.shape != (3,) or array.dtype.kind not in "iuf":
        raise ValueError(f"{name} has the shape {array.shape} and the dtype {array.dtype}, where three numbers are needed")
    x, y, z = map(float, array)
    return x, y, z


def camera_settings(camera: str | int | LookAt | None) -> dict[str, Any]:
    """The settings of a render that name a camera, or move one."""
    if not isinstance(camera, LookAt):
        return dict(camera=None if camera is None else str(camera))
    at: Sequence[Point] = [camera.origin, camera.target, camera.up]
    return dict(camera=camera.camera, look_at=at, fov=camera.fov)
