"""What tests share: the add-on, and pictures by it and by Cycles."""

import os
import tempfile

import addon
import bpy
import common
import numpy as np
import steradian

ADDON = addon.load()
if not hasattr(bpy.types.Scene, "steradian"):
    ADDON.register()
scene = addon.load("export.scene")


def exported(**how):
    """The description of the current scene."""
    report = addon.load("export.report").Report(lambda line: None)
    found = scene.Exporter(report).export(bpy.context.evaluated_depsgraph_get(), **how)
    return found, report.lines


def rendered(engine, samples=16, seed=1, channels="RGB"):
    """A picture of the current scene by an engine: an array, or the whole picture where there are no channels."""
    current = bpy.context.scene
    current.render.engine = engine
    current.cycles.samples, current.cycles.seed = samples, seed
    current.cycles.use_denoising = current.cycles.use_adaptive_sampling = False
    current.steradian.samples, current.steradian.seed = samples, seed
    current.render.threads_mode, current.render.threads = "FIXED", 1
    current.steradian.threads = 1
    current.render.image_settings.color_depth = "32"
    with tempfile.TemporaryDirectory() as folder:
        current.render.filepath = os.path.join(folder, "picture.exr")
        bpy.ops.render.render(write_still=True)
        image = steradian.read_image(current.render.filepath)
    return np.stack([image[c] for c in channels], axis=-1) if channels else image


def both(samples=16, cycles=None):
    """Pictures by Steradian and by Cycles."""
    return rendered("STERADIAN", samples), rendered("CYCLES", cycles or samples)


def lit_plane(size=(24, 24)):
    """A grey plane that a camera looks down on."""
    current = common.empty(size)
    common.shape("plane", common.matte("Grey", (0.5, 0.5, 0.5)), size=8)
    common.camera((0, 0.001, 6), (0, 0, 0))
    return current
