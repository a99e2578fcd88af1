"""What the shader sockets of a tree carry: a material of ours, the light that it emits, and its opacity."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Optional

from . import values as v

BLACK = {"material": "diffuse", "reflectance": 0.0}
WHITE = (1.0, 1.0, 1.0)

# Parameters of each kind that scale all of its light.
COLOURS = {
    "diffuse": ("reflectance",),
    "oren_nayar": ("reflectance",),
    "conductor": ("specular_reflectance",),
    "dielectric": ("specular_reflectance", "specular_transmittance"),
    "thin_dielectric": ("specular_reflectance", "specular_transmittance"),
    "diffuse_transmission": ("reflectance", "transmittance"),
}


@dataclass(frozen=True)
class Surface:
    """A closure: of the part `opacity` of the light, `material` scatters it and `emission` is added; the rest passes
    straight on. No material stands for one that is black."""

    material: Optional[dict] = None
    emission: Any = 0.0
    opacity: Any = 1.0

    @property
    def emits(self) -> bool:
        return v.bounds(self.emission)[1] > 0


CLEAR = Surface(None, 0.0, 0.0)


def stained(colour) -> dict:
    """Light that passes straight on, coloured."""
    return {
        "material": "thin_dielectric",
        "eta": 1.0,
        "specular_reflectance": 0.0,
        "specular_transmittance": v.scene(colour),
    }


def mixed(here, a: Surface, b: Surface, share) -> Surface:
    """A mix of two; `share` of the second. What passes counts towards the opacity of both together."""
    share = v.clamp(share)
    if share == 0.0:
        return a
    if share == 1.0:
        return b
    left, right = v.multiply(v.subtract(1.0, share), a.opacity), v.multiply(share, b.opacity)
    opacity = v.add(left, right) if a.opacity != b.opacity else a.opacity
    if opacity == 0.0:
        return CLEAR
    if left == 0.0 or right == 0.0:
        return replace(b if left == 0.0 else a, opacity=opacity)
    if opacity == a.opacity == b.opacity:
        inner = share
    else:
        inner = v.clamp(v.combine(lambda x, y: x / y if y else 0.0, right, opacity, "({a}/{b})", None, here.tell))
    emission = v.mix(v.as_colour(a.emission), v.as_colour(b.emission), inner)
    if a.material == b.material:
        return Surface(a.material, emission, opacity)
    pair = [a.material or BLACK, b.material or BLACK]
    return Surface({"material": "mix", "materials": pair, "amount": v.scene(inner)}, emission, opacity)


def scaled(material: dict, factor: float) -> Optional[dict]:
    """A material whose light is scaled by a factor; `None` where its kind has no such parameter, or it would pass one."""
    names = COLOURS.get(material["material"])
    if names is None:
        return None
    out = dict(material)
    for name in names:
        value = material.get(name, 1.0)
        if isinstance(value, dict):
            if factor > 1.0:
                return None
            out[name] = {"texture": "mix", "a": 0.0, "b": value, "amount": factor}
        else:
            parts = [factor * c for c in (value if isinstance(value, list) else [value])]
            if max(parts) > 1.0 + 1e-6:
                return None
            out[name] = parts if isinstance(value, list) else parts[0]
    return out


def added(here, a: Surface, b: Surface) -> Surface:
    """The sum of two: a mix of both, each divided by its share."""
    emission = v.add(v.as_colour(a.emission), v.as_colour(b.emission))
    if a.opacity != 1.0 or b.opacity != 1.0:
        here.tell("a sum with a transparent shader lets more light pass than is there: it is taken as a mix by halves")
        return replace(mixed(here, a, b, 0.5), emission=emission)
    scattering = [s.material for s in (a, b) if s.material is not None]
    if len(scattering) < 2:
        return Surface(scattering[0] if scattering else None, emission)
    for share in (0.5, 0.25, 0.75, 0.1, 0.9):
        left, right = scaled(scattering[0], 1.0 / (1.0 - share)), scaled(scattering[1], 1.0 / share)
        if left is not None and right is not None:
            return Surface({"material": "mix", "materials": [left, right], "amount": share}, emission)
    here.tell("a sum of two shaders that may reflect more than they receive: it is taken as their mix by halves")
    return Surface({"material": "mix", "materials": scattering, "amount": 0.5}, emission)
