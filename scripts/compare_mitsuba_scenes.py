#!/usr/bin/env python3
"""Pictures of scenes with one feature each against Mitsuba 3's.

    python3 -m venv venv && venv/bin/pip install mitsuba==3.9.1 numpy scipy     # and LLVM's shared library: apt install libllvm15
    venv/bin/python scripts/compare_mitsuba_scenes.py path/to/steradian [--only NAME] [--spp 64] [--seeds 8] [--markdown]

It is no part of the gate. Each scene is a Mitsuba file that both programs read, a ball or a wall in plain light with one feature; where the colour mode matters it is rendered
in both. Both programs render it with several seeds (Mitsuba in its variants `llvm_ad_rgb` and `llvm_ad_spectral`, Steradian with `reuse=1`, so that pixels are independent),
and means over blocks of 8 × 8 pixels are compared channel by channel: Welch's t of the two means with variances from the seeds, the smallest of all blocks' probabilities
corrected by Šidák. A scene *differs* where that, or that of the whole picture's means, is below 0.01, again corrected for the number of scenes.

Printed are the difference of the picture's mean (ours − theirs, in % of theirs) with its standard error, the largest difference of a block beyond three standard errors in % of the
block (blocks below a tenth of the mean count as a tenth), and what Steradian says when it reads the file. A difference with a known reason, or one that the program's output
names, is no fault; the exit status is 1 where others are left. docs/mitsuba-comparison.md has one run (`--markdown`).
"""

import argparse
import math
import re
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

import numpy as np
from scipy import stats

SIZE, BLOCK = 64, 8

# ---------------------------------------------------------------------------------------------------------------- scenes

LOOK = '<lookat origin="0.6,-4,1.6" target="0,0,0" up="0,0,1"/>'
FILTER = '<rfilter type="box"/>'


def camera(more="", kind="perspective", look=LOOK, film="", rfilter=FILTER):
    view = "" if kind == "orthographic" else '<float name="fov" value="35"/>'
    return (f'<sensor type="{kind}">{view}{more}<transform name="to_world">{look}</transform>'
            f'<film type="hdrfilm"><integer name="width" value="{SIZE}"/><integer name="height" value="{SIZE}"/>{rfilter}{film}</film></sensor>')


LAMP = ('<shape type="rectangle"><transform name="to_world"><scale value="0.8"/><lookat origin="-2,-2,3" target="0,0,0" up="0,1,0"/></transform>'
        '<emitter type="area"><rgb name="radiance" value="14,12,9"/></emitter></shape>')
SKY = '<emitter type="constant"><rgb name="radiance" value="0.25,0.35,0.5"/></emitter>'
LIGHT = LAMP + SKY
POINT = '<emitter type="point"><point name="position" x="-2" y="-2" z="3"/><rgb name="intensity" value="30,25,20"/></emitter>'
FLOOR = ('<shape type="rectangle"><transform name="to_world"><scale value="5"/><translate z="-1"/></transform>'
         '<bsdf type="diffuse"><rgb name="reflectance" value="0.5,0.4,0.3"/></bsdf></shape>')
GREY = '<bsdf type="diffuse"/>'


def scene(things, light=LIGHT, view=None, depth=5, integrator=None):
    how = integrator or f'<integrator type="path"><integer name="max_depth" value="{depth}"/></integrator>'
    return f'<scene version="3.0.0">{how}{view or camera()}{light}{things}</scene>'


def ball(bsdf, **rest):
    """A ball of a material."""
    return scene(f'<shape type="sphere">{bsdf}</shape>', **rest)


def wall(bsdf, more="", **rest):
    """A tilted square of a material, with texture coordinates."""
    tilt = '<transform name="to_world"><scale value="1.3"/><rotate x="1" angle="60"/><rotate z="1" angle="15"/></transform>'
    return scene(f'<shape type="rectangle">{tilt}{bsdf}</shape>{more}', **rest)


def shape(kind, inside="", more="", **rest):
    return scene(f'<shape type="{kind}">{inside}{GREY}</shape>{FLOOR}{more}', **rest)


def size(s):
    return f'<scale value="{s}"/>'


def turn(axis, angle):
    return f'<rotate {axis}="1" angle="{angle}"/>'


def move(x=0, y=0, z=0):
    return f'<translate x="{x}" y="{y}" z="{z}"/>'


def look(origin, up="0,0,1"):
    return f'<lookat origin="{origin}" target="0,0,0" up="{up}"/>'


def put(operations):
    return f'<transform name="to_world">{operations}</transform>'


def bsdf(kind, inside=""):
    return f'<bsdf type="{kind}">{inside}</bsdf>'


def floats(**values):
    return "".join(f'<float name="{n}" value="{v}"/>' for n, v in values.items())


def bitmap(name, file, more=""):
    return f'<texture type="bitmap" name="{name}"><string name="filename" value="{file}"/>{more}</texture>'


def textured(texture):
    return bsdf("diffuse", texture)


def word(name, value):
    return f'<string name="{name}" value="{value}"/>'


def rgb(name, value):
    return f'<rgb name="{name}" value="{value}"/>'


BASE = rgb("base_color", "0.7,0.3,0.1")
RAW = '<boolean name="raw" value="true"/>'
GOLD = rgb("eta", "0.16,0.42,1.45") + rgb("k", "3.9,2.45,1.77")


def principled(**values):
    return bsdf("principled", BASE + floats(**values))


def detail(kind, file, inner=GREY, scale=None):
    size = "" if scale is None else floats(scale=scale)
    return bsdf(kind, bitmap("map" if kind == "bumpmap" else "normalmap", file, RAW) + size + inner)


def medium(inside, phase="", kind="homogeneous", skin='<bsdf type="null"/>', **rest):
    how = '<integrator type="volpath"><integer name="max_depth" value="12"/></integrator>'
    return scene(f'<shape type="cube">{put(size(0.8))}{skin}<medium type="{kind}" name="interior">{inside}{phase}</medium></shape>'
                 + FLOOR, integrator=how, **rest)


def sun(direction="0.5,0.5,-1"):
    return f'<emitter type="directional"><vector name="direction" value="{direction}"/>{rgb("irradiance", "3,2.5,2")}</emitter>'


def envmap(file, operations="", more=""):
    return f'<emitter type="envmap">{word("filename", file)}{put(operations)}{more}</emitter>'


UP = '<rotate x="1" angle="90"/>'
BOTH, RGB, SPECTRAL = ("rgb", "spectral"), ("rgb",), ("spectral",)

WHITE = ("spectra in absolute units: Mitsuba divides luminances by 106.750, while the integral of ȳ is 106.857 (0.1 %); between texels it interpolates spectra, "
         "Steradian colours")
ERF = "Mitsuba's masking of Beckmann is a rational fit, within 0.35 % for one direction"

# Name: (scene, colour modes, reason of a known difference).
SCENES = {
    # Materials
    "diffuse": (ball(bsdf("diffuse", rgb("reflectance", "0.2,0.5,0.8"))), BOTH, ""),
    "conductor mirror": (ball(bsdf("conductor"), depth=3), RGB, ""),
    "conductor Cu": (ball(bsdf("conductor", word("material", "Cu"))), BOTH, ""),
    "conductor Al": (ball(bsdf("conductor", word("material", "Al"))), BOTH, ""),
    "conductor Au": (ball(bsdf("conductor", word("material", "Au"))), BOTH, ""),
    "conductor TiN": (ball(bsdf("conductor", word("material", "TiN"))), BOTH, ""),
    "conductor eta k": (ball(bsdf("conductor", GOLD)), BOTH, ""),
    "roughconductor ggx": (ball(bsdf("roughconductor", GOLD + word("distribution", "ggx") + floats(alpha=0.3))), RGB, ""),
    "roughconductor beckmann": (ball(bsdf("roughconductor", GOLD + floats(alpha=0.2))), RGB, ERF),
    "roughconductor stretched": (ball(bsdf("roughconductor", GOLD + word("distribution", "ggx") + floats(alpha_u=0.1, alpha_v=0.4))), RGB, ""),
    "roughconductor Cr": (ball(bsdf("roughconductor", word("material", "Cr") + word("distribution", "ggx"))), BOTH, ""),
    "dielectric": (ball(bsdf("dielectric"), depth=8), BOTH, ""),
    "dielectric named": (ball(bsdf("dielectric", word("int_ior", "diamond") + word("ext_ior", "water")), depth=8), RGB, ""),
    "thindielectric": (ball(bsdf("thindielectric"), depth=8), RGB, ""),
    "roughdielectric": (ball(bsdf("roughdielectric", word("distribution", "ggx") + floats(alpha=0.2)), depth=8), RGB, ""),
    "plastic": (ball(bsdf("plastic", rgb("diffuse_reflectance", "0.2,0.5,0.8"))), BOTH, ""),
    "plastic nonlinear": (ball(bsdf("plastic", rgb("diffuse_reflectance", "0.2,0.5,0.8") + '<boolean name="nonlinear" value="true"/>')), RGB, ""),
    "roughplastic": (ball(bsdf("roughplastic", rgb("diffuse_reflectance", "0.2,0.5,0.8") + word("distribution", "ggx"))), RGB, ""),
    "pplastic": (ball(bsdf("pplastic", rgb("diffuse_reflectance", "0.2,0.5,0.8"))), RGB, ""),
    "principled": (ball(principled(roughness=0.4)), BOTH, ""),
    "principled metal": (ball(principled(roughness=0.3, metallic=1, anisotropic=0.6)), BOTH, ""),
    "principled spec_tint": (ball(principled(roughness=0.2, spec_tint=1)), BOTH, ""),
    "principled sheen": (ball(principled(roughness=0.8, sheen=1, sheen_tint=0.8, flatness=0.7)), BOTH, ""),
    "principled glass": (ball(principled(roughness=0.3, spec_trans=0.9, eta=1.4), depth=8), RGB, ""),
    "principled clearcoat": (ball(principled(roughness=0.5, clearcoat=1, clearcoat_gloss=0.4)), RGB, ""),
    "principledthin": (ball(bsdf("principledthin", BASE + floats(roughness=0.4, spec_trans=0.5, diff_trans=0.7, spec_tint=0.3, eta=1.4)), depth=8), BOTH, ""),
    "twosided": (wall(bsdf("twosided", bsdf("diffuse", rgb("reflectance", "0.8,0.2,0.2")) + bsdf("plastic")),
                      view=camera(look='<lookat origin="0.6,4,1.6" target="0,0,0" up="0,0,1"/>')), RGB, ""),
    "mask": (wall(bsdf("mask", floats(opacity=0.4) + bsdf("twosided", GREY)), more=FLOOR), RGB, ""),
    "mask point light": (wall(bsdf("mask", floats(opacity=0.4) + bsdf("twosided", GREY)), more=FLOOR, light=POINT), RGB, ""),
    "mask picture, point light": (wall(bsdf("mask", bitmap("opacity", "mask.png", RAW) + bsdf("twosided", GREY)), more=FLOOR, light=POINT), RGB, ""),
    "mask max_depth": (wall(bsdf("mask", floats(opacity=0.4) + bsdf("twosided", GREY)), more=FLOOR, depth=2), RGB, ""),
    "null max_depth": (scene(f'<shape type="cube"><bsdf type="null"/></shape>{FLOOR}', depth=3), RGB, ""),
    "blendbsdf": (ball(bsdf("blendbsdf", floats(weight=0.3) + GREY + bsdf("roughconductor", word("distribution", "ggx")))), RGB, ""),
    "bumpmap": (wall(detail("bumpmap", "height.png", scale=0.1)), RGB, ""),
    "bumpmap steep": (wall(detail("bumpmap", "height.png", scale=1.0)), RGB, ""),
    "bumpmap steep conductor": (wall(detail("bumpmap", "height.png", bsdf("roughconductor", word("distribution", "ggx")), scale=0.5)), RGB, ""),
    "bumpmap ball": (ball(detail("bumpmap", "height.png", scale=0.1)), RGB, ""),
    "bumpmap twosided": (wall(bsdf("twosided", detail("bumpmap", "height.png", scale=0.3))), RGB, ""),
    "normalmap": (wall(detail("normalmap", "normal.png")), RGB, ""),
    "normalmap ball": (ball(detail("normalmap", "normal.png", bsdf("roughconductor", word("distribution", "ggx")))), RGB, ""),
    "normalmap diffuse ball": (ball(detail("normalmap", "normal.png")), RGB, ""),
    "normalmap glass ball": (ball(detail("normalmap", "normal.png", bsdf("roughdielectric", word("distribution", "ggx")))), RGB, ""),
    "hair": (scene(f'<shape type="bsplinecurve">{word("filename", "curve.txt")}<bsdf type="hair">{floats(eumelanin=0.4)}</bsdf></shape>'), RGB,
             "see the table of scattering models"),
    # Textures
    "bitmap": (wall(textured(bitmap("reflectance", "colors.png"))), BOTH, ""),
    "bitmap nearest": (wall(textured(bitmap("reflectance", "colors.png", word("filter_type", "nearest")))), RGB, ""),
    "bitmap raw": (wall(textured(bitmap("reflectance", "colors.png", RAW))), RGB, ""),
    "bitmap to_uv repeat": (wall(textured(bitmap("reflectance", "colors.png", '<transform name="to_uv"><scale value="2.5"/><rotate z="1" angle="20"/></transform>'))), RGB, ""),
    "bitmap mirror": (wall(textured(bitmap("reflectance", "colors.png", word("wrap_mode", "mirror") + '<transform name="to_uv"><scale value="2.5"/></transform>'))), RGB, ""),
    "bitmap clamp": (wall(textured(bitmap("reflectance", "colors.png", word("wrap_mode", "clamp") + '<transform name="to_uv"><scale value="2.5"/></transform>'))), RGB, ""),
    "bitmap roughness": (wall(bsdf("roughconductor", GOLD + bitmap("alpha", "height.png", RAW) + word("distribution", "ggx"))), RGB, ""),
    "checkerboard": (wall(textured('<texture type="checkerboard" name="reflectance"><transform name="to_uv"><scale x="3" y="2"/></transform></texture>')), RGB, ""),
    "volume": (ball(textured(f'<texture type="volume" name="reflectance"><volume type="gridvolume" name="volume">{word("filename", "color.vol")}'
                             f'{put(move(x=-0.5, y=-0.5, z=-0.5) + size(2))}</volume></texture>')), RGB, ""),
    "mesh_attribute vertex": (scene(f'<shape type="ply">{word("filename", "colors.ply")}<bsdf type="diffuse"><texture type="mesh_attribute" name="reflectance">'
                                    f'{word("name", "vertex_color")}</texture></bsdf></shape>'), BOTH, ""),
    "mesh_attribute face": (scene(f'<shape type="ply">{word("filename", "colors.ply")}<bsdf type="diffuse"><texture type="mesh_attribute" name="reflectance">'
                                  f'{word("name", "face_color")}</texture></bsdf></shape>'), BOTH, ""),
    "spectrum irregular": (ball(bsdf("diffuse", '<spectrum name="reflectance" value="400:0.1, 500:0.7, 600:0.2, 700:0.9"/>')), BOTH, ""),
    "spectrum blackbody": (ball(GREY, light='<emitter type="constant"><spectrum type="blackbody" name="radiance"><float name="temperature" value="3500"/></spectrum></emitter>'), SPECTRAL, WHITE),
    "spectrum d65": (ball(GREY, light='<emitter type="constant"><spectrum type="d65" name="radiance"/></emitter>'), BOTH, ""),
    # Emitters
    "area textured": (scene(f'<shape type="rectangle">{put(size(1.2) + turn("x", 80) + move(y=1))}'
                            f'<emitter type="area">{bitmap("radiance", "colors.png")}</emitter></shape>' + FLOOR, light=""), BOTH, WHITE),
    "point": (shape("sphere", light=POINT), BOTH, ""),
    "spot": (shape("sphere", light=f'<emitter type="spot">{put(look("-2,-2,3", up="0,1,0"))}'
                   f'{floats(cutoff_angle=25, beam_width=12)}{rgb("intensity", "40,30,30")}</emitter>'), RGB, ""),
    "spot textured": (shape("sphere", light=f'<emitter type="spot">{put(look("-2,-2,3", up="0,1,0"))}'
                            f'{floats(cutoff_angle=25)}{rgb("intensity", "40,30,30")}{bitmap("texture", "colors.png")}</emitter>'), BOTH, WHITE),
    "directional": (shape("sphere", light=sun()), BOTH, ""),
    "directionalarea": (scene(f'<shape type="disk">{put(size(0.7) + look("-1,-1,3", up="0,1,0"))}'
                              f'<emitter type="directionalarea">{rgb("radiance", "4,3,3")}</emitter></shape>' + FLOOR, light=SKY), RGB, ""),
    "constant": (shape("sphere", light=SKY), BOTH, ""),
    "envmap": (shape("sphere", light=envmap("env.exr", UP)), BOTH, ""),
    "envmap 8x4": (ball(bsdf("roughconductor", word("distribution", "ggx")), light=envmap("small.exr", UP + '<rotate z="1" angle="40"/>')), RGB, ""),
    "envmap seen": (ball(bsdf("conductor"), light=envmap("small.exr", UP)), RGB, ""),
    "envmap scale": (ball(GREY, light=envmap("env.exr", UP, floats(scale=2.5))), RGB, ""),
    "projector": (shape("sphere", light=f'<emitter type="projector">{put(look("-2,-2,3"))}'
                        f'{floats(fov=40, scale=30)}{bitmap("irradiance", "colors.png")}</emitter>' + SKY), BOTH, ""),
    "sunsky": (shape("sphere", light=f'<emitter type="sunsky">{put(UP)}</emitter>'), RGB, ""),
    # Shapes
    "rectangle": (shape("rectangle", put('<rotate x="1" angle="50"/>')), RGB, ""),
    "disk textured": (scene(f'<shape type="disk">{put(turn("x", 60))}{textured(bitmap("reflectance", "colors.png"))}</shape>'), RGB, ""),
    "sphere textured": (ball(textured(bitmap("reflectance", "colors.png"))), RGB, ""),
    "cube textured": (scene(f'<shape type="cube">{put(size(0.7) + turn("z", 30))}{textured(bitmap("reflectance", "colors.png"))}</shape>'), RGB, ""),
    "cylinder textured": (scene(f'<shape type="cylinder"><point name="p0" value="-0.7,0,-0.5"/><point name="p1" value="0.7,0.3,0.6"/>{floats(radius=0.5)}'
                                f'{bsdf("twosided", textured(bitmap("reflectance", "colors.png")))}</shape>'), RGB, ""),
    "obj": (shape("obj", word("filename", "tile.obj")), RGB, ""),
    "obj textured": (scene(f'<shape type="obj">{word("filename", "tile.obj")}{textured(bitmap("reflectance", "colors.png"))}</shape>'), RGB, ""),
    "ply": (shape("ply", word("filename", "colors.ply")), RGB, ""),
    "ply face_normals": (shape("ply", word("filename", "smooth.ply") + '<boolean name="face_normals" value="true"/>'), RGB, ""),
    "ply smooth": (shape("ply", word("filename", "smooth.ply")), RGB, ""),
    "serialized": (shape("serialized", word("filename", "tile.serialized")), RGB, ""),
    "flip_normals": (shape("sphere", '<boolean name="flip_normals" value="true"/>', more=""), RGB, ""),
    "instance": (scene(f'<shape type="shapegroup" id="g"><shape type="sphere">{GREY}</shape><shape type="cube">{put(move(x=2))}{bsdf("plastic")}</shape></shape>'
                       + "".join(f'<shape type="instance">{put(size(0.3) + turn("z", a) + move(x=x))}<ref id="g"/></shape>'
                                 for a, x in [(0, -1), (50, 0), (110, 1)]) + FLOOR), RGB, ""),
    "merge": (scene(f'<shape type="merge"><shape type="cube">{put(size(0.4))}{GREY}</shape><shape type="rectangle">{GREY}</shape></shape>'), RGB, ""),
    "linearcurve": (shape("linearcurve", word("filename", "curve.txt")), RGB, ""),
    "bsplinecurve": (shape("bsplinecurve", word("filename", "curve.txt")), RGB, ""),
    "sdfgrid": (shape("sdfgrid", word("filename", "ball.vol") + put('<translate x="-0.5" y="-0.5" z="-0.5"/><scale value="2.2"/>')), RGB, ""),
    "sdfgrid analytic": (shape("sdfgrid", word("filename", "ball.vol") + word("normals", "analytic")
                               + put('<translate x="-0.5" y="-0.5" z="-0.5"/><scale x="2.2" y="1.8" z="2"/>')), RGB, ""),
    # Transforms
    "rotate": (shape("cube", put('<scale value="0.6"/><rotate x="0.6" y="0.48" z="0.64" angle="40"/>')), RGB, ""),
    "rotate long axis": (shape("cube", put('<scale value="0.5"/><rotate x="1" y="0.5" z="0.7" angle="40"/>')), RGB,
                         "normals are turned by the same matrix there, which is right for rotations alone"),
    "scale uneven": (shape("sphere", put('<scale x="1.2" y="0.5" z="0.8"/><rotate y="1" angle="30"/>')), RGB, ""),
    "mirrored": (shape("sphere", put('<scale x="-1" y="1" z="1"/>')), RGB, ""),
    "matrix": (shape("cube", put('<matrix value="0.5 0.2 0 0 0 0.5 0.3 0 0.1 0 0.5 0.1 0 0 0 1"/>')), RGB, ""),
    # Sensors
    "perspective fov_axis y": (scene(f'<shape type="sphere">{GREY}</shape>{FLOOR}', view=camera(word("fov_axis", "diagonal"))), RGB, ""),
    "principal_point": (shape("sphere", view=camera(floats(principal_point_offset_x=0.2, principal_point_offset_y=-0.1))), RGB, ""),
    "crop": (shape("sphere", view=camera(film="".join(f'<integer name="crop_{n}" value="{v}"/>' for n, v in
             [("width", 40), ("height", 32), ("offset_x", 8), ("offset_y", 16)]))), RGB, ""),
    "thinlens": (shape("sphere", view=camera(floats(aperture_radius=0.25, focus_distance=3.5), "thinlens")), RGB, ""),
    "orthographic": (shape("sphere", view=camera(kind="orthographic", look='<scale value="1.5"/>' + LOOK)), RGB, ""),
    "gaussian": (shape("cube", view=camera(rfilter='<rfilter type="gaussian"/>')), RGB, ""),
    "tent": (shape("cube", view=camera(rfilter='<rfilter type="tent"/>')), RGB, ""),
    "mitchell": (shape("cube", view=camera(rfilter='<rfilter type="mitchell"/>')), RGB, ""),
    "catmullrom": (shape("cube", view=camera(rfilter='<rfilter type="catmullrom"/>')), RGB, ""),
    "lanczos": (shape("cube", view=camera(rfilter='<rfilter type="lanczos"/>')), RGB, ""),
    # Media and integrators
    "homogeneous": (medium(rgb("albedo", "0.9,0.7,0.5") + rgb("sigma_t", "0.3,0.6,0.9") + floats(scale=3)), RGB, ""),
    "homogeneous hg": (medium(floats(albedo=0.9, sigma_t=1) + floats(scale=2), f'<phase type="hg">{floats(g=0.7)}</phase>'), BOTH, ""),
    "medium in glass": (medium(rgb("albedo", "0.9,0.7,0.5") + floats(sigma_t=2), skin=bsdf("roughdielectric", word("distribution", "ggx"))), RGB, ""),
    "heterogeneous": (medium(f'{floats(albedo=0.8, scale=3)}<volume type="gridvolume" name="sigma_t">{word("filename", "density.vol")}'
                             f'{put(move(x=-0.5, y=-0.5, z=-0.5) + size(1.6))}</volume>', kind="heterogeneous"), RGB, ""),
    "direct": (shape("sphere", integrator='<integrator type="direct"/>'), RGB, ""),
    "hide_emitters": (shape("sphere", integrator='<integrator type="path"><boolean name="hide_emitters" value="true"/><integer name="max_depth" value="3"/></integrator>'), RGB, ""),
    "max_depth 1": (shape("sphere", depth=1), RGB, ""),
    "max_depth 2": (shape("sphere", depth=2), RGB, ""),
}

# ------------------------------------------------------------------------------------------------------------ their files


def write_files(mi, folder):
    """What the scenes read."""
    rng = np.random.default_rng(5)

    def picture(name, values):
        mi.Bitmap(np.ascontiguousarray(values, dtype=np.uint8)).write(str(folder / name))

    picture("colors.png", rng.integers(20, 250, (6, 8, 3)))
    y, x = np.mgrid[0:32, 0:32] / 32
    waves = 0.5 + 0.2 * np.sin(2 * np.pi * 2 * x) + 0.2 * np.cos(2 * np.pi * (3 * y + x))
    picture("height.png", np.round(255 * waves)[..., None])
    picture("mask.png", np.round(255 * np.clip(1.4 * waves - 0.2, 0, 1))[..., None])
    slope = np.stack([np.cos(2 * np.pi * 2 * x) * 0.6, -np.sin(2 * np.pi * 3 * y) * 0.6, np.ones_like(x)], -1)
    slope /= np.linalg.norm(slope, axis=-1, keepdims=True)
    picture("normal.png", np.round(255 * (0.5 + 0.5 * slope)))
    light = rng.uniform(0.1, 1.2, (16, 32, 3)).astype(np.float32)
    light[3, 5] = [40, 35, 25]
    mi.Bitmap(light).write(str(folder / "env.exr"))
    mi.Bitmap(rng.uniform(0.05, 1.5, (4, 8, 3)).astype(np.float32)).write(str(folder / "small.exr"))

    def grid(name, values):
        mi.VolumeGrid(np.ascontiguousarray(values, dtype=np.float32)).write(str(folder / name))

    grid("density.vol", rng.uniform(0.2, 1, (4, 5, 6, 1)))
    grid("color.vol", rng.uniform(0.1, 0.9, (4, 5, 6, 3)))
    z, y, x = np.meshgrid(*[np.linspace(-0.5, 0.5, 16)] * 3, indexing="ij")
    grid("ball.vol", (np.maximum(np.sqrt(x * x + y * y + z * z) - 0.36, 0.2 - np.hypot(x - 0.1, z - 0.35)))[..., None])

    corners = [(-1, 0.1, -0.9), (1, -0.1, -0.8), (1, 0.2, 0.9), (-1, 0.3, 0.8), (0, -0.7, 0)]
    faces = [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]
    hues = [(0.9, 0.1, 0.1), (0.1, 0.8, 0.2), (0.1, 0.2, 0.9), (0.8, 0.8, 0.1), (0.7, 0.7, 0.7)]
    line = lambda *parts: " ".join(str(v) for part in parts for v in part)
    (folder / "colors.ply").write_text(
        "ply\nformat ascii 1.0\nelement vertex 5\n" + "".join(f"property float {n}\n" for n in ["x", "y", "z", "r", "g", "b"])
        + "element face 4\nproperty list uchar int vertex_indices\n" + "".join(f"property float {n}\n" for n in "rgb") + "end_header\n"
        + "".join(line(c, h) + "\n" for c, h in zip(corners, hues)) + "".join(line((3,), f, h) + "\n" for f, h in zip(faces, hues)))
    unit = [np.array(c) / np.linalg.norm(c) - [0, 0.3, 0] for c in corners]
    normals = [np.array([c[0] * 0.4, -1, c[2] * 0.4]) / np.linalg.norm([c[0] * 0.4, 1, c[2] * 0.4]) for c in corners]
    (folder / "smooth.ply").write_text(
        "ply\nformat ascii 1.0\nelement vertex 5\n" + "".join(f"property float {n}\n" for n in ["x", "y", "z", "nx", "ny", "nz"])
        + "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
        + "".join(line(c, n) + "\n" for c, n in zip(unit, normals)) + "".join(line((3,), f) + "\n" for f in faces))
    (folder / "tile.obj").write_text(
        "".join(f"v {line(c)}\n" for c in corners) + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0.5 0.4\n"
        + "".join("f " + " ".join(f"{i + 1}/{i + 1}" for i in f) + "\n" for f in faces))
    # Mitsuba's own binary meshes: magic, version 4, then deflated flags (single precision), name, counts, data; a table of offsets.
    body = struct.pack("<I", 0x1000) + b"tile\0" + struct.pack("<QQ", 5, 4)
    body += np.array(corners, "<f4").tobytes() + np.array(faces, "<u4").tobytes()
    data = struct.pack("<HH", 0x041C, 4) + zlib.compress(body)
    (folder / "tile.serialized").write_bytes(data + struct.pack("<QI", 0, 1))
    turns = np.linspace(0, 3, 24)
    (folder / "curve.txt").write_text("".join(
        f"{math.cos(2 * t) * 0.8:.4f} {math.sin(2 * t) * 0.8:.4f} {t * 0.5 - 0.8:.4f} {0.06 + 0.03 * math.sin(5 * t):.4f}\n" for t in turns))


# ----------------------------------------------------------------------------------------------------------- measurement


def theirs(mi, path, spp, seeds):
    read = mi.load_file(str(path))
    return np.stack([np.array(mi.render(read, spp=spp, seed=1000 + s))[..., :3] for s in range(seeds)]).astype(np.float64)


def read_pfm(path):
    with open(path, "rb") as f:
        kind, size, scale = f.readline().strip(), f.readline().split(), float(f.readline())
        values = np.frombuffer(f.read(), "<f4" if scale < 0 else ">f4").astype(np.float64)
    return values.reshape(int(size[1]), int(size[0]), 3 if kind == b"PF" else 1)[::-1]


def plain(text):
    return re.sub(r"\x1b\[[0-9;]*m", "", text)


def ours(program, path, mode, spp, seeds, folder):
    """Pictures, or None; and what was said, each message's first line once."""
    integrator = "volpath" if 'type="volpath"' in path.read_text() else "direct" if 'type="direct"' in path.read_text() else "path:reuse=1"
    if integrator == "volpath":
        integrator = "volpath:reuse=1"
    said, pictures = [], []
    for s in range(seeds):
        out = folder / "ours.pfm"
        out.unlink(missing_ok=True)
        command = [program, "render", str(path), "-o", str(out), "--color", mode, "--spp", str(spp), "--seed", str(s), "--integrator", integrator]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if s == 0:
            for line in plain(done.stderr).splitlines():
                found = re.match(r"(error|warning|note|approximated|dropped)[^:]*: (.*)", line.strip())
                if found and found.group(0) not in said:
                    said.append(found.group(0))
        if done.returncode != 0:
            return None, said or [plain(done.stderr).strip().splitlines()[-1] if done.stderr.strip() else f"exit {done.returncode}"]
        pictures.append(read_pfm(out)[..., :3])
    return np.stack(pictures), said


def blocks(p):
    """Means over blocks of the seeds' pictures."""
    s, h, w, c = p.shape
    return p[:, :h - h % BLOCK, :w - w % BLOCK].reshape(s, h // BLOCK, BLOCK, w // BLOCK, BLOCK, c).mean((2, 4))


def probability(a, b, noise):
    """Welch's test of means along the first axis: smallest probability, corrected for how many there are; difference and standard error.
    Rounding of pictures sets a floor to standard errors."""
    n = len(a)
    va, vb = a.var(0, ddof=1) / n + noise**2, b.var(0, ddof=1) / n + noise**2
    error = np.sqrt(va + vb)
    freedom = (va + vb)**2 / ((va**2 + vb**2) / (n - 1))
    d = a.mean(0) - b.mean(0)
    p = 2 * stats.t.sf(np.abs(d) / error, freedom)
    return 1 - (1 - p.min())**p.size, d, error


def measure(a, b):
    level = b.mean()
    noise = 2e-4 * level
    p_blocks, d, error = probability(blocks(a), blocks(b), noise)
    p_mean, dm, em = probability(a.mean((1, 2)), b.mean((1, 2)), noise)
    base = np.maximum(blocks(b).mean(0), 0.1 * level)
    sure = np.abs(d) > 3 * error
    largest = float(np.abs(d / base)[sure].max()) if sure.any() else 0.0
    total_a, total_b = a.mean((1, 2, 3)), b.mean((1, 2, 3))
    spread = math.sqrt(total_a.var(ddof=1) / len(a) + total_b.var(ddof=1) / len(b))
    return min(1.0, 2 * min(p_blocks, p_mean)), 100 * (total_a.mean() / level - 1), 100 * spread / level, 100 * largest


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("program")
    p.add_argument("--only", default="", help="scenes whose names contain one of these words, separated by commas")
    p.add_argument("--spp", type=int, default=64)
    p.add_argument("--seeds", type=int, default=8)
    p.add_argument("--keep", help="a folder for the scenes and pictures")
    p.add_argument("--markdown", action="store_true", help="print a page of documentation")
    args = p.parse_args()
    import mitsuba as mi

    words = args.only.split(",")
    rows = [(name, mode, text, why) for mode in BOTH for name, (text, modes, why) in SCENES.items() if mode in modes and any(w in name for w in words)]
    alpha = 1 - 0.99**(1 / sum(len(modes) for _, modes, _ in SCENES.values()))
    failed = []
    if args.markdown:
        print("## Pictures of one feature each\n\nWritten by `scripts/compare_mitsuba_scenes.py target/release/steradian --markdown`, which says how it is measured: Mitsuba "
              f"{mi.__version__}, {SIZE}² pixels, {args.spp} samples,\n{args.seeds} seeds of each program; differences of means, and of the block of 8 × 8 pixels that differs "
              "most beyond three standard errors. `ellipsoids` and `ellipsoidsmesh` are refused.\n")
        print("| scene | mode | mean, % | largest block, % | | what the program says, or the reason |\n|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(args.keep or folder)
        folder.mkdir(exist_ok=True)
        mi.set_variant("scalar_rgb")
        mi.set_log_level(mi.LogLevel.Error)
        write_files(mi, folder)
        for name, mode, text, why in rows:
            if mi.variant() != f"llvm_ad_{mode}":
                mi.set_variant(f"llvm_ad_{mode}")
                mi.set_log_level(mi.LogLevel.Error)
            path = folder / "scene.xml"
            if args.keep:
                path = folder / (re.sub(r"\W+", "_", name) + ".xml")
            path.write_text(text)
            try:
                b = theirs(mi, path, args.spp, args.seeds)
            except RuntimeError as e:
                b, fault = None, str(e).strip().splitlines()[-1]
            a, said = ours(args.program, path, mode, args.spp, args.seeds, folder)
            lossy = [m for m in said if "sampler" not in m and not re.search(r"has \d+ errors?$", m)]
            if a is None or b is None or a.shape != b.shape:
                verdict = "refused" if a is None else f"not in Mitsuba ({fault})" if b is None else f"sizes {a.shape} {b.shape}"
                if a is not None and b is not None:
                    failed.append(name)
                numbers = ("", "")
            else:
                if args.keep:
                    np.savez_compressed(path.with_suffix(f".{mode}.npz"), ours=a.astype(np.float32), theirs=b.astype(np.float32))
                p_value, mean, error, largest = measure(a, b)
                differs = p_value < alpha
                verdict = "differs" if differs else "agrees"
                numbers = (f"{mean:+.2f} ± {error:.2f}", f"{largest:.1f}")
                if differs and not why and not lossy:
                    failed.append(f"{name} ({mode})")
                    verdict = "DIFFERS"
            reason = "; ".join([why] * bool(why and verdict == "differs") + lossy)
            if args.markdown:
                print(f"| {name} | {mode} | {numbers[0]} | {numbers[1]} | {verdict} | {reason} |", flush=True)
            else:
                print(f"{name:28} {mode:8} {numbers[0]:>16} {numbers[1]:>7} {verdict:8} {reason}", flush=True)
    if failed:
        print(f"not explained: {', '.join(failed)}", file=sys.stderr)
    return int(bool(failed))


if __name__ == "__main__":
    sys.exit(main())
