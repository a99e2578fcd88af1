"""The other surface shaders, and their mixes and sums."""

from __future__ import annotations

import math

from . import sheen, values as v
from .metal import conductor, constant_reflectance
from .normals import maps
from .principled import LEAST_TINT, mean_free_path, stretched
from .registry import scatters
from .surface import CLEAR, WHITE, Surface, added, mixed, stained

# Absorption of a unit of melanin in Cycles' hair (d'Eon et al. 2011).
EUMELANIN, PHEOMELANIN = (0.506, 0.841, 1.653), (0.343, 0.733, 1.924)


@scatters("ShaderNodeMixShader")
def mix_shader(here) -> Surface:
    reader = here.reader
    return mixed(here, reader.surface(here, "Shader"), reader.surface(here, "Shader_001"), here.number("Fac", 0.5))


@scatters("ShaderNodeAddShader")
def add_shader(here) -> Surface:
    return added(here, here.reader.surface(here, "Shader"), here.reader.surface(here, "Shader_001"))


def diffuse_like(colour, roughness=0.0) -> dict:
    """Diffuse reflection, rough or not."""
    if roughness == 0.0:
        return {"material": "diffuse", "reflectance": v.scene(v.clamp(colour))}
    return {"material": "oren_nayar", "reflectance": v.scene(v.clamp(colour)), "roughness": v.scene(v.clamp(roughness))}


@scatters("ShaderNodeBsdfDiffuse")
def diffuse(here) -> Surface:
    return Surface({**diffuse_like(here.colour("Color"), here.number("Roughness")), **maps(here)})


def facets(here, roughness_key="Roughness") -> dict:
    """α of a roughness and an anisotropy from −1 to 1, and the distribution."""
    square = lambda r: v.multiply(r, r)
    alpha = square(v.clamp(here.number(roughness_key)))
    amount = here.constant("Anisotropy") if here.socket("Anisotropy") else 0.0
    kind = here.node.distribution
    if kind == "ASHIKHMIN_SHIRLEY":
        here.tell("facets of Ashikhmin and Shirley are taken as GGX")
    made = {"distribution": "beckmann" if kind == "BECKMANN" else "ggx", "alpha_u": v.scene(alpha)}
    if amount:
        if here.is_linked("Tangent") or here.number("Rotation") != 0.0:
            here.tell("the highlight is stretched along the tangent of the UV map, without a turn")
        narrow = 1.0 - min(abs(amount), 0.99)
        along, across = (narrow, 1.0 / narrow) if amount > 0 else (1.0 / narrow, narrow)
        made["alpha_u"], made["alpha_v"] = v.scene(v.multiply(alpha, along)), v.scene(v.multiply(alpha, across))
    if kind == "MULTI_GGX" and here.node.bl_idname in ("ShaderNodeBsdfAnisotropic", "ShaderNodeBsdfMetallic"):
        made["compensation"] = "turquin"
    return made


@scatters("ShaderNodeBsdfAnisotropic", "ShaderNodeBsdfGlossy")
def glossy(here) -> Surface:
    colour, made = v.clamp(here.colour("Color")), facets(here)
    if "compensation" in made and "alpha_v" not in made:
        colour = constant_reflectance(colour, v.middle(v.clamp(here.number("Roughness"))))
    return Surface({"material": "conductor", "specular_reflectance": v.scene(colour), **made, **maps(here)})


@scatters("ShaderNodeBsdfMetallic")
def metallic(here) -> Surface:
    thickness = here.number("Thin Film Thickness")
    if here.node.fresnel_type == "PHYSICAL_CONDUCTOR":
        made = {
            "material": "conductor",
            "eta": v.scene(here.colour("IOR")),
            "k": v.scene(here.colour("Extinction")),
            **facets(here),
            **maps(here),
        }
        if thickness != 0.0:
            made["film_thickness"], made["film_eta"] = v.scene(thickness), v.scene(here.number("Thin Film IOR", 1.33))
        return Surface(made)
    roughness, amount = v.clamp(here.number("Roughness")), here.constant("Anisotropy")
    if here.node.distribution == "MULTI_GGX" and v.bounds(roughness)[1] >= 0.25 and thickness == 0.0 and not amount:
        base, edge = v.clamp(here.colour("Base Color")), v.clamp(here.colour("Edge Tint"))
        if v.bounds(v.middle(edge))[0] >= LEAST_TINT:
            return Surface({**conductor(base, edge, roughness), **maps(here)})
    made = {
        "material": "openpbr",
        "base_color": v.scene(v.clamp(here.colour("Base Color"))),
        "specular_color": v.scene(v.clamp(here.colour("Edge Tint"))),
        "base_metalness": 1.0,
        "specular_roughness": v.scene(roughness),
        **maps(here),
    }
    if amount:
        roughness, held = stretched(roughness, (1.0 - min(abs(amount), 0.99)) ** 2)
        turn = v.add(v.multiply(here.number("Rotation"), 360.0), 90.0 if amount > 0 else 0.0)
        made.update(specular_roughness=v.scene(roughness), specular_roughness_anisotropy=held,
                    anisotropy_rotation=v.scene(turn))
    if thickness != 0.0:
        made.update(thin_film_weight=1.0, thin_film_thickness=v.scene(thickness),
                    thin_film_ior=v.scene(here.number("Thin Film IOR", 1.33)))
    return Surface(made)


@scatters("ShaderNodeBsdfGlass")
def glass(here) -> Surface:
    colour = v.scene(v.clamp(here.colour("Color", WHITE)))
    if here.number("Thin Film Thickness") != 0.0:
        here.tell("the film on glass is not known: it is left out")
    made = {
        "material": "dielectric",
        "eta": max(here.constant("IOR", 1.5), 0.05),
        "specular_reflectance": colour,
        "specular_transmittance": colour,
        **facets(here),
        **maps(here),
    }
    return Surface(made)


@scatters("ShaderNodeBsdfRefraction")
def refraction(here) -> Surface:
    here.tell("refraction alone: what Fresnel's equations reflect is lost, where Cycles lets all of it pass")
    made = {
        "material": "dielectric",
        "eta": max(here.constant("IOR", 1.45), 0.05),
        "specular_reflectance": 0.0,
        "specular_transmittance": v.scene(v.clamp(here.colour("Color", WHITE))),
        **facets(here),
        **maps(here),
    }
    return Surface(made)


@scatters("ShaderNodeBsdfTranslucent")
def translucent(here) -> Surface:
    colour = v.scene(v.clamp(here.colour("Color")))
    return Surface({"material": "diffuse_transmission", "reflectance": 0.0, "transmittance": colour, **maps(here)})


@scatters("ShaderNodeBsdfTransparent")
def transparent(here) -> Surface:
    colour = v.clamp(here.colour("Color", WHITE))
    return CLEAR if colour == WHITE else Surface(stained(colour))


@scatters("ShaderNodeEmission", "ShaderNodeBackground")
def emission(here) -> Surface:
    return Surface(None, v.multiply(here.colour("Color", WHITE), here.number("Strength", 1.0)))


@scatters("ShaderNodeHoldout")
def holdout(here) -> Surface:
    here.tell("a holdout is not known: the surface is black, with an alpha of one")
    return Surface()


@scatters("ShaderNodeBsdfToon")
def toon(here) -> Surface:
    here.tell("the toon shader is taken as diffuse reflection")
    return Surface({**diffuse_like(here.colour("Color")), **maps(here)})


@scatters("ShaderNodeBsdfSheen", "ShaderNodeBsdfVelvet")
def sheen_alone(here) -> Surface:
    if getattr(here.node, "distribution", "MICROFIBER") == "ASHIKHMIN":
        here.tell("Ashikhmin's velvet is taken as Charlie sheen of the same roughness")
    soft = (1.0, here.colour("Color"), v.clamp(here.number("Roughness", 0.5)))
    made = {
        "material": "openpbr",
        "base_color": v.scene(sheen.below((0.0, 0.0, 0.0), *soft)),
        "specular_weight": 0.0,
        **sheen.fuzz(*soft),
        **maps(here),
    }
    return Surface(made)


@scatters("ShaderNodeSubsurfaceScattering")
def subsurface(here) -> Surface:
    colour, ior = v.clamp(here.colour("Color")), here.constant("IOR", 1.4)
    falloff = here.node.falloff
    factor = (0.25 / math.pi,) * 3
    if falloff == "RANDOM_WALK":
        factor = tuple(mean_free_path(min(c, 0.99), min(max(ior, 1.0001), 3.8)) for c in v.middle(colour))
    made = {
        "material": "openpbr",
        "specular_weight": 0.0,
        "subsurface_weight": 1.0,
        "subsurface_color": v.scene(colour),
        "subsurface_radius": v.scene(here.number("Scale", 0.05)),
        "subsurface_radius_scale": v.scene(v.multiply(here.colour("Radius", WHITE), factor)),
        "subsurface_scatter_anisotropy": here.constant("Anisotropy") if falloff != "BURLEY" else 0.0,
        **maps(here),
    }
    return Surface(made)


@scatters("ShaderNodeBsdfHair")
def hair(here) -> Surface:
    here.tell("the old hair shader is taken as a fibre of the same colour")
    made = {"material": "hair", "color": v.scene(v.clamp(here.colour("Color"))),
            "beta_m": v.scene(v.clamp(here.number("RoughnessU", 0.1))), "beta_n": v.scene(v.clamp(here.number("RoughnessV", 1.0)))}
    return Surface(made)


def absorption_of(colour, roughness):
    """Absorption of fibres whose mass has a colour (Chiang et al. 2016)."""
    x = roughness
    factor = ((((0.245 * x + 5.574) * x - 10.73) * x + 2.532) * x - 0.215) * x + 5.969
    return v.apply(lambda c: (math.log(max(c, 1e-5)) / factor) ** 2, colour)


@scatters("ShaderNodeBsdfHairPrincipled")
def principled_hair(here) -> Surface:
    node = here.node
    radial = v.clamp(here.number("Radial Roughness", 0.3))
    made = {
        "material": "hair",
        "eta": here.constant("IOR", 1.55),
        "beta_m": v.scene(v.clamp(here.number("Roughness", 0.3))),
        "beta_n": v.scene(radial),
        "alpha": math.degrees(here.constant("Offset")),
    }
    if node.model != "CHIANG":
        here.tell("Huang's model of hair is taken as Chiang's")
        made["beta_n"] = made["beta_m"]
    elif here.constant("Coat"):
        here.tell("the coat of hair is left out")
    if here.constant("Random Roughness") or (here.constant("Random Color") and node.parametrization == "MELANIN"):
        here.tell("random numbers for each hair are left out")
    if node.parametrization == "COLOR":
        made["color"] = v.scene(v.clamp(here.colour("Color")))
        return Surface(made)
    if node.parametrization == "ABSORPTION":
        made["sigma_a"] = v.scene(here.colour("Absorption Coefficient"))
        return Surface(made)
    amount, redness = here.number("Melanin"), here.number("Melanin Redness")
    amount = v.apply(lambda m: -math.log(max(1.0 - m, 1e-4)), amount)
    eumelanin, pheomelanin = v.multiply(amount, v.subtract(1.0, redness)), v.multiply(amount, redness)
    sigma = v.add(v.multiply(eumelanin, EUMELANIN), v.multiply(pheomelanin, PHEOMELANIN))
    tint = here.colour("Tint", WHITE)
    if tint != WHITE:
        sigma = v.add(sigma, absorption_of(tint, v.middle(radial)))
    made["sigma_a"] = v.scene(sigma)
    return Surface(made)
