"""Volume shaders as homogeneous media; what varies inside is told."""

from __future__ import annotations

import math

from . import values as v
from .registry import fills

BLACK = (0.0, 0.0, 0.0)


def medium(scattering=BLACK, absorption=BLACK, emission=BLACK, g=0.0) -> dict:
    """Coefficients of a medium, as a dictionary that sums can add to."""
    return {"scattering": scattering, "absorption": absorption, "emission": emission, "g": g}


def _colour(here, key, default=BLACK):
    found = here.colour(key, default)
    if not v.is_constant(found):
        here.tell(f"'{key}' varies inside, which homogeneous media do not: its middle is taken")
    return tuple(max(c, 0.0) for c in v.middle(found))


def _times(colour, factor):
    return tuple(c * factor for c in colour)


def _phase(here) -> float:
    kind = getattr(here.node, "phase", "HENYEY_GREENSTEIN")
    if kind != "HENYEY_GREENSTEIN":
        here.tell(f"the phase function {kind.lower()} is taken as Henyey and Greenstein's")
    return min(max(here.constant("Anisotropy"), -0.99), 0.99)


@fills("ShaderNodeVolumeScatter")
def scatter(here):
    return medium(_times(_colour(here, "Color"), max(here.constant("Density", 1.0), 0.0)), g=_phase(here))


@fills("ShaderNodeVolumeAbsorption")
def absorption(here):
    dark = tuple(max(1.0 - c, 0.0) for c in _colour(here, "Color"))
    return medium(absorption=_times(dark, max(here.constant("Density", 1.0), 0.0)))


@fills("ShaderNodeVolumeCoefficients")
def coefficients(here):
    names = ("Scatter Coefficients", "Absorption Coefficients", "Emission Coefficients")
    return medium(*(_colour(here, name) for name in names), _phase(here))


@fills("ShaderNodeEmission")
def emission(here):
    return medium(emission=_times(_colour(here, "Color"), here.constant("Strength", 1.0)))


@fills("ShaderNodeVolumePrincipled")
def principled(here):
    density, colour = max(here.constant("Density", 1.0), 0.0), _colour(here, "Color")
    dark = tuple(math.sqrt(c) for c in _colour(here, "Absorption Color"))
    absorbed = tuple(max(1.0 - c, 0.0) * max(1.0 - d, 0.0) * density for c, d in zip(colour, dark))
    glow = _times(_colour(here, "Emission Color"), here.constant("Emission Strength"))
    if here.constant("Blackbody Intensity"):
        from .colours import blackbody

        kelvin = here.constant("Temperature", 1000.0)
        power = 5.670373e-8 * kelvin**4 / math.pi * 1e-6 * here.constant("Blackbody Intensity")
        tint = _colour(here, "Blackbody Tint")
        glow = tuple(e + max(b, 0.0) * t * power for e, b, t in zip(glow, blackbody(kelvin), tint))
        here.tell("the black body's brightness is by Stefan and Boltzmann's law, without Cycles' blend towards 1")
    return medium(_times(colour, density), absorbed, glow, _phase(here))


@fills("ShaderNodeAddShader")
def add(here):
    return _sum(here.reader.volume(here, "Shader"), here.reader.volume(here, "Shader_001"))


@fills("ShaderNodeMixShader")
def mix(here):
    share = min(max(here.constant("Fac", 0.5), 0.0), 1.0)
    parts = (here.reader.volume(here, "Shader"), here.reader.volume(here, "Shader_001"))
    return _sum(*(_scaled(p, k) for p, k in zip(parts, (1.0 - share, share))))


def _scaled(part, factor):
    if part is None:
        return None
    return {**part, **{k: _times(part[k], factor) for k in ("scattering", "absorption", "emission")}}


def _sum(a, b):
    if a is None or b is None:
        return a or b
    plus = lambda k: tuple(x + y for x, y in zip(a[k], b[k]))
    weights = sum(a["scattering"]), sum(b["scattering"])
    total = sum(weights)
    g = (weights[0] * a["g"] + weights[1] * b["g"]) / total if total else 0.0
    return medium(plus("scattering"), plus("absorption"), plus("emission"), g)


def entry(found: dict) -> dict:
    """A medium of the scene language. Its emission is times absorption there, and for each length in Blender."""
    made = {"medium": "homogeneous", "sigma_s": list(found["scattering"]), "sigma_a": list(found["absorption"])}
    if found["g"]:
        made["g"] = found["g"]
    if any(found["emission"]):
        absorbed = [max(a, 1e-6) for a in found["absorption"]]
        made["sigma_a"] = absorbed
        made["Le"] = [e / a for e, a in zip(found["emission"], absorbed)]
    return made
