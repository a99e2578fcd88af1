"""Camera rays at what pictures show, samples of lights at closed forms, and meters at the command line's numbers."""

import json
import warnings

import numpy as np
import pytest

import steradian as st
from command_line import run
from scenes import BALL

BOX = "builtin:cornell-box"
FLOOR = {
    "film": {"film": "rgb", "width": 16, "height": 12},
    "camera": {"camera": "perspective", "to_world": {"look_at": [0, 0, 0], "from": [0, 0, 4]}},
    "materials": {"clay": {"material": "diffuse", "reflectance": 0.5}},
    "shapes": {"ball": {"shape": "sphere", "material": "clay"}},
}


def under(**lights):
    return st.scene({**FLOOR, "lights": lights})


def irradiance(scene, n=40000, point=(0, 0, 3), normal=(0, 0, 1), **given):
    """Mean of weight·cos, and what it may be off by."""
    drawn = scene.sample_emitter(point, np.random.default_rng(4).random((n, 3)), **given)
    values = drawn.weight * np.maximum(drawn.wi @ np.float32(normal), 0)[:, None]
    return values.mean(0), 4 * values.std(0) / np.sqrt(n) + 1e-4 * values.mean(0)


def test_camera_rays_meet_what_layers_show():
    scene = st.load(BOX)
    size = (24, 18)
    kernel = next(name for name, (family, _) in scene.nodes.items() if family == "pixel")
    scene[kernel].update(radius_x=0.5, radius_y=0.5)
    shown = scene.render(spp=1, size=size, integrator="raycast", layers=["position"]).layer("position")
    x, y = np.meshgrid(np.arange(size[0]) + 0.5, np.arange(size[1]) + 0.5)
    rays = scene.sample_ray(np.stack([x, y], -1), size=size)
    assert rays.origin.shape == (18, 24, 3) and (rays.weight == 1).all()
    assert np.allclose(np.linalg.norm(rays.direction, axis=-1), 1, atol=1e-5)
    # Samples of pixels lie within them: a ray through the middle of one is off by less than its size.
    off = shown - rays.origin
    along = off / np.linalg.norm(off, axis=-1, keepdims=True)
    pixel = np.linalg.norm(rays.direction[9, 13] - rays.direction[9, 12])
    there = np.abs(shown).sum(-1) > 0
    assert there.mean() > 0.5 and (np.linalg.norm(along - rays.direction, axis=-1)[there] < pixel).all()
    # The camera looks along +z from (0, 0, -3.5): the film positions of these points, and rays through them.
    corners = scene.sample_ray([[0, 0], size], size=size).direction
    first, last = corners[:, :2] / corners[:, 2:]
    film = (off[..., :2] / off[..., 2:] - first) / (last - first) * size
    assert (np.abs(film - np.stack([x, y], -1))[there] <= 0.5 + 1e-3).all()
    again = scene.sample_ray(film[there], size=size)
    hits = scene.trace(again.origin, again.direction)
    same = np.linalg.norm(hits.position - shown[there], axis=-1) < 1e-3
    assert same.mean() > 0.98, "all but edges"


def test_camera_rays_meet_in_the_plane_of_focus():
    front = {**BALL["cameras"]["front"], "lens_radius": 0.25, "focal_distance": 3.0}
    scene = st.scene({**BALL, "cameras": {"front": front}})
    u = np.random.default_rng(1).random((50, 2))
    rays = scene.sample_ray([5.25, 17.5], u_lens=u)
    assert np.allclose(rays.origin[:, 2], -4, atol=1e-5)
    radii = np.linalg.norm(rays.origin[:, :2], axis=-1)
    assert 0.2 < radii.max() <= 0.25 + 1e-5
    focus = rays.origin + rays.direction * (3 / rays.direction[:, 2:])
    middle = scene.sample_ray([5.25, 17.5])
    assert np.allclose(middle.origin, [0, 0, -4], atol=1e-5)
    assert np.allclose(focus, middle.origin + middle.direction * (3 / middle.direction[2]), atol=1e-4)
    cropped = st.scene({**BALL, "film": {**BALL["film"], "crop": [4, 20, 8, 24]}, "cameras": {"front": front}})
    assert np.array_equal(cropped.sample_ray([5.25, 17.5]).direction, middle.direction), "positions are of the whole picture"
    moved = scene.sample_ray([16, 12], camera=st.look_at([7, 0, 0], [0, 0, 0]))
    assert np.allclose(moved.origin, [7, 0, 0], atol=1e-5) and np.allclose(moved.direction, [-1, 0, 0], atol=1e-5)


def test_a_point_light_gives_its_inverse_square():
    scene = under(lamp={"light": "point", "position": [0, 3, 7], "intensity": (50, 25, 10)})
    drawn = scene.sample_emitter([[0, 0, 3], [0, 0, 9]], [0.3, 0.6, 0.9])
    assert np.allclose(drawn.distance, [5, np.sqrt(13)], rtol=1e-5) and drawn.delta.all() and (drawn.pdf == 1).all()
    assert np.allclose(drawn.wi[0], [0, 0.6, 0.8], atol=1e-6) and np.allclose(drawn.weight[0], np.array([50, 25, 10]) / 25, rtol=1e-4)
    assert drawn.light_name.tolist() == ["lamp", "lamp"] and "2 of 2" in repr(drawn)
    mean, _ = irradiance(scene, n=10)
    assert np.allclose(mean, np.array([50, 25, 10]) * 0.8 / 25, rtol=1e-4)
    behind = scene.sample_emitter([0, 0, 9], [0.3, 0.6, 0.9], normals=[0, 0, 1])
    assert behind.pdf == 0 and behind.light_name == "" and (behind.weight == 0).all()


@pytest.mark.parametrize("normals", [None, (0, 0, 2)])
def test_a_sky_gives_pi(normals):
    mean, allowed = irradiance(under(sky={"light": "environment", "radiance": 1.0}), normals=normals)
    assert (np.abs(mean - np.pi) < allowed + 1e-3).all(), (mean, allowed)


@pytest.mark.parametrize("normals", [None, (0, 0, 1)])
def test_lights_and_the_sky_add_up(normals):
    scene = under(
        sky={"light": "environment", "radiance": (0.5, 1.0, 2.0)},
        lamp={"light": "point", "position": [0, 3, 7], "intensity": 50.0},
        sun={"light": "distant", "direction": [0, 0, -1], "radiance": 2.0},
    )
    mean, allowed = irradiance(scene, normals=normals)
    assert (np.abs(mean - (np.pi * np.array([0.5, 1, 2]) + 50 * 0.8 / 25 + 2)) < allowed + 1e-3).all(), (mean, allowed)
    drawn = scene.sample_emitter([0, 0, 3], np.random.default_rng(1).random((500, 3)))
    assert set(drawn.light_name) == {"sky", "lamp", "sun"}
    assert np.isinf(drawn.distance[drawn.light_name == "sun"]).all() and not drawn.delta[drawn.light_name == "sky"].any()


def test_a_picture_as_the_sky_gives_what_a_meter_reads(tmp_path):
    """Its samples are drawn above the mean; the rest has samples as well."""
    pixels = np.full((16, 32), 0.3, np.float32)
    pixels[4:6, 8:12] = 40
    st.Image({"R": pixels, "G": pixels / 2, "B": pixels / 4}).save(tmp_path / "sky.exr")
    scene = under(sky={"light": "environment", "file": {"file": str(tmp_path / "sky.exr")}})
    mean, allowed = irradiance(scene, n=200000, normal=(0, 1, 0), point=(0, 3, 0))
    read = scene.meter([0, 3, 0], normals=[0, 1, 0], spp=1 << 18)
    assert mean.min() > 1 and (np.abs(mean - read.rgb) < allowed + 2 * read.rgb_error).all(), (mean, allowed, read.rgb, read.rgb_error)


def test_a_ball_that_shines_gives_what_its_solid_angle_says():
    lamp = {"shape": "sphere", "radius": 0.5, "emission": {"light": "area", "radiance": (4.0, 2.0, 1.0)}, "to_world": {"translate": [0, 1.2, 4.6]}}
    scene = st.scene({**FLOOR, "shapes": {**FLOOR["shapes"], "lamp": lamp}})
    for normals in (None, [0, 0, 1]):
        mean, allowed = irradiance(scene, n=5000, normals=normals)
        # E = π L (R/d)² cosθ of a ball that is wholly above the plane.
        assert (np.abs(mean - np.pi * np.array([4, 2, 1]) * 0.25 / 4 * 0.8) < allowed).all(), (mean, allowed)
    drawn = scene.sample_emitter([0, 0, 3], np.random.default_rng(3).random((100, 3)))
    on = np.array([0, 0, 3]) + drawn.wi * drawn.distance[:, None]
    assert np.allclose(np.linalg.norm(on - [0, 1.2, 4.6], axis=-1), 0.5, atol=1e-3) and set(drawn.light_name) == {"lamp"}
    assert not scene.occluded([0, 0, 3], drawn.wi, 0.999 * drawn.distance).any()
    assert scene.occluded([0, 0, 3], drawn.wi, 1.001 * drawn.distance + 1e-2).all()


def test_the_lamp_of_the_box_is_what_a_meter_reads():
    scene = st.load(BOX)
    floor, up = np.array([0.0, -0.5, 0.0]), [0.0, 1.0, 0.0]
    u = np.random.default_rng(2).random((100, 3))
    drawn = scene.sample_emitter(floor, u, normals=up)
    opened = ~scene.occluded(floor, drawn.wi, 0.999 * drawn.distance)
    values = drawn.weight * (drawn.wi[:, 1] * opened)[:, None]
    read = scene.meter(floor, normals=up, max_depth=0)
    allowed = 4 * values.std(0) / np.sqrt(len(u)) + 2 * read.rgb_error
    assert read.quantity == "irradiance" and values.mean() > 0.1
    assert (np.abs(values.mean(0) - read.rgb) < allowed + 1e-3 * read.rgb).all(), (values.mean(0), read.rgb)


POINTS = np.array([[-0.8, -0.5, -0.8], [0, -0.5, 0], [0.5, 0.3, -0.125]])


@pytest.mark.parametrize("given", [
    {}, {"normals": [0, 1, 0]}, {"directions": [0, 0.5, 1]}, {"flux": 0.25}, {"normals": [0, 1, 0], "flux": 0.25},
])
@pytest.mark.parametrize("color", ["rgb", "spectral"])
def test_meters_have_the_numbers_of_the_command_line(tmp_path, given, color):
    table = tmp_path / "points.csv"
    np.savetxt(table, POINTS, delimiter=",")
    words = [f"--{name.rstrip('s')}={','.join(map(str, np.atleast_1d(value)))}" for name, value in given.items() if name != "flux"]
    words += [f"--flux={given['flux']}"] if "flux" in given else []
    said = run("meter", BOX, "--points", table, *words, "--spp", 512, "--seed", 3, "--max-depth", 4, "--color", color, "--json")
    found = st.load(BOX).meter(POINTS, **given, spp=512, seed=3, max_depth=4, color=color)
    rows = [json.loads(line) for line in said.splitlines()]
    assert len(rows) == 3 and {row["quantity"] for row in rows} == {found.quantity}
    assert found.rgb.tolist() == [[c["value"] for c in row["rgb"]] for row in rows]
    assert found.rgb_error.tolist() == [[c["plus_minus"] for c in row["rgb"]] for row in rows]
    assert found.luminous.tolist() == [row["luminous"]["value"] for row in rows] and found.luminous.min() > 0
    assert found.luminous_error.tolist() == [row["luminous"]["plus_minus"] for row in rows]
    assert found.samples.tolist() == [row["samples"] for row in rows]
    if color == "rgb":
        assert found.radiant is None and found.radiant_error is None
    else:
        assert found.radiant.tolist() == [row["radiant"]["value"] for row in rows]
        assert found.radiant_error.tolist() == [row["radiant"]["plus_minus"] for row in rows]


def test_meters_take_the_defaults_of_the_command_line_and_grids():
    row = json.loads(run("meter", BOX, "--at", "0,-0.5,0", "--json"))
    scene = st.load(BOX)
    one = scene.meter([0, -0.5, 0])
    assert one.luminous.shape == () and one.luminous == row["luminous"]["value"] and one.samples == row["samples"]
    grid = scene.meter(np.zeros((2, 1, 3)), directions=[[0, 0, 1], [0, 1, 0], [0, 0, 1]], spp=64)
    assert grid.rgb.shape == (2, 3, 3) and np.array_equal(grid.luminous[:, 0], grid.luminous[:, 2])
    assert scene.meter(np.empty((0, 3))).luminous.shape == (0,)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        exact = scene.meter(POINTS, error=0.05, spp=64)
    assert (exact.luminous_error <= 0.05 * exact.luminous).all() and exact.samples.max() > 64


def test_what_makes_no_sense_is_refused():
    scene = st.load(BOX)
    for call, said in [
        (lambda: scene.sample_ray([0, 0, 0]), r"xy has the shape \(3,\), where \(…, 2\)"),
        (lambda: scene.sample_ray([0, np.nan]), "row 0 of xy is not finite"),
        (lambda: scene.sample_ray([[1, 1]] * 2, time=[0, 2]), "row 1 of time is not within 0 and 1"),
        (lambda: scene.sample_ray([1, 1], u_lens=[0.5, -1]), "row 0 of u_lens is not within 0 and 1"),
        (lambda: scene.sample_emitter([0, 0, 0], [0.5, 0.5]), r"u has the shape \(2,\)"),
        (lambda: scene.sample_emitter([0, 0, 0], [0.5, 0.5, 7]), "row 0 of u is not within 0 and 1"),
        (lambda: scene.sample_emitter([0, np.inf, 0], [0.5] * 3), "row 0 of points is not finite"),
        (lambda: scene.sample_emitter(np.zeros((2, 3)), np.zeros((5, 3))), "do not go together"),
        (lambda: scene.meter([0, 0]), r"points has the shape \(2,\)"),
        (lambda: scene.meter([0, 0, np.nan]), "row 0 of points is not finite"),
        (lambda: scene.meter([0, 0, 0], normals=[[0, 1, 0], [0, 0, 0]]), "row 1 of normals has no length"),
        (lambda: scene.meter([0, 0, 0], normals=[0, 1, 0], directions=[0, 1, 0]), "neither normals nor a flux"),
        (lambda: scene.meter([0, 0, 0], spp=0), "spp is a whole number above 0"),
        (lambda: scene.meter([0, 0, 0], error=-1), "error is a number above 0"),
        (lambda: scene.meter([0, 0, 0], flux=0), "flux is a number above 0"),
        (lambda: scene.meter([0, 0, 0], max_depth=-2), "max_depth is a whole number, -1 for no limit"),
        (lambda: scene.meter([0, 0, 0], integrator="sppm"), "the meter's integrator is path or volpath, not 'sppm'"),
    ]:
        with pytest.raises(ValueError, match=said):
            call()


def test_samples_need_no_camera_but_for_its_rays():
    scene = st.scene({"shapes": {"ball": {"shape": "sphere"}}, "lights": {"sky": {"light": "environment", "radiance": 1.0}}})
    assert scene.sample_emitter([0, 0, 3], [0.5, 0.5, 0.5]).pdf > 0
    assert scene.meter([0, 0, 3], directions=[0, 0, 1], spp=64).rgb == pytest.approx([1, 1, 1], rel=1e-3)
    with pytest.raises(st.SceneError, match="the scene has no camera"):
        scene.sample_ray([1, 1])
    dark = st.scene(FLOOR).sample_emitter([0, 0, 3], [0.5, 0.5, 0.5])
    assert dark.pdf == 0 and dark.light == 0
