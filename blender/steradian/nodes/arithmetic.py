"""Nodes that compute: math, vectors, mixing, ranges, and parts of colours."""

from __future__ import annotations

import colorsys
import math

import numpy as np

from . import values as v
from .registry import evaluates

STEP = "min(1,max(0,floor(1+{a}-{b})))"


def _power(a, b):
    return 1.0 if b == 0 else a**b if a >= 0 or float(b).is_integer() else 0.0


def _wrap(x, high, low):
    return low if high == low else x - (high - low) * math.floor((x - low) / (high - low))


def _pingpong(a, b):
    return 0.0 if b == 0 else abs(((a - b) / (b * 2.0)) % 1.0 * b * 2.0 - b)


def _smooth_min(a, b, c):
    h = max(c - abs(a - b), 0.0) / c if c else 0.0
    return min(a, b) - h * h * h * c / 6.0


def _truncated_modulo(a, b):
    return math.fmod(a, b) if b else 0.0


# Function, and formula where one can be written.
ONE = {
    "SQRT": (lambda a: math.sqrt(a) if a > 0 else 0.0, "sqrt(max({a},0))"),
    "INVERSE_SQRT": (lambda a: 1 / math.sqrt(a) if a > 0 else 0.0, None),
    "ABSOLUTE": (abs, "abs({a})"),
    "EXPONENT": (math.exp, "exp({a})"),
    "SIGN": (lambda a: float((a > 0) - (a < 0)), None),
    "ROUND": (lambda a: math.floor(a + 0.5), "floor({a}+0.5)"),
    "FLOOR": (math.floor, "floor({a})"),
    "CEIL": (math.ceil, "(0-floor(0-{a}))"),
    "TRUNC": (math.trunc, None),
    "FRACT": (lambda a: a - math.floor(a), "({a}-floor({a}))"),
    "SINE": (math.sin, "sin({a})"),
    "COSINE": (math.cos, "cos({a})"),
    "TANGENT": (math.tan, "(sin({a})/cos({a}))"),
    "ARCSINE": (lambda a: math.asin(a) if abs(a) <= 1 else 0.0, None),
    "ARCCOSINE": (lambda a: math.acos(a) if abs(a) <= 1 else 0.0, None),
    "ARCTANGENT": (math.atan, None),
    "SINH": (math.sinh, None),
    "COSH": (math.cosh, None),
    "TANH": (math.tanh, None),
    "RADIANS": (math.radians, "({a}*0.017453292519943295)"),
    "DEGREES": (math.degrees, "({a}*57.29577951308232)"),
}
TWO = {
    "ADD": (lambda a, b: a + b, "({a}+{b})", "add"),
    "SUBTRACT": (lambda a, b: a - b, "({a}-{b})", "subtract"),
    "MULTIPLY": (lambda a, b: a * b, "({a}*{b})", "multiply"),
    "DIVIDE": (lambda a, b: a / b if b else 0.0, "({a}/{b})", None),
    "POWER": (_power, "(max({a},0)^{b})", None),
    "LOGARITHM": (lambda a, b: math.log(a) / math.log(b) if a > 0 and b > 0 and b != 1 else 0.0, None, None),
    "MINIMUM": (min, "min({a},{b})", None),
    "MAXIMUM": (max, "max({a},{b})", None),
    "LESS_THAN": (lambda a, b: float(a < b), f"(1-{STEP})", None),
    "GREATER_THAN": (lambda a, b: float(a > b), STEP, None),
    "MODULO": (_truncated_modulo, None, None),
    "FLOORED_MODULO": (lambda a, b: a - b * math.floor(a / b) if b else 0.0, "({a}-{b}*floor({a}/{b}))", None),
    "SNAP": (lambda a, b: math.floor(a / b) * b if b else 0.0, "(floor({a}/{b})*{b})", None),
    "PINGPONG": (_pingpong, None, None),
    "ARCTAN2": (math.atan2, None, None),
}
THREE = {
    "MULTIPLY_ADD": lambda a, b, c: a * b + c,
    "WRAP": _wrap,
    "COMPARE": lambda a, b, c: float(abs(a - b) <= max(c, 1e-5)),
    "SMOOTH_MIN": _smooth_min,
    "SMOOTH_MAX": lambda a, b, c: -_smooth_min(-a, -b, c),
}


def operation(here, name, a, b=0.0, c=0.0):
    """One operation of the node Math, of any values."""
    if name in ONE:
        return v.apply(ONE[name][0], a, ONE[name][1])
    if name in TWO:
        function, template, linear = TWO[name]
        if name == "DIVIDE" and v.is_constant(b) and v.width(b) == 1 and b:
            return v.multiply(a, 1.0 / b)
        return v.combine(function, a, b, template, linear, here.tell)
    if name == "MULTIPLY_ADD":
        return v.add(v.multiply(a, b), c)
    if name in THREE:
        if not v.is_constant(b) or not v.is_constant(c):
            here.tell(f"Math {name.lower()} with a texture as its second or third value, which counts by its middle")
        b, c = v.middle(b), v.middle(c)
        if v.width(b) == 1 and v.width(c) == 1:
            return v.apply(lambda x: THREE[name](x, b, c), a)
        parts = zip(v.components(a), v.components(b), v.components(c))
        return v.combine_colour(*(v.apply(lambda x, y=y, z=z: THREE[name](x, y, z), p) for p, y, z in parts))
    here.tell(f"the operation {name.lower()} is not known: its first value is taken")
    return a


@evaluates("ShaderNodeMath")
def math_node(here, out):
    node = here.node
    given = [here.number(key) for key in ("Value", "Value_001", "Value_002")]
    found = operation(here, node.operation, *given)
    return v.clamp(found) if node.use_clamp else found


def _dot(a, b):
    x, y, z = (v.multiply(p, q) for p, q in zip(v.components(a), v.components(b)))
    return v.add(v.add(x, y), z)


def _length(a):
    return v.apply(lambda x: math.sqrt(max(x, 0.0)), _dot(a, a), "sqrt(max({a},0))")


def _cross(a, b):
    (ax, ay, az), (bx, by, bz) = v.components(a), v.components(b)
    term = lambda p, q, r, s: v.subtract(v.multiply(p, q), v.multiply(r, s))
    return v.combine_colour(term(ay, bz, az, by), term(az, bx, ax, bz), term(ax, by, ay, bx))


@evaluates("ShaderNodeVectorMath")
def vector_math(here, out):
    name = here.node.operation
    a, b, c = (here.colour(key) for key in ("Vector", "Vector_001", "Vector_002"))
    if name == "DOT_PRODUCT":
        return _dot(a, b)
    if name == "LENGTH":
        return _length(a)
    if name == "DISTANCE":
        return _length(v.subtract(a, b))
    if name == "CROSS_PRODUCT":
        return _cross(a, b)
    if name == "SCALE":
        return _placed(here, a, b=here.number("Scale"), kind="MULTIPLY")
    if name == "NORMALIZE":
        length = _length(a)
        if v.is_constant(length) and length == 0:
            return a
        return v.combine(lambda x, y: x / y if y else 0.0, a, length, "({a}/{b})", None, here.tell)
    if name in ("REFLECT", "REFRACT", "PROJECT", "FACEFORWARD"):
        if not v.is_constant(a) or not v.is_constant(b):
            here.tell(f"the operation {name.lower()} of textures is not known: its first value is taken")
            return a
        return _directions(name, np.array(a), np.array(b), np.array(c), here.number("Scale"))
    name = {"FRACTION": "FRACT"}.get(name, name)
    if name in ("ADD", "SUBTRACT", "MULTIPLY", "DIVIDE"):
        return _placed(here, a, b, name)
    return operation(here, name, a, b, c)


def _directions(name, a, b, c, eta):
    square = float(b @ b)
    if name == "PROJECT":
        out = b * (a @ b / square) if square else a * 0
    elif name == "FACEFORWARD":
        out = a if c @ b < 0 else -a
    else:
        n = b / math.sqrt(square) if square else b
        cos = float(n @ a)
        if name == "REFLECT":
            out = a - 2.0 * cos * n
        else:
            k = 1.0 - eta * eta * (1.0 - cos * cos)
            out = a * 0 if k < 0 else eta * a - (eta * cos + math.sqrt(k)) * n
    return tuple(float(x) for x in out)


def _placed(here, a, b, kind):
    """An affine operation, which keeps what coordinates are of."""
    found = operation(here, kind, a, b)
    if isinstance(a, v.Field) and a.place and v.is_constant(b) and isinstance(found, v.Field):
        by = np.array(v.components(b), float)
        matrix = np.eye(4)
        if kind in ("ADD", "SUBTRACT"):
            matrix[:3, 3] = by if kind == "ADD" else -by
        else:
            safe = np.where(by == 0, np.inf, by)
            matrix[:3, :3] = np.diag(by if kind == "MULTIPLY" else 1 / safe)
        return v.Field(3, found.low, found.high, found.node, found.formulas, found.space, a.place.then(matrix))
    return found


def _soft_light(a, b):
    return (1 - a) * b * a + a * (1 - (1 - b) * (1 - a))


BLEND = {
    "MULTIPLY": TWO["MULTIPLY"],
    "ADD": TWO["ADD"],
    "SUBTRACT": TWO["SUBTRACT"],
    "DIVIDE": (lambda a, b: a / b if b else a, "({a}/{b})", None),
    "DARKEN": TWO["MINIMUM"],
    "LIGHTEN": TWO["MAXIMUM"],
    "SCREEN": (lambda a, b: 1 - (1 - a) * (1 - b), "(1-(1-{a})*(1-{b}))", None),
    "DIFFERENCE": (lambda a, b: abs(a - b), "abs({a}-{b})", None),
    "EXCLUSION": (lambda a, b: max(a + b - 2 * a * b, 0.0), "({a}+{b}-2*{a}*{b})", None),
    "OVERLAY": (lambda a, b: 2 * a * b if a < 0.5 else 1 - 2 * (1 - a) * (1 - b), None, None),
    "SOFT_LIGHT": (_soft_light, "((1-{a})*{b}*{a}+{a}*(1-(1-{b})*(1-{a})))", None),
    "LINEAR_LIGHT": (lambda a, b: a + 2 * b - 1, "({a}+2*{b}-1)", None),
}


def _dodge(a, b):
    return 0.0 if a == 0 else 1.0 if b >= 1 else min(a / (1 - b), 1.0)


def _burn(a, b):
    return 0.0 if b <= 0 else min(max(1 - (1 - a) / b, 0.0), 1.0)


def _of_hsv(mode, a, b, t):
    """Blend modes that exchange hue, saturation or value of constant colours."""
    ha, hb = colorsys.rgb_to_hsv(*a), colorsys.rgb_to_hsv(*b)
    if mode == "VALUE":
        return tuple(colorsys.hsv_to_rgb(ha[0], ha[1], ha[2] * (1 - t) + hb[2] * t))
    if mode == "SATURATION":
        return tuple(colorsys.hsv_to_rgb(ha[0], ha[1] * (1 - t) + hb[1] * t, ha[2])) if ha[1] else a
    if hb[1] == 0:
        return a
    other = colorsys.hsv_to_rgb(hb[0], ha[1] if mode == "HUE" else hb[1], ha[2])
    return tuple(x * (1 - t) + y * t for x, y in zip(a, other))


def blend(here, mode, a, b, t):
    """Blender's blend modes: all but two are a mix with what the mode makes of both."""
    if mode == "MIX":
        return v.mix(a, b, t)
    if mode in ("DODGE", "BURN"):
        if v.is_constant(t) and v.is_constant(b) and mode == "DODGE":
            return v.combine(_dodge, a, v.multiply(b, t), None, None, here.tell)
        if v.is_constant(t) and v.is_constant(b):
            return v.combine(_burn, a, v.add(1.0 - t, v.multiply(b, t)), None, None, here.tell)
        return v.mix(a, v.combine(_dodge if mode == "DODGE" else _burn, a, b, None, None, here.tell), t)
    if mode in ("HUE", "SATURATION", "COLOR", "VALUE"):
        if all(v.is_constant(x) for x in (a, b, t)):
            return _of_hsv(mode, a, b, t)
        here.tell(f"the blend mode {mode.lower()} of textures is not known: colours are mixed")
        return v.mix(a, b, t)
    if mode == "SCREEN" and not all(v.is_constant(x) or x.formulas for x in (a, b)):
        made = v.subtract(v.add(a, b), v.multiply(a, b))
    else:
        function, template, linear = BLEND[mode]
        made = v.combine(function, a, b, template, linear, here.tell)
    return v.mix(a, made, t)


@evaluates("ShaderNodeMix")
def mix_node(here, out):
    node = here.node
    kind = {"FLOAT": "Float", "VECTOR": "Vector", "RGBA": "Color", "ROTATION": "Rotation"}[node.data_type]
    is_vector_factor = kind == "Vector" and node.factor_mode == "NON_UNIFORM"
    t = here.colour("Factor_Vector") if is_vector_factor else here.number("Factor_Float")
    if node.clamp_factor:
        t = v.clamp(t)
    read = here.number if kind == "Float" else here.colour
    a, b = read(f"A_{kind}"), read(f"B_{kind}")
    found = blend(here, node.blend_type if kind == "Color" else "MIX", a, b, t)
    return v.clamp(found) if kind == "Color" and node.clamp_result else found


@evaluates("ShaderNodeMixRGB")
def mix_rgb(here, out):
    node = here.node
    found = blend(here, node.blend_type, here.colour("Color1"), here.colour("Color2"), v.clamp(here.number("Fac")))
    return v.clamp(found) if node.use_clamp else found


def _ranged(kind, steps):
    """The curve from [0, 1] to [0, 1] of an interpolation."""
    return {
        "LINEAR": (lambda x: x, "{a}"),
        "STEPPED": (lambda x: math.floor(x * (steps + 1)) / steps if steps else 0.0, None),
        "SMOOTHSTEP": (lambda x: x * x * (3 - 2 * x), "({a}*{a}*(3-2*{a}))"),
        "SMOOTHERSTEP": (lambda x: x**3 * (x * (x * 6 - 15) + 10), "({a}*{a}*{a}*({a}*({a}*6-15)+10))"),
    }[kind]


@evaluates("ShaderNodeMapRange")
def map_range(here, out):
    node = here.node
    is_vector = node.data_type == "FLOAT_VECTOR"
    end = "_FLOAT3" if is_vector else ""
    name = (lambda k: k.replace(" ", "_") + end) if is_vector else (lambda k: k)
    read = here.colour if is_vector else here.number
    given = read("Vector" if is_vector else "Value")
    low, high, to_low, to_high = (read(name(k)) for k in ("From Min", "From Max", "To Min", "To Max"))
    steps = here.constant("Steps") if node.interpolation_type == "STEPPED" and not is_vector else 4.0
    span = v.subtract(high, low)
    share = v.combine(lambda x, y: x / y if y else 0.0, v.subtract(given, low), span, "({a}/{b})", None, here.tell)
    if node.clamp or node.interpolation_type.startswith("SMOOTH"):
        share = v.clamp(share)
    share = v.apply(*_reordered(_ranged(node.interpolation_type, steps), share))
    return v.add(to_low, v.multiply(share, v.subtract(to_high, to_low)))


def _reordered(pair, value):
    return pair[0], value, pair[1]


@evaluates("ShaderNodeClamp")
def clamp_node(here, out):
    low, high = here.constant("Min"), here.constant("Max")
    if here.node.clamp_type == "RANGE" and low > high:
        low, high = high, low
    return v.clamp(here.number("Value"), low, high)


@evaluates("ShaderNodeSeparateXYZ")
def separate_xyz(here, out):
    return v.components(here.colour("Vector"))["XYZ".index(out)]


@evaluates("ShaderNodeCombineXYZ")
def combine_xyz(here, out):
    return v.combine_colour(*(here.number(k) for k in "XYZ"))


@evaluates("ShaderNodeSeparateColor", "ShaderNodeSeparateRGB", "ShaderNodeSeparateHSV")
def separate_colour(here, out):
    colour = here.colour("Color" if here.socket("Color") else "Image")
    i = next(k for k, s in enumerate(here.node.outputs) if s.identifier == out)
    mode = getattr(here.node, "mode", "HSV" if "HSV" in here.node.bl_idname else "RGB")
    if mode == "RGB":
        return v.components(colour)[i]
    if v.is_constant(colour):
        hsl = lambda *c: (lambda h, l, s: (h, s, l))(*colorsys.rgb_to_hls(*c))
        return (colorsys.rgb_to_hsv if mode == "HSV" else hsl)(*colour)[i]
    if mode == "HSV" and i == 2 and not colour.formulas:
        return v.Field(1, colour.low, colour.high, {"texture": "channel", "input": colour.texture(), "channel": "max"})
    here.tell(f"hue, saturation and lightness of a texture are not known: 0.5 is taken for {out.lower()}")
    return 0.5


@evaluates("ShaderNodeCombineColor", "ShaderNodeCombineRGB", "ShaderNodeCombineHSV")
def combine_colour_node(here, out):
    parts = [here.number(s.identifier) for s in here.node.inputs]
    mode = getattr(here.node, "mode", "HSV" if "HSV" in here.node.bl_idname else "RGB")
    if mode == "RGB":
        return v.combine_colour(*parts)
    if not all(v.is_constant(p) for p in parts):
        here.tell(f"{mode} of textures is not known: middles are taken")
    h, s, x = (v.middle(p) for p in parts)
    return tuple(colorsys.hsv_to_rgb(h, s, x) if mode == "HSV" else colorsys.hls_to_rgb(h, x, s))


@evaluates("ShaderNodeRGBToBW")
def to_grey(here, out):
    return v.as_number(here.colour("Color"))
