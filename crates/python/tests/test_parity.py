"""What the command line does, too: with the same bits."""

import json
import os
import warnings

import numpy as np
import pytest

import steradian as st
from command_line import ROOT, rendered, run

BOX = "builtin:cornell-box"
WINDMILL = os.path.join(ROOT, "scenes", "windmill.gltf")


def assert_same(picture, other):
    """Both have the same planes, to the bit."""
    assert sorted(picture.channels) == sorted(other.channels)
    for name in picture.channels:
        assert np.array_equal(picture[name], other[name], equal_nan=True), name


@pytest.mark.parametrize(("asked", "word"), [(True, "nlm"), ("nlm", "nlm"), ("atrous", "atrous")])
def test_pictures_are_denoised(tmp_path, asked, word):
    image = st.load(BOX).render(spp=4, size=(24, 20), aov=["ids"], denoise=asked)
    assert_same(image, rendered(tmp_path / "a.exr", BOX, "--spp", 4, "--size", "24x20", "--aov", "ids", f"--denoise={word}"))
    assert "raw" in image.layers and not np.array_equal(image["R"], image["raw.R"])
    noisy = rendered(tmp_path / "b.exr", BOX, "--spp", 4, "--size", "24x20", "--aov", "albedo,normal,depth,variance")
    run("denoise", tmp_path / "b.exr", f"--with={word}", "-o", tmp_path / "c.exr")
    assert_same(noisy.denoise(word), st.read_image(tmp_path / "c.exr"))


def test_denoising_takes_a_strength_and_halves(tmp_path):
    scene = st.load(BOX)
    one, other = (scene.render(spp=4, size=(24, 20), seed=seed, layers=["albedo", "normal", "depth", "variance"]) for seed in (1, 2))
    one.save(tmp_path / "one.exr")
    other.save(tmp_path / "other.exr")
    run("denoise", tmp_path / "one.exr", "--half", tmp_path / "other.exr", "--strength", 2, "-o", tmp_path / "out.exr")
    assert_same(one.denoise(half=other, strength=2), st.read_image(tmp_path / "out.exr"))
    with pytest.raises(ValueError, match="half and strength are of the denoiser nlm"):
        one.denoise("atrous", strength=2)
    with pytest.warns(UserWarning, match="layers albedo, normal, depth, variance are missing"):
        scene.render(spp=2, size=(8, 8)).denoise()
    with pytest.raises(ValueError, match="there is no denoiser 'nml'; known are nlm, atrous, oidn"):
        scene.render(spp=1, denoise="nml")


def test_open_image_denoise_is_looked_for_before_the_render(monkeypatch, tmp_path):
    monkeypatch.setenv("STERADIAN_OIDN", str(tmp_path))
    seen = []
    with pytest.raises(ValueError, match="libOpenImageDenoise.so.2.*pip install"):
        st.load(BOX).render(spp=1, denoise="oidn", progress=seen.append)
    assert not seen


def test_layers_have_two_names():
    scene = st.load(BOX)
    assert_same(scene.render(spp=1, size=(8, 8), aov=["albedo"]), scene.render(spp=1, size=(8, 8), layers=["albedo"]))
    with pytest.raises(ValueError, match="two names of one setting"):
        scene.render(spp=1, aov=["albedo"], layers=["albedo"])


def test_cameras_are_moved(tmp_path):
    scene = st.load(BOX)
    plain = np.asarray(scene.render(spp=2, size=(16, 16)))
    at = st.look_at((278, 300, -500), np.array([250, 200, 280]), up=(0.1, 1, 0))
    moved = scene.render(spp=2, size=(16, 16), camera=at)
    assert_same(moved, rendered(tmp_path / "a.exr", BOX, "--spp", 2, "--size", "16x16", "--look-at", "278,300,-500,250,200,280,0.1,1,0"))
    # The scene itself stays as it is.
    assert np.array_equal(np.asarray(scene.render(spp=2, size=(16, 16))), plain) and not np.array_equal(np.asarray(moved), plain)
    own = scene[scene.cameras[0]]
    narrow = scene.render(spp=2, size=(16, 16), camera=st.look_at(at.origin, at.target, at.up, fov=20))
    own["fov"] = 20
    assert_same(narrow, scene.render(spp=2, size=(16, 16), camera=at))
    for wrong, said in [
        (dict(target=at.origin), "target apart from the origin"), (dict(up=(0, 0, 0)), "up that is not along"),
        (dict(fov=180), "fov is an angle above 0 and below 180"),
    ]:
        with pytest.raises(ValueError, match=said):
            scene.render(spp=1, camera=st.look_at(**{"origin": at.origin, "target": at.target, **wrong}))
    with pytest.raises(ValueError, match=r"origin has the shape \(2,\)"):
        st.look_at((0, 1), (0, 0, 0))
    with pytest.raises(ValueError, match="no camera that look_at could move"):
        st.scene({"shapes": [{"shape": "sphere"}]}).render(camera=at)


def test_integrators_have_the_colours_that_suit_them(tmp_path):
    path = os.path.join(ROOT, "scenes", "shading.pbrt")
    image = st.load(path).render(size=(20, 16), integrator="raster")
    assert_same(image, rendered(tmp_path / "a.exr", path, "--size", "20x16", "--integrator", "raster"))


@pytest.mark.parametrize("adaptive", [False, True])
def test_renders_go_on_from_files(tmp_path, adaptive):
    scene, state = st.load(BOX), tmp_path / "a.state"
    settings = dict(size=(16, 12), layers=["albedo"], adaptive=adaptive)
    words = [BOX, "--size", "16x12", "--aov", "albedo", *(["--adaptive"] if adaptive else [])]
    whole = scene.render(spp=24, **settings)
    left = scene.render(spp=24, **settings, resume=state, progress=lambda p: p.spp < 1)
    assert left.stopped in ("progress", None) and state.exists()
    # The command line goes on from it, and what it leaves does so here.
    assert_same(rendered(tmp_path / "a.exr", *words, "--spp", 24, "--resume", state), whole)
    assert (tmp_path / "a.state.before").exists()
    again = scene.render(spp=24, **settings, resume=state)
    assert_same(again, whole)
    assert again.spp == whole.spp
    more = scene.render(spp=48, **settings, resume=state)
    assert more.spp > 1.9 * whole.spp
    # A damaged state: the one before it.
    state.write_bytes(state.read_bytes()[:-5])
    with pytest.warns(UserWarning, match="a.state is damaged; the state before it is taken"):
        assert_same(scene.render(spp=48, **settings, resume=state), more)
    with pytest.raises(ValueError, match="saved with other settings: seed"):
        scene.render(spp=48, seed=7, **settings, resume=state)
    scene["white"]["reflectance"] = 0.5
    with pytest.raises(ValueError, match="belongs to another scene"):
        scene.render(spp=48, **settings, resume=state)


def test_what_keeps_no_render_is_refused(tmp_path):
    scene = st.load(BOX)
    with pytest.raises(ValueError, match="not a regular file"):
        scene.render(spp=1, resume=tmp_path)
    with pytest.raises(ValueError, match="cannot go with client or frames"):
        scene.render(spp=1, resume=tmp_path / "a", frames=(0, 1))
    (tmp_path / "other").write_text("something else")
    with pytest.raises(ValueError, match="is no saved state"):
        scene.render(spp=1, resume=tmp_path / "other")
    scene.save(tmp_path / "box.steradian")
    read = st.load(tmp_path / "box.steradian")
    with pytest.raises(FileExistsError, match="box.steradian"):
        read.render(spp=1, size=(4, 4), resume=tmp_path / "box.steradian")


def test_frames_are_those_of_the_command_line(tmp_path):
    pictures = st.load(WINDMILL).render(spp=2, size=(20, 16), frames=range(3, 6), fps=12, layers=["motion"])
    run("render", WINDMILL, "--spp", 2, "--size", "20x16", "--frames", "3..5", "--fps", 12, "--aov", "motion", "-o", tmp_path / "a.exr")
    pictures = list(pictures)
    for number, picture in zip([3, 4, 5], pictures, strict=True):
        assert_same(picture, st.read_image(tmp_path / f"a.{number:04}.exr"))
    assert not np.array_equal(pictures[0]["R"], pictures[2]["R"])
    assert_same(pictures[0], next(st.load(WINDMILL).render(spp=2, size=(20, 16), frames=(3, 5), fps=12, layers=["motion"])))


def test_frames_that_cannot_be_are_refused_at_once():
    scene = st.load(WINDMILL)
    for wrong, said in [
        (dict(frames=range(0)), "frames are a range"), (dict(frames=(-1, 2)), "whole numbers from 0"),
        (dict(frames=(0, 2), fps=0), "fps is a number"), (dict(frames=(0, 1), integrator="pth"), "unknown integrator 'pth'"),
    ]:
        with pytest.raises(ValueError, match=said):
            scene.render(**wrong)
    with pytest.raises(ValueError, match="which are loaded from .gltf and .glb files"):
        st.load(BOX).render(frames=(0, 1))
    with pytest.raises(ValueError, match="a moment of its own"):
        st.load(WINDMILL, defines={"at": 1}).render(frames=(0, 1))
    with pytest.raises(ValueError, match="takes frames="):
        scene.render(spp=1, layers=["motion"])
    node = scene[next(name for name, (family, _) in scene.nodes.items() if family == "material" and scene[name])]
    parameter = next(iter(node))
    node[parameter] = node[parameter]
    with pytest.raises(ValueError, match="without the changes"):
        scene.render(frames=(0, 1))


def test_comparisons_have_the_figures_of_the_command_line(tmp_path):
    scene = st.load(BOX)
    one = scene.render(spp=4, size=(24, 20), seed=1, layers=["variance"])
    other = scene.render(spp=16, size=(24, 20), seed=2, layers=["variance"])
    large = scene.render(spp=4, size=(48, 40), seed=3)
    for name, image in [("one", one), ("other", other), ("large", large)]:
        image.save(tmp_path / f"{name}.exr")

    def said(a, b):
        [pair] = json.loads(run("compare", tmp_path / a, tmp_path / b, "--json"))["pairs"]
        return pair

    found, expected = st.compare(one, other), said("one.exr", "other.exr")
    assert expected["z_test"]["samples"] == 4 and found["z_test"] == expected["z_test"]
    for key in set(expected) - {"picture", "reference", "width", "height"}:
        assert found[key] == expected[key], key
    assert found["rel_mse"] == found["relmse"] and 0 < found["flip"] < 1 and 0 < found["ssim"] < 1
    with pytest.warns(UserWarning, match="the reference has 48 x 40 pixels, and is resampled by area to 24 x 20"):
        found = st.compare(one, large)
    expected = said("one.exr", "large.exr")
    assert found["resampled_from"] == (48, 40) and found["mse"] == expected["mse"] and found["flip"] == expected["flip"]
    assert found["z_test"] is None and found["no_z_test"] == "'the reference' has no layer 'variance'"
    assert st.compare(large, large)["no_z_test"] is None
    with pytest.raises(ValueError):
        st.compare(one, scene.render(spp=1, size=(24, 10)))


def lit(lamp, sky):
    """A ball under two groups of lights."""
    return st.scene({
        "materials": {"clay": {"material": "diffuse", "reflectance": 0.5}},
        "camera": {"camera": "perspective", "fov": 40.0, "to_world": {"look_at": [0, 0, 0], "from": [0, 0, -4]}},
        "lights": {
            "lamp": {"light": "point", "position": [2, 3, -3], "intensity": lamp},
            "sky.blue": {"light": "environment", "radiance": sky},
        },
        "shapes": [{"shape": "sphere", "radius": 1.0, "material": "clay"}],
    })


def test_groups_of_lights_are_mixed():
    settings = dict(spp=16, size=(16, 16), color="rgb", layers=["light_groups", "albedo", "variance"])
    image = lit((10, 10, 10), (1, 1, 1)).render(**settings)
    mixed = image.mix({"lamp": 2, "sky.blue": (1, 0.5, 0)})
    assert np.array_equal(mixed["RGBA_lamp.G"], 2 * image["RGBA_lamp.G"])
    assert np.array_equal(mixed["G"], mixed["RGBA_lamp.G"] + mixed["RGBA_sky_blue.G"])
    assert np.array_equal(mixed["B"], 2 * image["RGBA_lamp.B"]) and (mixed["RGBA_sky_blue.B"] == 0).all()
    # As many lights so strong give that picture, but for noise.
    other = lit((20, 20, 20), (1, 0.5, 0)).render(**{**settings, "spp": 64})
    assert np.allclose(np.asarray(mixed).mean((0, 1)), np.asarray(other).mean((0, 1)), rtol=0.02)
    assert np.allclose(np.asarray(image.mix({})), np.asarray(image), rtol=1e-5, atol=1e-6)
    assert mixed.layers == ["", "RGBA_lamp", "RGBA_sky_blue", "albedo"] and np.array_equal(mixed["albedo.R"], image["albedo.R"])
    image["RGBA_lamp.R"][:] = np.inf
    assert np.isfinite(np.asarray(image.mix({"lamp": 0}))).all()
    for weights, said in [
        ({"lmap": 1}, "no group of lights 'lmap'; did you mean 'lamp'.*known: lamp, sky_blue"),
        ({"lamp": -1}, "a number of 0 or more"), ({"lamp": float("nan")}, "a number of 0 or more"),
    ]:
        with pytest.raises(ValueError, match=said):
            image.mix(weights)
    with pytest.raises(TypeError):
        image.mix({"lamp": "bright"})
    with pytest.raises(ValueError, match="no groups of lights: render it with"):
        lit(1, 1).render(spp=1, size=(4, 4)).mix({"lamp": 1})


def test_names_of_nodes_are_the_same_in_each_load(tmp_path):
    text = "\n".join([
        'Camera "perspective"', "WorldBegin", 'LightSource "infinite"', 'Material "diffuse" "rgb reflectance" [0.5 0.4 0.3]', 'Shape "sphere"',
        *(f'AttributeBegin\nMaterial "conductor" "float roughness" {k / 64}\nTranslate {k} 0 0\nShape "sphere"\nAttributeEnd' for k in range(40)),
    ])
    (tmp_path / "unnamed.pbrt").write_text(text)
    for path in [tmp_path / "unnamed.pbrt", WINDMILL, *(os.path.join(ROOT, "scenes", f"showcase.{kind}") for kind in ("pbrt", "xml"))]:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", st.SceneWarning)
            first, *others = (st.load(path) for _ in range(4))
        assert len(set(first)) == len(first.nodes) > 3
        for other in others:
            assert list(other.nodes.items()) == list(first.nodes.items())
            assert all(dict(other[name]) == dict(first[name]) for name in first)
    unnamed = st.load(tmp_path / "unnamed.pbrt")
    assert sum(name.startswith("#") for name in unnamed) > 40
