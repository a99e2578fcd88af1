"""Lamps, worlds and their units, by the light on a plane in Cycles."""

import common
import numpy as np
import pytest
from blend import both, exported, lit_plane

LAMPS = {
    "point": ("POINT", 300, {"shadow_soft_size": 0.0}),
    "ball": ("POINT", 300, {"shadow_soft_size": 0.5, "use_soft_falloff": False}),
    "ball by its area": ("POINT", 100, {"shadow_soft_size": 0.5, "use_soft_falloff": False, "normalize": False}),
    "warm": (
        "POINT",
        300,
        {"shadow_soft_size": 0.0, "use_temperature": True, "temperature": 3000.0, "color": (1.0, 0.8, 0.6)},
    ),
    "spot": ("SPOT", 300, {"shadow_soft_size": 0.0, "spot_size": 1.2, "spot_blend": 0.5}),
    "sharp spot": ("SPOT", 300, {"shadow_soft_size": 0.0, "spot_size": 1.0, "spot_blend": 0.0}),
    "sun": ("SUN", 3, {"angle": 0.0}),
    "wide sun": ("SUN", 3, {"angle": 0.6}),
    "square": ("AREA", 300, {"size": 1.0, "exposure": 1.0}),
    "rectangle": ("AREA", 300, {"shape": "RECTANGLE", "size": 1.0, "size_y": 2.0}),
    "disc": ("AREA", 300, {"shape": "DISK", "size": 1.0}),
    "ellipse": ("AREA", 30, {"shape": "ELLIPSE", "size": 1.0, "size_y": 2.0, "normalize": False}),
}


@pytest.mark.parametrize("name", LAMPS)
def test_a_lamp_lights_a_plane_as_in_cycles(name):
    kind, energy, values = LAMPS[name]
    lit_plane()
    common.lamp(kind, energy, (0.5, 0.5, 3), (20, 10, 0), **values)
    a, b = both(32, 64)
    assert b.mean() > 0.02
    assert np.allclose(a.mean((0, 1)), b.mean((0, 1)), rtol=0.01)
    halves = [[part.mean() for part in np.array_split(picture, 2, axis=axis)] for picture in (a, b) for axis in (0, 1)]
    assert np.allclose(halves[:2], halves[2:], rtol=0.02, atol=0.005 * b.mean())


def test_a_spot_with_a_radius_has_soft_shadows():
    lit_plane((32, 32))
    common.shape("plane", common.matte("Black", (0, 0, 0)), size=1.2, location=(0.3, 0.3, 1.5))
    common.lamp("SPOT", 300, (0.5, 0.5, 4), (10, 5, 0), shadow_soft_size=0.4, spot_size=1.2, spot_blend=0.3)
    a, b = both(64)
    assert np.isclose(a.mean(), b.mean(), rtol=0.02)
    assert np.abs(a - b).mean() < 0.06 * b.mean()


def test_the_scale_of_an_area_lamp_counts():
    lit_plane()
    common.lamp("AREA", 300, (0.5, 0.5, 3), (20, 10, 0), shape="RECTANGLE", size=1.0, size_y=2.0).scale = (2, 1, 1)
    a, b = both(32, 64)
    assert np.isclose(a.mean(), b.mean(), rtol=0.01)


def test_nodes_of_a_lamp_colour_it():
    lit_plane()
    thing = common.lamp("POINT", 300, (0.5, 0.5, 3), shadow_soft_size=0.0)
    thing.data.use_nodes = True
    nodes = thing.data.node_tree.nodes
    emission = next((n for n in nodes if n.type == "EMISSION"), None) or nodes.new("ShaderNodeEmission")
    emission.inputs["Color"].default_value, emission.inputs["Strength"].default_value = (1.0, 0.25, 0.5, 1.0), 2.0
    a, b = both(16)
    assert np.allclose(a.mean((0, 1)), b.mean((0, 1)), rtol=0.01)


def test_lamps_are_not_seen_and_do_not_block():
    current = lit_plane()
    common.world((0.2, 0.3, 0.4), 1.0)
    current.camera.location.z, current.camera.data.lens = 12, 20
    common.lamp("POINT", 300, (0.5, 0.5, 3), shadow_soft_size=0.6, use_soft_falloff=False)
    common.lamp("AREA", 100, (-1.5, -1, 2), (180, 0, 0), size=1.5)
    found, _ = exported()
    assert sorted(found.seen_lamps) == ["Area", "Point"] and found.hides_lamps and found.background is not None
    a, b = both(64)
    assert np.abs(a - b).mean() < 0.02 * b.mean() + 0.01


def test_a_lamp_beside_the_view_needs_no_hiding():
    current = lit_plane()
    common.world((0.2, 0.3, 0.4), 1.0)
    common.lamp("POINT", 300, (9, 0.5, 3), shadow_soft_size=0.6)
    found, lines = exported()
    assert found.seen_lamps == [] and found.background is None and any("soft falloff" in line for line in lines)
    assert current is not None


def test_a_picture_is_found_behind_other_nodes_which_are_told():
    common.empty((8, 8))
    made = common.world(picture="studio")
    nodes, links = made.node_tree.nodes, made.node_tree.links
    picture = next(n for n in nodes if n.type == "TEX_ENVIRONMENT")
    background = next(n for n in nodes if n.type == "BACKGROUND")
    invert = nodes.new("ShaderNodeInvert")
    links.new(picture.outputs["Color"], invert.inputs["Color"])
    links.new(invert.outputs["Color"], background.inputs["Color"])
    found, lines = exported()
    (light,) = found.description["lights"].values()
    assert light["file"]["file"].endswith("studio.exr") and any("left out" in line for line in lines)


def sky(kind):
    """The world's sky texture."""
    nodes = common.world(strength=0.1).node_tree.nodes
    node = nodes.new("ShaderNodeTexSky")
    node.sky_type = kind
    background = next(n for n in nodes if n.type == "BACKGROUND")
    background.id_data.links.new(node.outputs[0], background.inputs["Color"])
    if kind.endswith("SCATTERING"):
        node.sun_elevation, node.sun_rotation = 0.5, 1.0
    else:
        node.sun_direction = (0.6, 0.3, 0.5)


@pytest.mark.parametrize("kind", ["SINGLE_SCATTERING", "MULTIPLE_SCATTERING", "PREETHAM", "HOSEK_WILKIE"])
def test_skies_light_a_plane_nearly_as_in_cycles(kind):
    lit_plane()
    sky(kind)
    a, b = both(32)
    assert np.allclose(a.mean((0, 1)), b.mean((0, 1)), rtol=0.15)


def test_the_sun_of_a_sky_stands_as_in_cycles():
    common.empty((24, 24))
    sky("SINGLE_SCATTERING")
    common.shape("uv_sphere", common.matte("Grey", (0.5, 0.5, 0.5)), smooth=True)
    common.camera((0, 0, 6), (0, 0.001, 0), 60)
    a, b = both(32)
    slopes = [
        [np.diff([part.mean() for part in np.array_split(p, 2, axis=axis)])[0] / p.mean() for axis in (0, 1)]
        for p in (a, b)
    ]
    assert np.allclose(*slopes, atol=0.1) and np.abs(slopes).min() > 0.1


@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (0.5, 0.3, 1.0)])
def test_a_picture_around_stands_as_in_cycles(turn):
    import bpy

    current = common.empty((48, 27))
    made = common.world(strength=1.5, picture="sunset")
    nodes, links = made.node_tree.nodes, made.node_tree.links
    mapping, coordinates = nodes.new("ShaderNodeMapping"), nodes.new("ShaderNodeTexCoord")
    mapping.inputs["Rotation"].default_value = turn
    picture = next(n for n in nodes if n.type == "TEX_ENVIRONMENT")
    links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    links.new(mapping.outputs[0], picture.inputs["Vector"])
    common.shape("uv_sphere", common.matte("Grey", (0.5, 0.5, 0.5)), smooth=True)
    common.camera((1, -5, 1), (0, 0, 0), 25)
    a, b = both(32)
    assert np.allclose(a.mean((0, 1)), b.mean((0, 1)), rtol=0.01)
    blocks = [
        np.array([[part.mean() for part in np.array_split(row, 6, axis=1)] for row in np.array_split(p, 3, axis=0)])
        for p in (a, b)
    ]
    assert np.allclose(*blocks, rtol=0.05, atol=0.02 * b.mean())
    assert bpy.context.scene is current
