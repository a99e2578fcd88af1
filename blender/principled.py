"""Compares the inputs of the Principled BSDF between Cycles and Steradian.

    python blender/principled.py [--only TEXT] [--scene ball|box] [--write]

Every input is rendered at some values by both: a ball under an environment with two lights, and a ball and a card in a
box. Printed are the difference of the pictures' means in percent of Cycles' mean, the largest such difference of the 16
regions of a grid, and the largest z of these. `--write` puts the table into docs/blender-materials.md, and pictures
side by side beside it. Needs the modules `bpy` and `steradian`.
"""

from __future__ import annotations

import argparse
import math
import pathlib
import sys
import tempfile

import bpy
import numpy as np

# The folder of the extension, beside this file, has the name of the module.
HERE = pathlib.Path(__file__).resolve().parent
sys.path[:] = [p for p in sys.path if pathlib.Path(p or ".").resolve() != HERE]
import steradian as st  # noqa: E402

sys.path.insert(0, str(HERE / "steradian"))
sys.path.append(str(HERE))
import nodes  # noqa: E402
from least import Context  # noqa: E402

DOCS = HERE.parent / "docs"
SIZE, SEEDS = 64, 4
REGIONS = 4

GOLD = (1.0, 0.6, 0.2)
SKIN = (0.8, 0.4, 0.25)
METAL = {"Metallic": 1.0, "Base Color": GOLD}
GLASS = {"Transmission Weight": 1.0, "Roughness": 0.0, "Base Color": (1.0, 1.0, 1.0)}
SKINNY = {"method": "RANDOM_WALK_SKIN", "Subsurface Weight": 1.0, "Base Color": SKIN, "Subsurface Scale": 0.5}
CASES: list[tuple[str, dict]] = [
    ("defaults", {}),
    ("Base Color", {"Base Color": (0.8, 0.1, 0.05)}),
    ("Base Color", {"Base Color": (1.0, 1.0, 1.0)}),
    ("Roughness", {"Roughness": 0.0}),
    ("Roughness", {"Roughness": 0.2}),
    ("Roughness", {"Roughness": 1.0}),
    ("Metallic", METAL),
    ("Metallic", {**METAL, "Metallic": 0.5}),
    ("Metallic, Roughness", {**METAL, "Roughness": 0.1}),
    ("Metallic, Roughness", {**METAL, "Roughness": 1.0}),
    ("IOR", {"IOR": 1.1}),
    ("IOR", {"IOR": 2.5}),
    ("Alpha", {"Alpha": 0.5}),
    ("Alpha", {"Alpha": 0.1}),
    ("Diffuse Roughness", {"Diffuse Roughness": 0.5}),
    ("Diffuse Roughness", {"Diffuse Roughness": 1.0}),
    ("Subsurface Weight", {"Subsurface Weight": 1.0, "Base Color": SKIN}),
    ("Subsurface Weight", {"Subsurface Weight": 0.5, "Base Color": SKIN}),
    ("Subsurface Radius", {"Subsurface Weight": 1.0, "Base Color": SKIN, "Subsurface Radius": (0.2, 0.5, 1.0),
                           "Subsurface Scale": 0.2}),
    ("Subsurface Scale", {"Subsurface Weight": 1.0, "Base Color": SKIN, "Subsurface Scale": 0.5}),
    ("Subsurface IOR", {**SKINNY, "Subsurface IOR": 1.4}),
    ("Subsurface IOR", {**SKINNY, "Subsurface IOR": 1.1}),
    ("Subsurface Anisotropy", {"Subsurface Weight": 1.0, "Base Color": SKIN, "Subsurface Anisotropy": 0.8}),
    ("Specular IOR Level", {"Specular IOR Level": 0.0}),
    ("Specular IOR Level", {"Specular IOR Level": 1.0}),
    ("Specular Tint", {"Specular Tint": (1.0, 0.2, 0.1), "Specular IOR Level": 1.0, "Roughness": 0.3}),
    ("Specular Tint", {**METAL, "Specular Tint": (0.1, 0.3, 1.0), "Roughness": 0.3}),
    ("Anisotropic", {**METAL, "Anisotropic": 0.5, "Roughness": 0.3}),
    ("Anisotropic", {**METAL, "Anisotropic": 1.0, "Roughness": 0.3}),
    ("Anisotropic Rotation", {**METAL, "Anisotropic": 0.9, "Roughness": 0.3, "Anisotropic Rotation": 0.25}),
    ("Anisotropic Rotation", {**METAL, "Anisotropic": 0.9, "Roughness": 0.3, "Anisotropic Rotation": 0.125}),
    ("Transmission Weight", GLASS),
    ("Transmission Weight", {**GLASS, "Transmission Weight": 0.5}),
    ("Transmission, Base Color", {**GLASS, "Base Color": (0.3, 0.8, 0.5)}),
    ("Transmission, Roughness", {**GLASS, "Roughness": 0.3}),
    ("Transmission, Roughness", {**GLASS, "Roughness": 0.8}),
    ("Coat Weight", {"Coat Weight": 1.0}),
    ("Coat Weight", {**METAL, "Coat Weight": 0.5}),
    ("Coat Roughness", {"Coat Weight": 1.0, "Coat Roughness": 0.3}),
    ("Coat Roughness", {"Coat Weight": 1.0, "Coat Roughness": 0.0}),
    ("Coat IOR", {"Coat Weight": 1.0, "Coat IOR": 2.0}),
    ("Coat IOR", {"Coat Weight": 1.0, "Coat IOR": 1.2}),
    ("Coat Tint", {"Coat Weight": 1.0, "Coat Tint": (0.9, 0.4, 0.1)}),
    ("Coat Tint", {"Coat Weight": 0.5, "Coat Tint": (0.1, 0.4, 0.9)}),
    ("Sheen Weight", {"Sheen Weight": 1.0, "Base Color": (0.1, 0.1, 0.3)}),
    ("Sheen Weight", {"Sheen Weight": 0.3, "Base Color": (0.1, 0.1, 0.3)}),
    ("Sheen Roughness", {"Sheen Weight": 1.0, "Base Color": (0.1, 0.1, 0.3), "Sheen Roughness": 0.2}),
    ("Sheen Roughness", {"Sheen Weight": 1.0, "Base Color": (0.1, 0.1, 0.3), "Sheen Roughness": 1.0}),
    ("Sheen Tint", {"Sheen Weight": 1.0, "Base Color": (0.1, 0.1, 0.3), "Sheen Tint": (1.0, 0.3, 0.1)}),
    ("Emission Strength", {"Emission Strength": 0.5}),
    ("Emission Color", {"Emission Strength": 0.5, "Emission Color": (0.1, 0.3, 1.0)}),
    ("Emission, Alpha", {"Emission Strength": 0.5, "Alpha": 0.5}),
    ("Thin Film Thickness", {"Thin Film Thickness": 300.0, "Roughness": 0.2}),
    ("Thin Film Thickness", {**METAL, "Thin Film Thickness": 500.0, "Roughness": 0.2}),
    ("Thin Film IOR", {"Thin Film Thickness": 300.0, "Thin Film IOR": 2.0, "Roughness": 0.2}),
]


def new_material(name, values):
    """A Principled BSDF with some inputs set."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    node = next(n for n in made.node_tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
    for key, value in values.items():
        if key == "method":
            node.subsurface_method = value
            continue
        socket = next(x for x in node.inputs if x.identifier == key)
        is_colour = socket.type == "RGBA"
        socket.default_value = (*value, 1.0) if is_colour else value
    return made


def of_one_node(name, kind, socket, value):
    """A material of one shader with one input set."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    node, out = tree.nodes.new(kind), tree.nodes.new("ShaderNodeOutputMaterial")
    node.inputs[socket].default_value = value
    tree.links.new(out.inputs["Surface"], node.outputs[0])
    return made


def diffuse(name, colour):
    return of_one_node(name, "ShaderNodeBsdfDiffuse", "Color", (*colour, 1.0))


def lamp(name, radiance):
    return of_one_node(name, "ShaderNodeEmission", "Strength", radiance)


def quad(name, corners, material):
    """A rectangle with coordinates from corner to corner."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
    layer = mesh.uv_layers.new(name="UVMap")
    for loop, uv in zip(layer.data, ((0, 0), (1, 0), (1, 1), (0, 1))):
        loop.uv = uv
    return placed(name, mesh, material)


def placed(name, mesh, material):
    mesh.materials.append(material)
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def ball(material, radius=1.0, at=(0, 0, 0)):
    """A sphere of quads, of smooth normals; u is the longitude."""
    across, down = 64, 32
    vertices, faces, uvs = [], [], []
    for j in range(down + 1):
        for i in range(across + 1):
            phi, theta = 2 * math.pi * i / across, math.pi * (1 - j / down)
            vertices.append((radius * math.sin(theta) * math.cos(phi), radius * math.sin(theta) * math.sin(phi),
                             radius * math.cos(theta)))
    for j in range(down):
        for i in range(across):
            a = j * (across + 1) + i
            faces.append((a, a + 1, a + across + 2, a + across + 1))
            uvs += [(i / across, j / down), ((i + 1) / across, j / down), ((i + 1) / across, (j + 1) / down),
                    (i / across, (j + 1) / down)]
    mesh = bpy.data.meshes.new("ball")
    mesh.from_pydata(vertices, [], faces)
    layer = mesh.uv_layers.new(name="UVMap")
    layer.data.foreach_set("uv", np.array(uvs, np.float32).ravel())
    mesh.shade_smooth()
    mesh.normals_split_custom_set_from_vertices([tuple(np.array(x) / radius) for x in vertices])
    thing = placed("ball", mesh, material)
    thing.location = at
    return thing


def scene_of(kind, material):
    """The scene in Blender; its camera's place and angle."""
    if kind == "ball":
        quad("key", [(-3, -3, 3), (-1, -3, 3), (-1, -1, 4), (-3, -1, 4)], lamp("key", 8.0))
        quad("rim", [(3, 2, 0), (3, 3, 0), (3, 3, 2), (3, 2, 2)], lamp("rim", 15.0))
        ball(material)
        return (0.0, -4.2, 0.8), (0.0, 0.0, 0.0), 34.0, 0.4
    white, red, green = (diffuse(n, c) for n, c in
                         (("white", (0.7, 0.7, 0.7)), ("red", (0.6, 0.05, 0.05)), ("green", (0.1, 0.45, 0.1))))
    quad("floor", [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1)], white)
    quad("ceiling", [(-1, 1, 1), (1, 1, 1), (1, -1, 1), (-1, -1, 1)], white)
    quad("back", [(-1, 1, -1), (1, 1, -1), (1, 1, 1), (-1, 1, 1)], white)
    quad("left", [(-1, -1, -1), (-1, 1, -1), (-1, 1, 1), (-1, -1, 1)], red)
    quad("right", [(1, 1, -1), (1, -1, -1), (1, -1, 1), (1, 1, 1)], green)
    quad("light", [(-0.4, 0.4, 0.99), (0.4, 0.4, 0.99), (0.4, -0.4, 0.99), (-0.4, -0.4, 0.99)], lamp("light", 10.0))
    ball(material, 0.42, (-0.42, 0.1, -0.55))
    quad("card", [(0.1, 0.5, -0.98), (0.8, 0.2, -0.98), (0.8, 0.35, 0.2), (0.1, 0.65, 0.2)], material)
    return (0.0, -3.6, 0.0), (0.0, 0.0, 0.0), 38.0, 0.0


def set_up(size):
    """An empty file, and settings of Cycles that make it unbiased."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return set_up_here(size)


def set_up_here(size):
    """The same in the file that is open."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    own = scene.cycles
    own.use_denoising, own.use_adaptive_sampling = False, False
    own.max_bounces = own.diffuse_bounces = own.glossy_bounces = own.transmission_bounces = 64
    own.transparent_max_bounces = own.volume_bounces = 64
    own.sample_clamp_indirect = own.sample_clamp_direct = own.blur_glossy = 0.0
    own.pixel_filter_type, own.filter_width = "BOX", 1.0
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    return scene


def look(scene, eye, at, fov, sky):
    """The camera and the sky of a scene in Blender."""
    from mathutils import Vector

    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.angle = math.radians(fov)
    camera.location = eye
    camera.rotation_euler = (Vector(at) - Vector(eye)).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(camera)
    scene.camera = camera
    background = scene.world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (0.8, 0.9, 1.0, 1.0)
    background.inputs["Strength"].default_value = sky


def by_cycles(scene, spp, seed):
    """Cycles' picture, height × width × 3."""
    scene.cycles.samples, scene.cycles.seed = spp, seed
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = f"{folder}/a.exr"
        bpy.ops.render.render(write_still=True)
        return np.asarray(st.read_image(f"{folder}/a.exr"))[..., :3].astype(np.float64)


def shape_of(thing):
    """A mesh of Blender as one of a dictionary, each corner a vertex."""
    mesh = thing.data
    mesh.calc_loop_triangles()
    corners = np.array([t.loops for t in mesh.loop_triangles])
    vertex_of = np.array([loop.vertex_index for loop in mesh.loops])
    positions = np.array([x.co for x in mesh.vertices], np.float32)[vertex_of]
    normals = np.array([n.vector for n in mesh.corner_normals], np.float32)
    uvs = np.array([x.uv for x in mesh.uv_layers.active.data], np.float32)
    made = {"positions": positions, "triangles": corners.astype(np.int32), "normals": normals, "uvs": uvs}
    return {"shape": "mesh", "mesh": made, "to_world": np.array(thing.matrix_world, float)}


def description(eye, at, fov, sky, told):
    """The scene as a dictionary; what is told about materials goes to `told`."""
    bpy.context.view_layer.update()
    whole = {"materials": {}, "shapes": {}, "lights": {}, "filter": {"filter": "box"}}
    for thing in bpy.context.scene.objects:
        if thing.type != "MESH":
            continue
        context = Context("UVMap", thing)
        entry = nodes.material(thing.data.materials[0], context)
        told.update(context.reports)
        shape = shape_of(thing)
        for key in ("emission", "interior", "alpha", "displacement", "displacement_scale", "displacement_middle"):
            if key in entry:
                shape[key] = entry.pop(key)
        name = f"{thing.name} material"
        whole["materials"][name] = entry
        whole["shapes"][thing.name] = {**shape, "material": name}
    if sky:
        whole["lights"]["sky"] = {"light": "environment", "radiance": (0.8 * sky, 0.9 * sky, 1.0 * sky)}
    up = [0, 1, 0] if eye[:2] == at[:2] else [0, 0, 1]
    place = [{"scale": [-1, 1, 1]}, {"look_at": list(at), "from": list(eye), "up": up}]
    whole["camera"] = {"camera": "perspective", "fov": fov, "to_world": place}
    return whole


def pictures(kind, material, spp=64, size=SIZE, seeds=SEEDS):
    """Pictures of both renderers, one for each seed, and what was told."""
    scene = set_up(size)
    given = new_material("tested", material) if isinstance(material, dict) else material()
    view = scene_of(kind, given)
    look(scene, *view)
    theirs = np.stack([by_cycles(scene, spp, seed) for seed in range(seeds)])
    told: set = set()
    ours = st.scene(description(*view, told))
    found = [np.asarray(ours.render(spp=spp, size=(size, size), seed=100 + i, max_depth=64))[..., :3] for i in range(seeds)]
    return theirs, np.stack(found).astype(np.float64), sorted(told)


def regions(stack):
    """Means of a grid of regions, for each picture."""
    n, h, w, c = stack.shape
    return stack.reshape(n, REGIONS, h // REGIONS, REGIONS, w // REGIONS, c).mean((2, 4))


def figures(theirs, ours):
    """Difference of means in %, largest difference of a region in % of the picture's mean, and largest z."""
    a, b = regions(theirs), regions(ours)
    scale = theirs.mean()
    mean = 100.0 * (ours.mean() - theirs.mean()) / scale
    difference = b.mean(0) - a.mean(0)
    own = (a.var(0, ddof=1) + b.var(0, ddof=1)) / len(a)
    # Regions without noise have a floor of 2 parts in 10000.
    error = np.sqrt(0.5 * own + 0.5 * own.mean() + (2e-4 * scale) ** 2)
    return mean, 100.0 * np.abs(difference).max() / scale, np.abs(difference / error).max()


def tabulate():
    """Albedos of the sheen, means over the hemisphere by the cosine, at roughnesses from 0 to 1: Cycles, Steradian."""
    black = {"Specular IOR Level": 0.0, "Base Color": (0.0, 0.0, 0.0)}

    def means(values):
        scene = set_up(32)
        ball(new_material("tested", values))
        view = (0.0, -4.2, 0.0), (0.0, 0.0, 0.0), 34.0, 1.0
        look(scene, *view)
        scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
        scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 2.1
        whole = description(*view, set())
        whole["lights"]["sky"]["radiance"] = 1.0
        whole["camera"] = {"camera": "orthographic", "screen_window": {"floats": [-1.05, 1.05, -1.05, 1.05]},
                           "to_world": whole["camera"]["to_world"]}
        return by_cycles(scene, 128, 0).mean(), np.asarray(st.scene(whole).render(spp=128, size=(32, 32)))[..., :3].mean()

    covered = [1.0 - m for m in means(black)]
    for r in np.linspace(0.0, 1.0, 11):
        found = means({**black, "Sheen Weight": 1.0, "Sheen Roughness": float(r)})
        print(f"{r:.1f}", *(f"{1.0 + (m - 1.0) / c:.4f}" for m, c in zip(found, covered)), flush=True)


def shown(values):
    """The values of a case, short."""
    text = []
    for key, value in values.items():
        if isinstance(value, tuple):
            value = "(" + " ".join(f"{c:g}" for c in value) + ")"
        elif isinstance(value, float):
            value = f"{value:g}"
        text.append(f"{key} {value}")
    return ", ".join(text) or "as they are"


def sheet(rows, path):
    """Pictures side by side, Cycles on the left, as one JPEG."""
    columns = 9
    tiles = [np.concatenate(pair, 1) for pair in rows]
    while len(tiles) % columns:
        tiles.append(np.ones_like(tiles[0]))
    lines = [np.concatenate([np.pad(t, ((2, 2), (2, 2), (0, 0)), constant_values=1.0) for t in tiles[i:i + columns]], 1)
             for i in range(0, len(tiles), columns)]
    whole = np.concatenate(lines, 0)
    st.Image({k: np.ascontiguousarray(whole[..., i], np.float32) for i, k in enumerate("RGB")}).save(path, overwrite=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--only", default="")
    parser.add_argument("--scene", default="ball,box")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--sheet")
    parser.add_argument("--sheen", action="store_true", help="print the albedos of the sheen instead")
    given = parser.parse_args()
    if given.sheen:
        return tabulate()
    lines, tiles = [], []
    for name, values in CASES:
        if given.only.lower() not in name.lower():
            continue
        cells = []
        for kind in given.scene.split(","):
            theirs, ours, told = pictures(kind, values, given.spp)
            mean, most, z = figures(theirs, ours)
            cells += [f"{mean:+.2f}", f"{most:.1f}", f"{z:.1f}"]
            if kind == "ball":
                tiles.append((theirs.mean(0), ours.mean(0)))
        lines.append(f"| {name} | {shown(values)} | " + " | ".join(cells) + " |")
        print(lines[-1], *(f"{n}: {t}" for n, t in told if "tested" in n), flush=True)
    if given.sheet:
        sheet(tiles, given.sheet)
    if given.write:
        sheet(tiles, DOCS / "blender-materials.jpg")
        page = DOCS / "blender-materials.md"
        text = page.read_text()
        start = text.index("| input |")
        end = text.index("\n\n", start)
        head = "| input | values | ball: mean % | region % | z | box: mean % | region % | z |\n" + "|---" * 8 + "|\n"
        page.write_text(text[:start] + head + "\n".join(lines) + text[end:])


if __name__ == "__main__":
    main()
