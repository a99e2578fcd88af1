"""Nodes that change colours, and those that make them of one number."""

from __future__ import annotations

import colorsys
import math

import numpy as np

from . import values as v
from .registry import evaluates

# CIE 1931 by the fit of Wyman, Sloan, Shirley (JCGT 2013), and linear Rec.709 of XYZ.
RGB_OF_XYZ = np.array([
    [3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560], [0.0556434, -0.2040259, 1.0572252]
])


@evaluates("ShaderNodeRGB", "ShaderNodeValue")
def own_value(here, out):
    own = here.node.outputs[0].default_value
    return tuple(own)[:3] if hasattr(own, "__len__") else float(own)


@evaluates("ShaderNodeValToRGB")
def colour_ramp(here, out):
    ramp, share = here.node.color_ramp, here.number("Fac")
    part = slice(3, 4) if out == "Alpha" else slice(0, 3)
    if v.is_constant(share):
        found = tuple(ramp.evaluate(min(max(share, 0.0), 1.0)))[part]
        return found[0] if out == "Alpha" else found
    kinds = {"CONSTANT": "step", "LINEAR": "linear"}
    elements = list(ramp.elements)
    if ramp.color_mode == "RGB" and ramp.interpolation in kinds and elements[0].position < elements[-1].position:
        stops = [(e.position, tuple(e.color)) for e in elements]
        if ramp.interpolation == "CONSTANT":
            stops = [(min(0.0, stops[0][0]), stops[0][1]), *stops[1:]]
        stops = [s for s, following in zip(stops, [*stops[1:], (2.0, ())]) if following[0] > s[0]]
        interpolation = kinds[ramp.interpolation]
    else:
        stops = [(x, tuple(ramp.evaluate(float(x)))) for x in np.linspace(0, 1, v.CURVE)]
        interpolation = "linear"
    places = [float(s[0]) for s in stops]
    low = min(min(s[1][part]) for s in stops)
    high = max(max(s[1][part]) for s in stops)
    shown = {"input": v.scene(share), "places": v.floats(places), "interpolation": interpolation}
    if out == "Alpha":
        return v.Field(1, low, high, {"texture": "curve", "values": v.floats(s[1][3] for s in stops), **shown})
    return v.Field(3, low, high, {"texture": "ramp", "colors": v.floats(c for s in stops for c in s[1][:3]), **shown})


def _curve(mapping, i):
    mapping.initialize()
    return lambda x: mapping.evaluate(mapping.curves[i], x)


@evaluates("ShaderNodeRGBCurve")
def rgb_curves(here, out):
    mapping, colour = here.node.mapping, here.colour("Color")
    whole = _curve(mapping, 3)
    parts = [v.apply(lambda x, own=_curve(mapping, i): own(whole(x)), c) for i, c in enumerate(v.components(colour))]
    return v.mix(colour, v.combine_colour(*parts), here.number("Fac", 1.0))


@evaluates("ShaderNodeFloatCurve")
def float_curve(here, out):
    given = here.number("Value")
    return v.mix(given, v.apply(_curve(here.node.mapping, 0), given), here.number("Factor", 1.0))


@evaluates("ShaderNodeVectorCurve")
def vector_curves(here, out):
    given = here.colour("Vector")
    parts = [v.apply(_curve(here.node.mapping, i), c) for i, c in enumerate(v.components(given))]
    return v.mix(given, v.combine_colour(*parts), here.number("Fac", 1.0))


@evaluates("ShaderNodeHueSaturation")
def hue_saturation(here, out):
    hue, saturation, value = here.constant("Hue", 0.5), here.constant("Saturation", 1.0), here.constant("Value", 1.0)
    colour, share = here.colour("Color"), here.number("Fac", 1.0)
    if v.is_constant(colour):
        h, s, x = colorsys.rgb_to_hsv(*colour)
        turned = colorsys.hsv_to_rgb((h + hue + 0.5) % 1.0, min(max(s * saturation, 0.0), 1.0), x * value)
        changed = tuple(max(c, 0.0) for c in turned)
    elif hue == 0.5 and saturation == 1.0:
        changed = v.multiply(colour, value)
    else:
        made = {"texture": "hsv", "input": colour.texture(), "hue": 360.0 * (hue - 0.5), "saturation": saturation,
                "value": value}
        changed = v.Field(3, 0.0, colour.high * max(value, 0.0), made)
    return v.mix(colour, changed, share)


@evaluates("ShaderNodeInvert")
def invert(here, out):
    colour = here.colour("Color")
    return v.mix(colour, v.subtract(1.0, colour), here.number("Fac", 1.0))


@evaluates("ShaderNodeGamma")
def gamma(here, out):
    power = here.constant("Gamma", 1.0)
    return v.apply(lambda x: x**power if x > 0 else x, here.colour("Color"), None)


@evaluates("ShaderNodeBrightContrast")
def bright_contrast(here, out):
    bright, contrast = here.constant("Bright"), here.constant("Contrast")
    a, b = 1.0 + contrast, bright - contrast * 0.5
    return v.apply(lambda x: max(a * x + b, 0.0), here.colour("Color"), f"max({a!r}*{{a}}+({b!r}),0)")


def _lobe(nm, middle, below, above):
    t = (nm - middle) * (below if nm < middle else above)
    return math.exp(-0.5 * t * t)


def xyz(nm: float):
    """The colour matching functions at a wavelength in nm."""
    return np.array([
        1.056 * _lobe(nm, 599.8, 1 / 37.9, 1 / 31.0) + 0.362 * _lobe(nm, 442.0, 1 / 16.0, 1 / 26.7)
        - 0.065 * _lobe(nm, 501.1, 1 / 20.4, 1 / 26.2),
        0.821 * _lobe(nm, 568.8, 1 / 46.9, 1 / 40.5) + 0.286 * _lobe(nm, 530.9, 1 / 16.3, 1 / 31.1),
        1.217 * _lobe(nm, 437.0, 1 / 11.8, 1 / 36.0) + 0.681 * _lobe(nm, 459.0, 1 / 26.0, 1 / 13.8),
    ])


def blackbody(kelvin: float):
    """The colour of a black body, of luminance 1, as Cycles' node gives it: held at 800 K and 12000 K."""
    kelvin = min(max(kelvin, 800.0), 12000.0)
    wavelengths = np.arange(360, 831, 1.0)
    radiance = 1 / (wavelengths * 1e-9) ** 5 / np.expm1(0.01438777 / (wavelengths * 1e-9 * kelvin))
    total = sum(r * xyz(w) for r, w in zip(radiance, wavelengths))
    return tuple(float(c) for c in RGB_OF_XYZ @ (total / total[1]))


@evaluates("ShaderNodeBlackbody")
def blackbody_node(here, out):
    return tuple(max(c, 0.0) for c in blackbody(here.constant("Temperature", 1500.0)))


@evaluates("ShaderNodeWavelength")
def wavelength(here, out):
    rgb = RGB_OF_XYZ @ xyz(here.constant("Wavelength", 500.0)) / 2.52
    return tuple(max(float(c), 0.0) for c in rgb)


@evaluates("ShaderNodeObjectInfo")
def object_info(here, out):
    obj = here.reader.context_object()
    if obj is None:
        here.tell(f"'{out}' needs the object that is shaded: a middle is taken")
        return (0.5, 0.5, 0.5) if out in ("Location", "Color") else 0.5
    if out == "Location":
        return tuple(float(c) for c in obj.matrix_world.translation)
    if out == "Color":
        return tuple(obj.color)[:3]
    if out == "Alpha":
        return float(obj.color[3])
    if out == "Object Index":
        return float(obj.pass_index)
    if out == "Random":
        here.tell("'Random' is a number of the object's name, another than Cycles'")
        import zlib

        return (zlib.crc32(obj.name.encode()) & 0xFFFFFF) / float(0xFFFFFF)
    return 0.0


def _facing(here, what):
    here.tell(f"{what} changes with the direction of view, which textures do not know: its mean over directions is taken")


@evaluates("ShaderNodeFresnel")
def fresnel(here, out):
    _facing(here, "Fresnel")
    n = max(here.constant("IOR", 1.5), 1.0 + 1e-4)
    return mean_fresnel(n)


def reflectance(n: float, cos: float) -> float:
    """Reflectance of a dielectric of index `n` for light that is not polarised."""
    g = math.sqrt(max(n * n - 1 + cos * cos, 0.0))
    a, b = (g - cos) / (g + cos), (cos * (g + cos) - 1) / (cos * (g - cos) + 1)
    return 0.5 * a * a * (1 + b * b)


def mean_fresnel(n: float) -> float:
    """Mean of the reflectance over the hemisphere by the cosine."""
    return float(np.mean([reflectance(n, math.sqrt((i + 0.5) / 64)) for i in range(64)]))


@evaluates("ShaderNodeLayerWeight")
def layer_weight(here, out):
    _facing(here, "Layer Weight")
    blend = min(max(here.constant("Blend", 0.5), 0.0), 1 - 1e-5)
    if out == "Fresnel":
        return mean_fresnel(1.0 / max(1.0 - blend, 1e-5) if blend else 1.0001)
    power = 2 * blend if blend < 0.5 else 0.5 / (1 - blend)
    return float(np.mean([1 - math.sqrt((i + 0.5) / 64) ** power for i in range(64)]))


@evaluates("ShaderNodeLightPath")
def light_path(here, out):
    here.tell(f"'{out}' does not exist here: every ray counts as one from the camera")
    return 1.0 if out in ("Is Camera Ray", "Ray Length") else 0.0


@evaluates("ShaderNodeAmbientOcclusion")
def ambient_occlusion(here, out):
    here.tell("ambient occlusion is not known: 1 is taken")
    return here.colour("Color") if out == "Color" else 1.0
