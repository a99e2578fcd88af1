"""Passes, cancellation, motion, layers and the viewport's session."""

import addon
import bpy
import common
import numpy as np
import pytest
import steradian
from blend import ADDON, exported, lit_plane, rendered

engine = addon.load("engine")
viewport = addon.load("viewport")


def passes_of(samples=8):
    """The passes of a render, by their names in a multi-layer file."""
    settings = bpy.context.scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER"
    return rendered("STERADIAN", samples, channels=None)


def test_passes_are_written_as_blender_names_them():
    current = lit_plane()
    common.shape("cube", common.matte("Blue", (0.1, 0.2, 0.7)), size=1, location=(0, 0, 0.5)).name = "Box"
    common.lamp("POINT", 300, (0.5, 0.5, 5), shadow_soft_size=0.0)
    layer = bpy.context.view_layer
    layer.use_pass_z = layer.use_pass_normal = layer.use_pass_position = layer.use_pass_diffuse_color = True
    layer.use_pass_cryptomatte_object = True
    current.steradian.store_guides = True
    image = passes_of()
    found = {name.removeprefix("ViewLayer.").lower(): image[name] for name in image.channels}
    middle = (12, 12)
    assert np.isclose(found["depth.z"][middle], 5, atol=0.01) and np.isclose(found["depth.z"][1, 1], 6, atol=0.01)
    assert np.allclose([found[f"normal.{c}"][middle] for c in "xyz"], (0, 0, 1), atol=0.01)
    assert np.isclose(found["position.z"][middle], 1, atol=0.01)
    assert np.allclose([found[f"denoising albedo.{c}"][middle] for c in "rgb"], (0.1, 0.2, 0.7), atol=0.01)
    assert np.isclose(found["cryptoobject00.g"][middle], 1, atol=0.01)
    assert found["cryptoobject00.r"][middle] != found["cryptoobject00.r"][1, 1]
    hashed = np.frombuffer(found["cryptoobject00.r"][middle].tobytes(), np.uint32)[0]
    assert hashed == crypto("Box")


def crypto(name):
    """The id of a name, as Cryptomatte has it: MurmurHash3, with an exponent that is a plain number's."""
    data, h = name.encode(), 0
    rotate = lambda x, r: ((x << r) | (x >> (32 - r))) & 0xFFFFFFFF
    mix = lambda k: rotate(k * 0xCC9E2D51 & 0xFFFFFFFF, 15) * 0x1B873593 & 0xFFFFFFFF
    whole = len(data) // 4 * 4
    for k in range(0, whole, 4):
        h = (rotate(h ^ mix(int.from_bytes(data[k : k + 4], "little")), 13) * 5 + 0xE6546B64) & 0xFFFFFFFF
    if data[whole:]:
        h ^= mix(int.from_bytes(data[whole:], "little"))
    h ^= len(data)
    for shift, factor in ((16, 0x85EBCA6B), (13, 0xC2B2AE35)):
        h = (h ^ h >> shift) * factor & 0xFFFFFFFF
    h ^= h >> 16
    exponent = h >> 23 & 255
    return h ^ (1 << 23) if exponent in (0, 255) else h


def test_light_groups_sum_to_the_picture():
    lit_plane()
    layer = bpy.context.view_layer
    for k, name in enumerate(("key", "fill")):
        bpy.ops.scene.view_layer_add_lightgroup(name=name)
        common.lamp("POINT", 100 * (k + 1), (k - 0.5, 0, 4), shadow_soft_size=0.0).lightgroup = name
    assert [group.name for group in layer.lightgroups] == ["key", "fill"]
    image = passes_of()
    found = {name.removeprefix("ViewLayer."): image[name] for name in image.channels}
    key, fill, whole = (found[f"{name}.R"].mean() for name in ("Combined_key", "Combined_fill", "Combined"))
    assert np.isclose(key + fill, whole, rtol=1e-3) and np.isclose(fill / key, 2, rtol=0.02)


def test_a_transparent_film_has_coverage():
    current = common.empty((32, 18))
    common.world((1, 1, 1), 1.0)
    common.shape("uv_sphere", common.matte("Grey", (0.5, 0.5, 0.5)))
    common.camera((0, -6, 0), (0, 0, 0))
    current.render.film_transparent = True
    current.render.image_settings.color_mode = "RGBA"
    image = rendered("STERADIAN", 8, channels="RGBA")
    assert image[9, 16, 3] == 1 and image[0, 0, 3] == 0 and image[0, 0, :3].max() == 0
    assert np.isclose(image[9, 16, 0], 0.5, rtol=0.05)


def test_what_moves_is_blurred_as_in_cycles():
    import motion

    current = motion.build()
    current.render.resolution_x, current.render.resolution_y = 64, 36
    found, _ = exported(frame_set=lambda frame, part: current.frame_set(frame, subframe=part))
    assert sum("to_world_end" in row for row in found.description["instances"]) == 2
    assert "to_world_end" in found.camera
    assert current.frame_current == 5 and current.frame_subframe == 0
    a, b = rendered("STERADIAN", 32), rendered("CYCLES", 32)
    assert np.isclose(a.mean(), b.mean(), rtol=0.01)
    blocks = [
        np.array([[part.mean() for part in np.array_split(row, 8, axis=1)] for row in np.array_split(p, 6, axis=0)])
        for p in (a, b)
    ]
    assert np.allclose(*blocks, rtol=0.06)


def test_a_mesh_that_is_deformed_while_it_is_blurred_is_told():
    current = common.empty()
    thing = common.shape("cube")
    thing.modifiers.new("Bend", "ARMATURE")
    common.camera((0, -5, 0), (0, 0, 0))
    current.render.use_motion_blur = True
    _, lines = exported(frame_set=lambda frame, part: current.frame_set(frame, subframe=part))
    assert len([line for line in lines if line.startswith("Cube: moves as a whole")]) == 1


def test_the_operator_writes_a_scene_that_the_renderer_reads(tmp_path):
    lit_plane()
    common.lamp("POINT", 300, (0.5, 0.5, 5), shadow_soft_size=0.0)
    path = tmp_path / "plane.steradian"
    assert bpy.ops.steradian.open(filepath=str(path), show=False) == {"FINISHED"}
    image = steradian.load(path).render(spp=4, integrator="path")
    assert image.shape == (24, 24, 3) and np.asarray(image)[..., :3].mean() > 0.05


def test_a_material_override_counts():
    lit_plane()
    common.lamp("POINT", 300, (0.5, 0.5, 5), shadow_soft_size=0.0)
    bpy.context.view_layer.material_override = common.matte("Black", (0, 0, 0))
    assert rendered("STERADIAN", 2).max() == 0


def test_panels_come_and_go_with_the_extension():
    named = {panel.__name__: panel for panel in bpy.types.Panel.__subclasses__()}
    shown = {name for name, panel in named.items() if "STERADIAN" in getattr(panel, "COMPAT_ENGINES", ())}
    assert {
        "DATA_PT_lens",
        "RENDER_PT_format",
        "WORLD_PT_context_world",
        "VIEWLAYER_PT_layer_passes",
        "DATA_PT_camera_dof",
    } <= shown
    assert "DATA_PT_light" not in shown and hasattr(bpy.types, "STERADIAN_PT_sampling")
    ADDON.unregister()
    try:
        assert not [name for name, panel in named.items() if "STERADIAN" in getattr(panel, "COMPAT_ENGINES", ())]
        assert not hasattr(bpy.types.Scene, "steradian") and not hasattr(bpy.types, "STERADIAN_PT_sampling")
    finally:
        ADDON.register()


class Fake:
    """An engine without Blender's window, which is cancelled after a number of questions."""

    is_preview = False
    _steps = engine.SteradianEngine._steps

    def __init__(self, after):
        self.after, self.asked = after, 0

    def test_break(self):
        self.asked += 1
        return self.asked > self.after

    def update_progress(self, part):
        pass

    def update_stats(self, who, text):
        pass


def test_a_cancelled_render_ends_with_what_it_has(tmp_path):
    compiled = steradian.load("builtin:cornell-box")
    shown = []
    options = {"spp": 1 << 16, "size": (32, 32), "transparent": False, "layers": []}
    Fake(3)._steps(compiled, options, shown.append, str(tmp_path / "state"))
    assert all(image.spp < 1 << 16 for image in shown)


def test_steps_show_pictures_early_and_end_with_the_bits_of_one_render(tmp_path):
    compiled = steradian.load("builtin:cornell-box")
    shown = []
    options = {"spp": 64, "size": (16, 16), "transparent": False, "layers": [], "integrator": "path"}
    Fake(1 << 40)._steps(compiled, options, shown.append, str(tmp_path / "state"))
    assert [image.spp for image in shown] == [1, 4, 16, 64]
    errors = [np.abs(np.asarray(image) - np.asarray(shown[-1])).mean() for image in shown]
    assert errors[0] > errors[1] > errors[2] > errors[3] == 0


def test_a_scene_without_a_camera_is_told():
    common.empty((8, 8))
    with pytest.raises(RuntimeError, match="camera"):
        rendered("STERADIAN", 1)


def test_the_viewport_follows_edits_without_making_the_scene_anew():
    current = lit_plane()
    ball = common.shape("uv_sphere", common.matte("Ball", (0.2, 0.2, 0.2)), smooth=True, location=(0, 0, 1))
    thing = common.lamp("POINT", 300, (0.5, 0.5, 5), shadow_soft_size=0.0)
    # All that there are, so that it does not matter how far the thread is.
    current.steradian.preview_samples = 16
    session = viewport.Session()
    follow = lambda _, depsgraph: session.update(depsgraph)
    bpy.app.handlers.depsgraph_update_post.append(follow)
    try:
        depsgraph = bpy.context.evaluated_depsgraph_get()
        session.update(depsgraph)

        def look():
            window = current.camera.calc_matrix_camera(depsgraph, x=32, y=32)
            session.camera(current.camera.matrix_world.inverted(), window, (32, 32))

        def mean():
            bpy.context.view_layer.update()
            found = session.wait(16)
            assert session.error is None and found is not None and found[0].shape == (32, 32, 4)
            return found[0][..., :3].mean(), found[0]

        look()
        before, first = mean()
        thing.data.energy = 600
        brighter, _ = mean()
        assert np.isclose(brighter, 2 * before, rtol=1e-3)
        ball.location.x = 2
        _, moved = mean()
        assert np.abs(moved - 2 * first).mean() > 0.01
        current.camera.location.z = 7
        bpy.context.view_layer.update()
        look()
        mean()
        assert session.made == 1
        for vertex in ball.data.vertices:
            vertex.co *= 0.5
        ball.data.update()
        smaller, _ = mean()
        assert session.made == 1 and session.edited > 3
        common.shape("cube", common.matte("Black", (0, 0, 0)), size=3, location=(-1, 0, 0))
        darker, _ = mean()
        assert session.made > 1 and darker < 0.9 * smaller
        current.steradian.preview_denoise = True
        thing.data.energy = 500
        _, smooth = mean()
        current.steradian.preview_denoise = False
        thing.data.energy = 501
        _, noisy = mean()
        roughness = [np.abs(np.diff(p[2:8, :, 0], axis=1)).mean() for p in (smooth, noisy)]
        assert roughness[0] <= roughness[1]
        assert session.count > 10
    finally:
        bpy.app.handlers.depsgraph_update_post.remove(follow)
        session.close()


def test_sums_are_those_of_one_render_of_all_samples():
    compiled = steradian.load("builtin:cornell-box")
    parts = [
        compiled.render(
            spp=n, size=(24, 24), seed=n, layers=["variance", "depth"], integrator="path:reuse=1,effort=even"
        )
        for n in (16, 48)
    ]
    sums = viewport.Sums()
    for part, n in zip(parts, (16, 48)):
        sums.add(part, n)
    whole = compiled.render(spp=64, size=(24, 24), seed=9, layers=["variance"], integrator="path:reuse=1,effort=even")
    found = sums.image()
    assert np.isclose(found["R"].mean(), (parts[0]["R"].mean() + 3 * parts[1]["R"].mean()) / 4, rtol=1e-5)
    assert np.isclose(found["variance.G"].mean(), whole["variance.G"].mean(), rtol=0.3)
