"""Texture nodes: pictures, and patterns as ours or as formulas."""

from __future__ import annotations

import math

from . import values as v
from .coordinates import flat_parameters, on_uv, solid_parameters, vector
from .registry import evaluates

LINEAR_SPACES = ("Linear Rec.709", "Linear", "scene_linear", "Linear Rec.709 (sRGB)")
WRAPS = {"REPEAT": "repeat", "EXTEND": "clamp", "CLIP": "black", "MIRROR": "mirror"}


def encoding(here, image) -> dict:
    """How the stored values of an image are read."""
    space = image.colorspace_settings.name
    if space in ("Non-Color", "Raw", "Generic Data"):
        return {"raw": True}
    if space in LINEAR_SPACES:
        return {"encoding": "linear"}
    if space != "sRGB":
        here.tell(f"the colour space '{space}' is not known: sRGB is taken")
    return {"encoding": "srgb"} if image.file_format not in ("OPEN_EXR", "OPEN_EXR_MULTILAYER", "HDR") else {}


def picture(here, image) -> dict:
    """A picture's file, by the context."""
    path = here.reader.context.image(image)
    return {"file": {"file": str(path)}} if path is not None else {}


@evaluates("ShaderNodeTexImage")
def image_texture(here, out):
    node, image = here.node, here.node.image
    if image is None:
        here.tell("there is no image: pink is taken, as by Cycles")
        return 1.0 if out == "Alpha" else (1.0, 0.0, 1.0)
    file = picture(here, image)
    if not file:
        here.tell(f"the image '{image.name}' cannot be read: pink is taken, as by Cycles")
        return 1.0 if out == "Alpha" else (1.0, 0.0, 1.0)
    if image.source in ("SEQUENCE", "MOVIE", "TILED"):
        here.tell(f"an image of source {image.source.lower()}: one picture of it is taken")
    filters = {"Closest": "nearest", "Linear": "bilinear", "Cubic": "bspline", "Smart": "bspline"}
    made = {
        "texture": "image",
        **file,
        **encoding(here, image),
        "filter": filters.get(node.interpolation, "bilinear"),
        "wrap_u": WRAPS[node.extension],
        "wrap_v": WRAPS[node.extension],
    }
    if out == "Alpha":
        made["channel"] = "a"
    high = 1.0 if not image.is_float else 16.0
    if node.projection == "FLAT":
        made.update(flat_parameters(here))
    elif node.projection == "BOX":
        here.tell(f"projection box blends by powers of the normal, not by a blend of {node.projection_blend:.2g}")
        own = solid_parameters(here)["texture_from_world"] if not on_uv(here) else {"scale": 1.0}
        planes = {"x": ([0, 1, 0], [0, 0, 1]), "y": ([1, 0, 0], [0, 0, 1]), "z": ([1, 0, 0], [0, 1, 0])}
        sides = {
            axis: {**made, "mapping": "planar", "v1": v1, "v2": v2, "texture_from_world": own}
            for axis, (v1, v2) in planes.items()
        }
        made = {"texture": "triplanar", **sides, "texture_from_world": own}
    else:
        here.tell(f"projection {node.projection.lower()}: about z of the coordinates, which may begin elsewhere")
        own = flat_parameters(here, "generated")
        made.update(own, mapping={"SPHERE": "spherical", "TUBE": "cylindrical"}[node.projection])
    return v.Field(1 if out == "Alpha" else 3, 0.0, high, made)


def _varied(here, key, default):
    """A parameter of a pattern, one for the whole surface."""
    return here.constant(key, default)


def _between(here, a, b, share):
    return v.mix(here.colour(a), here.colour(b), share)


@evaluates("ShaderNodeTexChecker")
def checker(here, out):
    scale = here.number("Scale", 5.0)
    point = v.components(v.multiply(vector(here), scale))
    # Blender moves the point off the borders of cells by parts of a millionth.
    cells = [v.apply(math.floor, v.multiply(v.add(p, 0.000001), 0.999999), "floor({a})") for p in point]
    total = v.add(v.add(cells[0], cells[1]), cells[2])
    odd = v.apply(lambda x: x % 2.0, total, "({a}-2*floor({a}/2))")
    return odd if out == "Fac" else _between(here, "Color2", "Color1", odd)


@evaluates("ShaderNodeTexGradient")
def gradient(here, out):
    x, y, z = v.components(vector(here))
    kind = here.node.gradient_type
    length = lambda *parts: v.apply(
        lambda s: math.sqrt(max(s, 0)), _sum(*(v.multiply(p, p) for p in parts)), "sqrt(max({a},0))")
    if kind == "LINEAR":
        share = x
    elif kind == "QUADRATIC":
        held = v.apply(lambda a: max(a, 0.0), x, "max({a},0)")
        share = v.multiply(held, held)
    elif kind == "EASING":
        held = v.clamp(x)
        share = v.multiply(v.multiply(held, held), v.subtract(3.0, v.multiply(held, 2.0)))
    elif kind == "DIAGONAL":
        share = v.multiply(v.add(x, y), 0.5)
    elif kind == "RADIAL":
        # Ours begins at +x and Blender's at -x.
        share = v.Field(node={"texture": "gradient", "type": "angular", **_scaled_flat(here, -1.0, (0.5, 0.5))})
    else:
        held = v.apply(lambda a: max(0.999999 - a, 0.0), length(x, y, z), "max(0.999999-{a},0)")
        share = v.multiply(held, held) if kind == "QUADRATIC_SPHERE" else held
    share = v.clamp(share)
    return share if out == "Fac" else v.as_colour(share)


def _sum(*parts):
    total = parts[0]
    for part in parts[1:]:
        total = v.add(total, part)
    return total


@evaluates("ShaderNodeTexWave")
def wave(here, out):
    node = here.node
    scale, distortion = here.number("Scale", 5.0), here.number("Distortion")
    if distortion != 0.0:
        here.tell("the distortion of waves is not known: they are straight")
    x, y, z = v.components(v.multiply(vector(here), scale))
    if node.wave_type == "BANDS":
        along = {"X": lambda: v.multiply(x, 20.0), "Y": lambda: v.multiply(y, 20.0), "Z": lambda: v.multiply(z, 20.0),
                 "DIAGONAL": lambda: v.multiply(_sum(x, y, z), 10.0)}[node.bands_direction]()
    else:
        parts = {"X": (y, z), "Y": (x, z), "Z": (x, y), "SPHERICAL": (x, y, z)}[node.rings_direction]
        squares = _sum(*(v.multiply(p, p) for p in parts))
        along = v.multiply(v.apply(lambda s: math.sqrt(max(s, 0)), squares, "sqrt(max({a},0))"), 20.0)
    along = v.add(along, here.number("Phase Offset"))
    if node.wave_profile == "SIN":
        share = v.apply(lambda a: 0.5 + 0.5 * math.sin(a - math.pi / 2), along, "(0.5+0.5*sin({a}-pi/2))")
    elif node.wave_profile == "SAW":
        turns = v.multiply(along, 1 / math.tau)
        share = v.apply(lambda a: a - math.floor(a), turns, "({a}-floor({a}))")
    else:
        turns = v.multiply(along, 1 / math.tau)
        share = v.apply(lambda a: abs(a - math.floor(a + 0.5)) * 2.0, turns, "(abs({a}-floor({a}+0.5))*2)")
    if isinstance(share, v.Field):
        share = v.Field(1, 0.0, 1.0, share.node, share.formulas, share.space)
    return share if out == "Fac" else v.as_colour(share)


@evaluates("ShaderNodeTexMagic")
def magic(here, out):
    scale, distortion = here.constant("Scale", 5.0), here.constant("Distortion", 1.0)
    p = v.components(v.multiply(vector(here), scale))
    wrapped = [v.apply(lambda a: a % math.tau, c, "({a}-6.283185307179586*floor({a}/6.283185307179586))") for c in p]
    px, py, pz = wrapped
    sin = lambda a: v.apply(math.sin, a, "sin({a})")
    cos = lambda a: v.apply(math.cos, a, "cos({a})")
    negative = lambda a: v.subtract(0.0, a)
    less = lambda a, *rest: less(v.subtract(a, rest[0]), *rest[1:]) if rest else a
    x = sin(v.multiply(_sum(px, py, pz), 5.0))
    y = cos(v.multiply(less(py, px, pz), 5.0))
    z = negative(cos(v.multiply(v.add(less(0.0, px, py), pz), 5.0)))
    depth = here.node.turbulence_depth
    if depth > 3:
        here.tell(f"turbulence of depth {depth}: the first three steps are taken")
    if depth > 0:
        x, y, z = (v.multiply(c, distortion) for c in (x, y, z))
        y = v.multiply(negative(cos(v.add(less(x, y), z))), distortion)
    if depth > 1:
        x = v.multiply(cos(less(x, y, z)), distortion)
    if depth > 2:
        z = v.multiply(sin(less(0.0, x, y, z)), distortion)
    if distortion:
        x, y, z = (v.multiply(c, 0.5 / distortion) if depth else v.multiply(c, 0.5) for c in (x, y, z))
    found = v.combine_colour(*(v.subtract(0.5, c) for c in (x, y, z)))
    return v.multiply(_sum(*v.components(found)), 1 / 3) if out == "Fac" else found


def _like(here, what):
    here.tell(f"{what}: the pattern has the same scale and spread, but other random numbers than Blender's")


@evaluates("ShaderNodeTexNoise")
def noise(here, out):
    node = here.node
    scale, detail = here.constant("Scale", 5.0), min(max(here.constant("Detail", 2.0), 0.0), 15.0)
    roughness, lacunarity = here.constant("Roughness", 0.5), here.constant("Lacunarity", 2.0)
    if here.constant("Distortion"):
        here.tell("the distortion of noise is not known: it is left out")
    if node.noise_type != "FBM":
        here.tell(f"noise of type {node.noise_type.lower()} is taken as fBM")
    if node.noise_dimensions in ("1D", "4D"):
        here.tell(f"noise of {node.noise_dimensions}: that of the coordinates alone is taken")
    _like(here, "noise")
    octaves = int(detail) + 1
    most = sum(roughness**i for i in range(octaves))
    if detail != int(detail):
        here.tell(f"a detail of {detail:.3g} counts as {int(detail)}: octaves are whole")
    gain = 0.5 / most if node.normalize else 1.0
    made = {
        "texture": "fbm",
        "octaves": octaves,
        "roughness": roughness,
        "lacunarity": lacunarity,
        "gain": gain,
        "offset": 0.5 if node.normalize else 0.0,
        **solid_parameters(here, scale),
    }
    low, high = (0.0, 1.0) if node.normalize else (-most, most)
    if out == "Color":
        parts = [v.Field(1, low, high, {**made, "seed": i}) for i in range(3)]
        return v.combine_colour(*parts)
    return v.Field(1, low, high, made)


@evaluates("ShaderNodeTexVoronoi")
def voronoi(here, out):
    node = here.node
    scale, jitter = here.constant("Scale", 5.0), here.constant("Randomness", 1.0)
    place = {"jitter": min(max(jitter, 0.0), 1.0), **solid_parameters(here, scale)}
    metric = node.distance.lower()
    if metric == "minkowski":
        here.tell("Minkowski's distance is taken as Euclid's")
        metric = "euclidean"
    place["metric"] = metric
    _like(here, "Voronoi cells")
    if here.constant("Detail"):
        here.tell("the detail of Voronoi cells is not known: one layer is taken")
    if out == "Color":
        return v.combine_colour(*(v.Field(1, 0, 1, {"texture": "voronoi", "seed": i, **place}) for i in range(3)))
    if out != "Distance":
        here.tell(f"the output '{out}' is not known: 0.5 is taken")
        return 0.5
    feature = {"F1": "f1", "F2": "f2", "DISTANCE_TO_EDGE": "border", "SMOOTH_F1": "f1"}.get(node.feature)
    if feature is None:
        here.tell("the radius of spheres in cells is not known: 0.5 is taken")
        return 0.5
    if node.feature == "SMOOTH_F1":
        here.tell("smooth F1 is taken as F1")
    made = {"texture": "worley", "feature": feature, **place}
    if node.feature == "DISTANCE_TO_EDGE":
        # Half the difference of both distances, and what it lacks at most angles in the mean.
        made["gain"] = 0.645
    elif here.node.voronoi_dimensions == "3D" and place["dimension"] == 2:
        here.tell("a slice through cells in space is a flat pattern of the same mean")
        made["gain"] = 1.22 if feature == "f1" else 1.0
    return v.Field(1, 0.0, 1.5, made)


@evaluates("ShaderNodeTexWhiteNoise")
def white_noise(here, out):
    here.tell("white noise is not known: its mean is taken")
    return (0.5, 0.5, 0.5) if out == "Color" else 0.5


@evaluates("ShaderNodeTexBrick")
def brick(here, out):
    node = here.node
    scale = here.constant("Scale", 5.0)
    width, height = here.constant("Brick Width", 0.5), here.constant("Row Height", 0.25)
    mortar, bias = here.constant("Mortar Size", 0.02), here.constant("Bias")
    if here.constant("Mortar Smooth"):
        here.tell("the edges of mortar are sharp, at half of their smooth width")
        mortar *= 1.0 - 0.5 * here.constant("Mortar Smooth")
    if node.squash != 1.0 or node.offset_frequency != 2 or node.offset not in (0.0, 0.5):
        here.tell("each row is shifted by as much against the one below, and none is squashed")
    _like(here, "shades of bricks")
    place = _scaled_flat(here, scale, (width * node.offset, 0.0))
    sizes = {"width": width, "height": height, "shift": node.offset, **place}
    bricks = v.Field(1, 0.0, 1.0, {"texture": "bricks", "mortar": 2.0 * mortar, **sizes})
    if out == "Fac":
        return v.subtract(1.0, bricks)
    shade = v.Field(1, 0.0, 1.0, {"texture": "brick_shade", "mortar": 2.0 * mortar, **sizes})
    shade = v.clamp(v.add(shade, bias))
    return v.mix(here.colour("Mortar"), v.mix(here.colour("Color1"), here.colour("Color2"), shade), bricks)


def _scaled_flat(here, scale, offset=(0.0, 0.0)):
    """A mapping over two coordinates, times a scale, plus an offset."""
    import numpy as np

    place = flat_parameters(here, "generated")
    by = np.diag([scale, scale, scale, 1.0])
    by[0, 3], by[1, 3] = offset
    key = "texture_from_world" if place.get("mapping") == "planar" else "to_uv"
    own = np.array(place[key]["matrix"]).reshape(4, 4) if key in place else np.eye(4)
    return {**place, key: {"matrix": [float(x) for x in (by @ own).ravel()]}}


def _active_colour(thing) -> str:
    """Name of the colours that an object's mesh is rendered with."""
    found = getattr(getattr(thing, "data", None), "color_attributes", None)
    return found[found.render_color_index].name if found and 0 <= found.render_color_index < len(found) else ""


@evaluates("ShaderNodeAttribute", "ShaderNodeVertexColor")
def attribute(here, out):
    node = here.node
    is_colour = node.bl_idname == "ShaderNodeVertexColor"
    name = node.layer_name if is_colour else node.attribute_name
    if not is_colour and node.attribute_type != "GEOMETRY":
        here.tell(f"attributes of the {node.attribute_type.lower()} are not known: 0 is taken, as where there is none")
        return 0.0 if out in ("Fac", "Alpha") else (0.0, 0.0, 0.0)
    if out == "Alpha":
        here.tell("the alpha of attributes is not known: 1 is taken")
        return 1.0
    name = name or _active_colour(here.reader.context_object())
    if not name:
        here.tell("no attribute is named: white is taken")
        return (1.0, 1.0, 1.0)
    here.reader.context.attributes.add(name)
    found = v.Field(3, 0.0, 1.0, {"texture": "mesh_attribute", "name": name})
    return v.as_number(found, False) if out == "Fac" else found


@evaluates("ShaderNodeTexSky", "ShaderNodeTexEnvironment")
def surroundings(here, out):
    here.tell("a sky or environment counts in worlds alone: grey is taken")
    return (0.5, 0.5, 0.5)
