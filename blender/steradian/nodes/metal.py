"""Rough metal: `conductor`, which alone gives back what facets reflect to each other, as Cycles' Multiscatter GGX does.

Its reflectance is chosen so that the mean over all directions is that of Cycles' F82 model: Schlick's reflectance, less
the lack of an edge tint at 82° (Hoffman 2019, Kutz et al. 2021).
"""

from __future__ import annotations

import math
from functools import lru_cache

from . import values as v

DIRECTIONS = [math.sqrt((i + 0.5) / 128) for i in range(128)]


def mean_f82(f0: float, tint: float) -> float:
    """Mean over the cosine of F82."""
    lack = (7 / 6) ** 6 * 7 * (f0 + (1 - f0) * (6 / 7) ** 5) * (1 - tint)
    return min(max(f0 + (1 - f0) / 21 - lack / 126, 0.0), 1.0)


def _metal(k2: float, cos: float) -> float:
    """Reflectance of a conductor of index 1 + i√k2."""
    c2, s2 = cos * cos, 1.0 - cos * cos
    d = 1.0 - k2 - s2
    ab = math.sqrt(d * d + 4.0 * k2)
    a = math.sqrt(max(0.5 * (ab + d), 0.0))
    rs = (ab + c2 - 2 * a * cos) / (ab + c2 + 2 * a * cos)
    return 0.5 * rs * (1.0 + (c2 * ab + s2 * s2 - 2 * a * cos * s2) / (c2 * ab + s2 * s2 + 2 * a * cos * s2))


@lru_cache(maxsize=4096)
def reflectance_of_mean(mean: float) -> float:
    """The reflectance at normal incidence of a conductor (of index 1 + i k) that has a mean over all directions."""
    low, high = 0.0, 0.9999
    for _ in range(24):
        r = 0.5 * (low + high)
        k2 = 4.0 * r / (1.0 - r)
        found = sum(_metal(k2, c) for c in DIRECTIONS) / len(DIRECTIONS)
        low, high = (r, high) if found < mean else (low, r)
    return 0.5 * (low + high)


def of_conductor(base, tint):
    """The `reflectance` of a conductor for a base colour and an edge tint."""
    tints = v.components(v.middle(tint))
    parts = [v.apply(lambda c, t=t: reflectance_of_mean(round(mean_f82(c, t), 4)), b)
             for b, t in zip(v.components(base), tints)]
    if isinstance(base, v.Field) and len(set(tints)) == 1:
        return v.apply(lambda c: reflectance_of_mean(round(mean_f82(c, tints[0]), 4)), base)
    return v.combine_colour(*parts)


def conductor(base, tint, roughness, stretch: float = 1.0) -> dict:
    """Rough metal with compensation; `stretch` is α along the tangent over that of an isotropic surface."""
    alpha = v.multiply(roughness, roughness)
    made = {
        "material": "conductor",
        "reflectance": v.scene(of_conductor(base, tint)),
        "alpha_u": v.scene(v.multiply(alpha, stretch)),
        "compensation": "kulla_conty",
    }
    if stretch != 1.0:
        made["alpha_v"] = v.scene(v.multiply(alpha, 1.0 / stretch))
    return made
