"""A cloud of an OpenVDB file, and a box of fog."""

import os
import sys
import tempfile

import numpy as np
from common import camera, empty, lamp, matte, put, shape, tree, world

import bpy


def cloud(path, size=48):
    """Writes a ball of noise as an OpenVDB file."""
    sys.path.append(
        f"{bpy.utils.resource_path('LOCAL')}/python/lib/python{sys.version_info[0]}.{sys.version_info[1]}/site-packages"
    )
    try:
        import openvdb
    except ImportError:
        import pyopenvdb as openvdb
    random = np.random.default_rng(3)
    x = np.stack(np.meshgrid(*[np.linspace(-1, 1, size)] * 3, indexing="ij"))
    noise = sum(
        np.sin((x * f * random.normal(size=(3, 1, 1, 1)) * 3).sum(0) + random.uniform(0, 6)) / f
        for f in (1, 2, 3, 4, 6)
    )
    density = np.clip(1.2 - np.sqrt((x**2).sum(0)) * 1.6 + 0.25 * noise, 0, 1).astype(np.float32)
    grid = openvdb.FloatGrid()
    grid.copyFromArray(density)
    grid.name = "density"
    grid.transform = openvdb.createLinearTransform(voxelSize=2.0 / size)
    openvdb.write(path, grids=[grid])


def volumetric(name, density, colour):
    """A material of a Principled Volume."""
    material = bpy.data.materials.new(name)
    nodes = tree(material).nodes
    nodes.clear()
    node, out = nodes.new("ShaderNodeVolumePrincipled"), nodes.new("ShaderNodeOutputMaterial")
    node.inputs["Color"].default_value = (*colour, 1.0)
    node.inputs["Density"].default_value = density
    material.node_tree.links.new(node.outputs[0], out.inputs["Volume"])
    return material


def build():
    """Builds the scene."""
    scene = empty()
    world((0.35, 0.5, 0.8), 0.5)
    shape("plane", matte("Ground", (0.4, 0.4, 0.38)), size=12)
    path = os.path.join(tempfile.mkdtemp(prefix="steradian-cloud-"), "cloud.vdb")
    cloud(path)
    data = bpy.data.volumes.new("Cloud")
    data.filepath = path
    data.materials.append(volumetric("Vapour", 6.0, (0.9, 0.9, 0.9)))
    put("Cloud", data, (-1.7, -1.0, 0.4))
    shape("cube", volumetric("Fog", 1.2, (0.7, 0.8, 0.9)), size=1.2, location=(1.4, 0, 0.61))
    lamp("SUN", 3.0, rotation=(40, 0, 60), angle=0.05)
    camera((0, -6.0, 2.2), (0, 0, 0.9), 40)
    return scene


if __name__ == "__main__":
    build()
