"""Lamps that have a shape, which Blender's camera does not see."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Lamp:
    """A ball around a lamp, and the direction that it shines into where that is one side alone."""

    name: str
    center: NDArray[np.float64]
    radius: float
    normal: NDArray[np.float64] | None


def in_view(lamp: Lamp, camera: Mapping[str, Any]) -> bool:
    """True if a camera may see a lamp that nothing hides; never false where it does."""
    if camera["camera"] != "perspective":
        return True
    return any(
        _from(lamp, camera, np.asarray(camera[place])) for place in ("to_world", "to_world_end") if place in camera
    )


def _from(lamp: Lamp, camera: Mapping[str, Any], place: NDArray[np.float64]) -> bool:
    eye = place[:3, 3]
    way = lamp.center - eye
    distance = float(np.linalg.norm(way))
    lens = camera.get("lens_radius", 0.0)
    radius = lamp.radius + lens * (1 + distance / camera.get("focal_distance", 1e6))
    if lamp.normal is not None and float(lamp.normal @ -way) <= -lens:
        return False
    if distance <= radius:
        return True
    x0, x1, y0, y1 = camera.get("screen_window", (-1, 1, -1, 1))
    corners = np.array([[x, y, 1.0] for x in (x0, x1) for y in (y0, y1)]) @ place[:3, :3].T
    corners /= np.linalg.norm(corners, axis=1, keepdims=True)
    axis = corners.sum(axis=0) / np.linalg.norm(corners.sum(axis=0))
    half = np.arccos(np.clip((corners @ axis).min(), -1, 1))
    angle = np.arccos(np.clip(float(way @ axis) / distance, -1, 1))
    return bool(angle <= half + np.arcsin(min(radius / distance, 1.0)) + 1e-3)
