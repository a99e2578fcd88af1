"""The Principled BSDF as `openpbr`, which has nearly the same layers, and `conductor` for rough metal."""

from __future__ import annotations

import math

from . import sheen, values as v
from .metal import conductor
from .normals import maps
from .registry import scatters
from .surface import Surface

WHITE = (1.0, 1.0, 1.0)
# An index has no edge that is much darker than Schlick's.
LEAST_TINT = 0.6


def f0_of_ior(n: float) -> float:
    """Reflectance at normal incidence."""
    return ((n - 1.0) / (n + 1.0)) ** 2


def ior_of_f0(f0: float) -> float:
    """The index with that reflectance, held as by Cycles."""
    root = math.sqrt(min(max(f0, 0.0), 0.99))
    return (1.0 + root) / (1.0 - root)


def specular(here) -> dict:
    """Index and strength: a constant `Specular IOR Level` changes the index, as in Cycles; one that varies is a factor."""
    n, level = max(here.constant("IOR", 1.5), 1e-3), here.number("Specular IOR Level", 0.5)
    if v.is_constant(level):
        changed = n if level == 0.5 else ior_of_f0(f0_of_ior(n) * 2.0 * max(level, 0.0))
        changed = 1.0 / changed if n < 1.0 and level != 0.5 else changed
        if f0_of_ior(changed) < 1e-6:
            return {"specular_ior": 1.0, "specular_weight": 0.0}
        return {"specular_ior": min(max(changed, 0.05), 20.0)}
    if level.high > 0.5:
        here.tell("'Specular IOR Level' from a texture above 0.5 counts as 0.5, or by the greater index of its maximum")
        n = ior_of_f0(f0_of_ior(n) * 2.0 * min(level.high, 1.0))
        level = v.multiply(level, 0.5 / min(level.high, 1.0))
    return {"specular_ior": min(max(n, 0.05), 20.0), "specular_weight": v.scene(v.clamp(v.multiply(level, 2.0)))}


def stretched(roughness, q: float):
    """OpenPBR's roughness and anisotropy for α of r²/√q along the tangent and r²√q across.

    It has r'²√(2/(1 + q²)) along, and q times that across.
    """
    return v.clamp(v.multiply(roughness, ((1.0 + q * q) / (2.0 * q)) ** 0.25)), 1.0 - q


def anisotropy(here, roughness) -> dict:
    """Roughness, stretch and its turn."""
    amount = here.constant("Anisotropic")
    if here.is_linked("Tangent"):
        here.tell("the tangent is that of the UV map, not what feeds 'Tangent'")
    if amount <= 0.0:
        return {"specular_roughness": v.scene(roughness)}
    roughness, held = stretched(roughness, 1.0 - 0.9 * min(amount, 1.0))
    turn = v.multiply(here.number("Anisotropic Rotation"), 360.0)
    return {
        "specular_roughness": v.scene(roughness),
        "specular_roughness_anisotropy": held,
        "anisotropy_rotation": v.scene(turn),
    }


def mean_free_path(albedo: float, ior: float) -> float:
    """Factor from Cycles' radius of the random walk to the mean free path: √(3(1 − α′)), with Jensen's α′ of the albedo
    under a dipole of that index."""
    inverse = 1.0 / ior
    diffuse = inverse * (-1.440 * inverse + 0.710) + 0.668 + 0.0636 * ior
    boundary = (1.0 + diffuse) / (1.0 - diffuse)

    def reflected(alpha):
        root = math.sqrt(3.0 * (1.0 - alpha))
        return 0.5 * alpha * (1.0 + math.exp(-4.0 / 3.0 * boundary * root)) * math.exp(-root)

    low, high = 0.0, 1.0
    for _ in range(40):
        alpha = 0.5 * (low + high)
        low, high = (alpha, high) if reflected(alpha) < albedo else (low, alpha)
    return math.sqrt(3.0 * (1.0 - 0.5 * (low + high)))


def subsurface(here, base) -> dict:
    """Subsurface scattering of the base's colour."""
    weight = v.clamp(here.number("Subsurface Weight"))
    if weight == 0.0:
        return {}
    radius, scale = here.colour("Subsurface Radius"), here.number("Subsurface Scale", 0.05)
    method = here.node.subsurface_method
    ior = here.constant("Subsurface IOR", 1.4) if method == "RANDOM_WALK_SKIN" else max(here.constant("IOR", 1.5), 1.0)
    colour = v.middle(base)
    if method == "RANDOM_WALK":
        factor = tuple(mean_free_path(min(max(c, 0.0), 0.99), min(max(ior, 1.0001), 3.8)) for c in colour)
    else:
        factor = (0.25 / math.pi,) * 3
    if method == "BURLEY":
        here.tell("Christensen and Burley's profile is taken as a random walk of the same mean free path")
    if not v.is_constant(base) and method == "RANDOM_WALK":
        here.tell("the mean free path is that of the base colour's middle")
    return {
        "subsurface_weight": v.scene(weight),
        "subsurface_color": v.scene(v.clamp(base)),
        "subsurface_radius": v.scene(scale),
        "subsurface_radius_scale": v.scene(v.multiply(radius, factor)),
        "subsurface_scatter_anisotropy": here.constant("Subsurface Anisotropy") if method != "BURLEY" else 0.0,
    }


def glass(base) -> dict:
    """Refraction, coloured by the root of the base's colour at each passage."""
    root = v.apply(lambda x: math.sqrt(max(x, 0.0)), v.clamp(base), "sqrt(max({a},0))")
    return {"transmission_weight": 1.0, "transmission_color": v.scene(root)}


def coat(here) -> dict:
    """The clear coat."""
    weight = v.clamp(here.number("Coat Weight"))
    if weight == 0.0:
        return {}
    made = {
        "coat_weight": v.scene(weight),
        "coat_roughness": v.scene(v.clamp(here.number("Coat Roughness", 0.03))),
        "coat_ior": v.scene(v.clamp(here.number("Coat IOR", 1.5), 1.0, 20.0)),
        # Cycles does not count that a coat sends light back to the base.
        "coat_darkening": 0.0,
    }
    tint = here.colour("Coat Tint", WHITE)
    if tint != WHITE:
        made["coat_color"] = v.scene(v.clamp(tint))
    own = maps(here, "Coat Normal")
    if "normal_map" in own:
        made["coat_normal_map"] = own["normal_map"]
        if "normal_map_strength" in own:
            made["coat_normal_map_strength"] = own["normal_map_strength"]
    elif "bump" in own:
        here.tell("bumps of the coat are not known: it has the surface's own normal")
    if "normal_map" not in own:
        made["coat_normals"] = "own"
    return made


def sheen_of(here) -> tuple:
    """Weight, tint and roughness of the sheen."""
    weight, roughness = v.clamp(here.number("Sheen Weight")), v.clamp(here.number("Sheen Roughness", 0.5))
    return weight, here.colour("Sheen Tint", WHITE), roughness


def film(here) -> dict:
    """A film that interferes."""
    thickness = here.number("Thin Film Thickness")
    if thickness == 0.0:
        return {}
    return {
        "thin_film_weight": 1.0,
        "thin_film_thickness": v.scene(thickness),
        "thin_film_ior": v.scene(v.clamp(here.number("Thin Film IOR", 1.33), 1.0, 5.0)),
    }


def emitted(here):
    """Radiance by colour and strength."""
    strength = here.number("Emission Strength")
    return 0.0 if strength == 0.0 else v.multiply(here.colour("Emission Color", WHITE), strength)


def common(here) -> dict:
    """What all parts of the surface have: layers above, and normals."""
    made = {**coat(here), **film(here), **maps(here)}
    soft = sheen_of(here)
    if soft[0] != 0.0:
        made.update(sheen.fuzz(*soft))
    tint = here.colour("Specular Tint", WHITE)
    if tint != WHITE:
        made["specular_color"] = v.scene(v.clamp(tint))
    return made


def is_plain_rough_metal(here, roughness) -> bool:
    """True for metal whose facets reflect much to each other, and which has nothing that `conductor` lacks.

    `openpbr` has that light, too, in a wider lobe than Cycles, and of stretched metal a part of it.
    """
    if here.node.distribution != "MULTI_GGX" or v.bounds(roughness)[1] < 0.25:
        return False
    above = [k for k in ("Coat Weight", "Sheen Weight", "Thin Film Thickness") if here.number(k) != 0.0]
    if here.constant("Anisotropic"):
        here.tell("rough metal that is stretched loses a part of what its facets reflect to each other")
        return False
    return not above and v.bounds(v.middle(here.colour("Specular Tint", WHITE)))[0] >= LEAST_TINT


def joined(parts: list, share) -> dict:
    """A mix of two materials; one alone where the other has no share."""
    if v.is_constant(share) and share in (0.0, 1.0):
        return parts[int(share)]
    return {"material": "mix", "materials": parts, "amount": v.scene(share)}


@scatters("ShaderNodeBsdfPrincipled")
def principled(here) -> Surface:
    base, roughness = v.clamp(here.colour("Base Color", (0.8, 0.8, 0.8))), v.clamp(here.number("Roughness", 0.5))
    metallic, through = v.clamp(here.number("Metallic")), v.clamp(here.number("Transmission Weight"))
    shared = {"material": "openpbr", **anisotropy(here, roughness), **specular(here), **common(here)}
    opaque = {**shared, "base_color": v.scene(sheen.below(base, *sheen_of(here))), **subsurface(here, base)}
    rough = v.clamp(here.number("Diffuse Roughness"))
    if rough != 0.0:
        opaque["base_diffuse_roughness"] = v.scene(rough)
    # Light inside a surface that refracts in part meets the other part from behind, which a mix has and a weight has not.
    body = opaque if through == 0.0 else joined([opaque, {**shared, **glass(base)}], through)
    if metallic == 0.0:
        made = body
    elif is_plain_rough_metal(here, roughness):
        metal = {**conductor(base, v.clamp(here.colour("Specular Tint", WHITE)), roughness), **maps(here)}
        made = joined([body, metal], metallic)
    elif body is opaque:
        made = {**opaque, "base_metalness": v.scene(metallic)}
    else:
        made = joined([body, {**shared, "base_color": v.scene(base), "base_metalness": 1.0}], metallic)
    return Surface(made, emitted(here), v.clamp(here.number("Alpha", 1.0)))
