"""Matrices of Blender as arrays."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def array(matrix: Any) -> NDArray[np.float64]:
    """A 4 × 4 matrix of Blender as an array by rows."""
    return np.array(matrix, np.float64)


def rigid(matrix: Any) -> NDArray[np.float64]:
    """A matrix without its scale: the axes have length one, as cameras and lights take them."""
    m = array(matrix)
    lengths = np.linalg.norm(m[:3, :3], axis=0)
    m[:3, :3] /= np.where(lengths > 0, lengths, 1)
    return m


def usable(m: NDArray[np.float64]) -> bool:
    """True if a matrix is finite and has an inverse."""
    return bool(np.isfinite(m).all()) and abs(float(np.linalg.det(m[:3, :3]))) > 1e-30


# Blender's cameras and lights look along -z, those of the scene language along +z.
FLIP = np.diag([1.0, 1.0, -1.0, 1.0])
