"""Rough metal: `conductor`, which gives back what facets reflect to each other in the directions of Cycles' Multiscatter GGX.

Its index is chosen so that the reflectance at normal incidence and the mean over all directions are those of Cycles' F82
model: Schlick's reflectance, less the lack of an edge tint at 82° (Hoffman 2019, Kutz et al. 2021).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from . import values as v

DIRECTIONS = np.sqrt((np.arange(64) + 0.5) / 64)
BASES = np.linspace(0.0, 1.0, 41)
SHARES = np.linspace(0.0, 1.0, 33)
# Albedo of white facets by roughness, mean over the hemisphere by the cosine.
ROUGHNESS = np.linspace(0.0, 1.0, 11)
FACETS = np.array([1.0, 0.9987, 0.9939, 0.9759, 0.9403, 0.8822, 0.8031, 0.7071, 0.6037, 0.5018, 0.4085])


def mean_f82(f0, tint):
    """Mean over the cosine of F82."""
    lack = (7 / 6) ** 6 * 7 * (f0 + (1 - f0) * (6 / 7) ** 5) * (1 - tint)
    return np.clip(f0 + (1 - f0) / 21 - lack / 126, 0.0, 1.0)


def reflectance(n, k2, cos):
    """Reflectance of a conductor of index n + i√k2."""
    c2, s2 = cos * cos, 1.0 - cos * cos
    d = n * n - k2 - s2
    ab = np.sqrt(d * d + 4.0 * n * n * k2)
    a = np.sqrt(np.maximum(0.5 * (ab + d), 0.0))
    rs = (ab + c2 - 2 * a * cos) / (ab + c2 + 2 * a * cos)
    return 0.5 * rs * (1.0 + (c2 * ab + s2 * s2 - 2 * a * cos * s2) / (c2 * ab + s2 * s2 + 2 * a * cos * s2))


def _index(r, share):
    """n between 1 and that of a dielectric of reflectance r at normal incidence, and the k² that goes with it."""
    root = np.sqrt(r)
    n = 1.0 + share * ((1.0 + root) / (1.0 - root) - 1.0)
    return n, np.maximum(r * (n + 1.0) ** 2 - (n - 1.0) ** 2, 0.0) / (1.0 - r)


def _mean(r, share):
    n, k2 = _index(r[..., None], share[..., None])
    return reflectance(n, k2, DIRECTIONS).mean(-1)


@lru_cache(maxsize=256)
def table(tint: float):
    """n and k for each of `BASES` under an edge tint."""
    wanted = mean_f82(BASES, tint)
    r = np.clip(BASES, 0.02, 0.9995)
    means = _mean(np.broadcast_to(r[:, None], (len(r), len(SHARES))), np.broadcast_to(SHARES, (len(r), len(SHARES))))
    share = SHARES[np.abs(means - wanted[:, None]).argmin(1)]
    low, high = np.zeros_like(r), np.full_like(r, 0.9995)
    for _ in range(24):
        r = 0.5 * (low + high)
        is_less = _mean(r, share) < wanted
        low, high = np.where(is_less, r, low), np.where(is_less, high, r)
    n, k2 = _index(r, share)
    return n, np.sqrt(k2)


def index_of(base, tint):
    """`eta` and `k` of a conductor for a base colour and an edge tint."""
    tints = [round(float(t), 3) for t in v.components(v.middle(tint))]

    def component(c, t, which):
        return v.apply(lambda x: float(np.interp(x, BASES, table(t)[which])), c)

    if isinstance(base, v.Field) and len(set(tints)) == 1:
        return tuple(component(base, tints[0], i) for i in (0, 1))
    return tuple(v.combine_colour(*(component(c, t, i) for c, t in zip(v.components(base), tints))) for i in (0, 1))


def _factor(mean: float, f0: float, roughness: float) -> float:
    """`specular_reflectance` s at which Turquin's compensation, s(1 + s F₀(1 − E)/E), is that of Cycles, where
    F̄E/(1 − F̄(1 − E)) stands for F₀."""
    e = float(np.interp(roughness, ROUGHNESS, FACETS))
    lost, again = (1.0 - e) / e, mean * e / (1.0 - mean * (1.0 - e))
    a, wanted = f0 * lost, 1.0 + again * lost
    return min(2.0 * wanted / (1.0 + (1.0 + 4.0 * a * wanted) ** 0.5), 1.0)


def constant_reflectance(colour, roughness: float):
    """`specular_reflectance` of a perfect mirror with Turquin's compensation for facets that reflect one colour, which is
    its F₀ too."""
    return v.apply(lambda c: c * _factor(c, c, roughness), colour)


def darkening(base, tint, roughness: float):
    """`specular_reflectance` of a metal with Turquin's compensation, for the compensation of Cycles."""

    def factor(c, t):
        return _factor(float(mean_f82(c, t)), c, roughness)

    tints = v.components(v.middle(tint))
    if isinstance(base, v.Field) and len(set(tints)) == 1:
        return v.apply(lambda c: factor(c, tints[0]), base)
    return v.combine_colour(*(v.apply(lambda c, t=t: factor(c, t), b) for b, t in zip(v.components(base), tints)))


def conductor(base, tint, roughness, stretch: float = 1.0) -> dict:
    """Rough metal with compensation; `stretch` is α along the tangent over that of an isotropic surface."""
    alpha, (eta, k) = v.multiply(roughness, roughness), index_of(base, tint)
    made = {
        "material": "conductor",
        "eta": v.scene(eta),
        "k": v.scene(k),
        "alpha_u": v.scene(v.multiply(alpha, stretch)),
        "compensation": "turquin",
        "specular_reflectance": v.scene(darkening(base, tint, v.middle(roughness))),
    }
    if stretch != 1.0:
        made["alpha_v"] = v.scene(v.multiply(alpha, 1.0 / stretch))
    return made
