"""What the scenes share: an empty scene, objects, materials and lamps."""

from __future__ import annotations

import math

import bpy


def empty(size=(240, 135)):
    """An empty scene with a size in pixels."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.view_settings.view_transform = "Standard"
    return scene


def put(name, data, location=(0, 0, 0), rotation=(0, 0, 0), scale=(1, 1, 1)):
    """An object in the scene; rotations are in degrees."""
    thing = bpy.data.objects.new(name, data)
    thing.location, thing.scale = location, scale
    thing.rotation_euler = [math.radians(angle) for angle in rotation]
    bpy.context.scene.collection.objects.link(thing)
    return thing


def camera(location, target, lens=40.0):
    """The scene's camera."""
    from mathutils import Vector

    data = bpy.data.cameras.new("Camera")
    data.lens = lens
    thing = put("Camera", data, location)
    thing.rotation_euler = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.camera = thing
    return thing


def lamp(kind, energy, location=(0, 0, 0), rotation=(0, 0, 0), **values):
    """A lamp; rotations are in degrees."""
    data = bpy.data.lights.new(kind.title(), kind)
    data.energy = energy
    for name, value in values.items():
        setattr(data, name, value)
    return put(kind.title(), data, location, rotation)


def tree(owner):
    """The node tree of a material or world."""
    if owner.node_tree is None:
        owner.use_nodes = True
    return owner.node_tree


def principled(name, **values):
    """A material of a Principled BSDF; `base_color=…` sets the input 'Base Color'."""
    material = bpy.data.materials.new(name)
    nodes = tree(material).nodes
    node = next((n for n in nodes if n.type == "BSDF_PRINCIPLED"), None)
    if node is None:
        node = nodes.new("ShaderNodeBsdfPrincipled")
        out = next((n for n in nodes if n.type == "OUTPUT_MATERIAL"), None) or nodes.new("ShaderNodeOutputMaterial")
        material.node_tree.links.new(node.outputs[0], out.inputs["Surface"])
    for key, value in values.items():
        socket = next(s for s in node.inputs if s.name.lower().replace(" ", "_") == key)
        socket.default_value = (
            (*value, 1.0) if isinstance(value, tuple) and len(value) == 3 and socket.type == "RGBA" else value
        )
    return material


def matte(name, colour):
    """A material that scatters diffusely alone."""
    material = bpy.data.materials.new(name)
    nodes = tree(material).nodes
    nodes.clear()
    node, out = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeOutputMaterial")
    node.inputs["Color"].default_value = (*colour, 1.0)
    material.node_tree.links.new(node.outputs[0], out.inputs["Surface"])
    return material


def world(colour=(0.05, 0.05, 0.05), strength=1.0, picture=None):
    """The scene's world, of a colour or a picture of Blender's own studio lights."""
    made = bpy.data.worlds.new("World")
    bpy.context.scene.world = made
    nodes = tree(made).nodes
    background = next((n for n in nodes if n.type == "BACKGROUND"), None)
    if background is None:
        background, out = nodes.new("ShaderNodeBackground"), nodes.new("ShaderNodeOutputWorld")
        made.node_tree.links.new(background.outputs[0], out.inputs["Surface"])
    background.inputs["Color"].default_value = (*colour, 1.0)
    background.inputs["Strength"].default_value = strength
    if picture:
        node = nodes.new("ShaderNodeTexEnvironment")
        node.image = bpy.data.images.load(
            f"{bpy.utils.resource_path('LOCAL')}/datafiles/studiolights/world/{picture}.exr"
        )
        made.node_tree.links.new(node.outputs[0], background.inputs["Color"])
    return made


def shape(kind, material=None, smooth=False, **values):
    """A mesh primitive, as 'cube' or 'uv_sphere', with a material."""
    getattr(bpy.ops.mesh, f"primitive_{kind}_add")(**values)
    thing = bpy.context.object
    if material is not None:
        thing.data.materials.append(material)
    if smooth:
        thing.data.shade_smooth()
    return thing
