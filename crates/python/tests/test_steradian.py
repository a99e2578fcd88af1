"""The package as its users see it."""

import os
import signal
import threading
import warnings

import numpy as np
import pytest

import steradian as st
from scenes import BALL

ROOT = os.path.join(os.path.dirname(__file__), "..", "..", "..")


def test_a_picture_is_arrays():
    img = st.load("builtin:cornell-box").render(spp=2, size=(40, 30), threads=2, layers=["albedo", "depth"])
    assert (img.width, img.height, img.shape) == (40, 30, (30, 40, 3))
    assert img["R"].shape == (30, 40) and img["R"].dtype == np.float32
    assert img.layer("albedo").shape == (30, 40, 3)
    assert img.layer("depth").shape == (30, 40, 1) and img.layer().shape == (30, 40, 3)
    assert img.layers[:2] == ["", "albedo"]
    assert np.asarray(img).shape == (30, 40, 3)
    assert np.array_equal(np.asarray(img)[..., 1], img["G"])
    assert img["R"] is img["R"], "a plane is not copied"
    assert img.stopped is None and img.spp == 2
    with pytest.raises(KeyError, match="there are R, G, B"):
        img["Q"]


def test_what_is_written_into_a_plane_is_saved(tmp_path):
    img = st.scene(BALL).render(spp=1)
    img["R"][:] = 0.25
    img.save(tmp_path / "a.pfm")
    data = (tmp_path / "a.pfm").read_bytes()
    values = np.frombuffer(data[-32 * 24 * 12 :], "<f4").reshape(24, 32, 3)
    assert (values[..., 0] == 0.25).all()
    assert np.allclose(values[::-1, :, 1], img["G"])


def test_files_are_saved_and_shown(tmp_path):
    img = st.scene(BALL).render(spp=1)
    for name in ["a.exr", "a.png"]:
        img.save(tmp_path / name)
        assert (tmp_path / name).stat().st_size > 0
    assert img._repr_png_()[:4] == b"\x89PNG"
    assert img.png(exposure=1) != img.png()
    with pytest.raises(ValueError, match="unknown|extension"):
        img.save(tmp_path / "a.what")


def test_same_bits_for_any_threads_and_for_the_text_of_a_scene(tmp_path):
    scene = st.scene(BALL)
    one = np.asarray(scene.render(spp=4, threads=1))
    assert np.array_equal(one, np.asarray(scene.render(spp=4, threads=3)))
    scene.save(tmp_path / "ball.steradian")
    again = st.load(tmp_path / "ball.steradian")
    assert again.text() == scene.text()
    assert np.array_equal(one, np.asarray(again.render(spp=4)))


def test_an_albedo_of_one_vanishes_under_a_white_sky():
    scene = st.scene(BALL)
    scene["clay"]["reflectance"] = 1.0
    img = np.asarray(scene.render(spp=64, integrator="path:max_depth=64"))
    assert abs(img.mean() - 1.0) < 1e-3


def test_parameters_are_read_edited_and_rendered_again():
    scene = st.scene(BALL)
    assert scene["clay"]["reflectance"] == {"rgb": [0.7, 0.3, 0.2]}
    assert scene.nodes["clay"] == ("material", "diffuse")
    before = np.asarray(scene.render(spp=4))
    scene["clay"]["reflectance"] = {"rgb": [0.0, 0.0, 0.0]}
    after = np.asarray(scene.render(spp=4))
    middle = np.s_[12, 16]
    assert before[middle].min() > 0.1 and after[middle].max() == 0
    del scene["clay"]["reflectance"]
    assert list(scene["clay"]) == []
    with pytest.raises(KeyError, match="did you mean 'clay'"):
        scene["clya"]
    with pytest.raises(st.SceneError, match="material 'diffuse' has no parameter 'reflectanse'.*\n.*did you mean 'reflectance'"):
        scene["clay"]["reflectanse"] = 0.3
    with pytest.raises(st.SceneError, match="no colour space"):
        scene["clay"]["reflectance"] = {"rgb": [1, 1, 1], "space": "srgbb"}


def test_array_values_and_nodes_in_place():
    scene = st.scene(BALL)
    scene["sky"]["radiance"] = {"rgb": np.array([1.0, 0.5, 0.25])}
    scene["clay"]["reflectance"] = {"texture": "checkerboard", "a": 0.9, "b": 0.1}
    img = scene.render(spp=2)
    corner = np.asarray(img)[0, 0]
    assert np.allclose(corner, [1.0, 0.5, 0.25], rtol=1e-3)


def test_errors_have_lines_and_carets(tmp_path):
    bad = tmp_path / "bad.pbrt"
    bad.write_text('WorldBegin\nMaterial "difuse"\nShape "sphere"\n')
    with pytest.raises(st.SceneError) as caught:
        st.load(bad)
    assert "bad.pbrt:2:10" in str(caught.value) and "^^^^^^^^" in str(caught.value)
    assert "did you mean 'diffuse'?" in str(caught.value)
    with pytest.raises(st.SceneError, match="cannot find"):
        st.load(tmp_path / "none.pbrt")
    with pytest.raises(ValueError, match="unknown integrator 'pth'"):
        st.scene(BALL).render(integrator="pth")


def test_a_misspelt_parameter_of_a_dictionary_is_told():
    scene = st.scene({**BALL, "lights": [{"light": "environment", "radiance": 1.0, "scael": 2.0}]})
    assert [m.kind for m in scene.messages] == ["unused"]
    assert "did you mean 'scale'?" in scene.messages[0].text


def test_progress_is_told_and_may_stop():
    seen = []
    st.scene(BALL).render(spp=8, progress=lambda p: seen.append(p.fraction))
    assert seen and all(0 <= f <= 1 for f in seen)
    img = st.scene(BALL).render(spp=1 << 20, progress=lambda p: p.spp < 2)
    assert img.stopped == "progress" and 1 <= img.spp < 1 << 20
    assert np.isfinite(np.asarray(img)).all()

    def fails(_):
        raise RuntimeError("from within")

    with pytest.raises(RuntimeError, match="from within"):
        st.scene(BALL).render(spp=1 << 20, progress=fails)


def test_ctrl_c_keeps_the_picture():
    def press(p):
        if p.spp >= 1:
            signal.raise_signal(signal.SIGINT)

    # What is started in the background ignores Ctrl-C.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        img = st.scene(BALL).render(spp=1 << 20, progress=press)
    finally:
        signal.signal(signal.SIGINT, before)
    assert img.stopped in ("interrupt", "progress") and img.spp >= 1


def test_other_threads_run_meanwhile():
    counted, done = [0], threading.Event()

    def count():
        while not done.is_set():
            counted[0] += 1

    thread = threading.Thread(target=count)
    thread.start()
    at_start = counted[0]
    st.scene(BALL).render(spp=1 << 20, progress=lambda p: counted[0] < at_start + 1000 or p.spp < 1)
    done.set()
    thread.join()
    assert counted[0] > at_start


def test_a_scene_may_be_used_while_it_is_rendered():
    scene, seen = st.scene(BALL), []

    def look(p):
        scene["clay"]["reflectance"] = {"rgb": [0.1, 0.2, 0.3]}
        seen.append((len(scene.cameras), repr(scene), scene.text()))
        return p.spp < 1

    assert scene.render(spp=1 << 20, progress=look).stopped == "progress" and seen
    assert "0.2" in str(scene["clay"]["reflectance"])


def test_threads_share_a_scene():
    scene, failed = st.scene(BALL), []
    expected = np.asarray(scene.render(spp=2, size=(24, 24)))

    def work(k):
        try:
            for n in range(5):
                scene["clay"]["reflectance"] = {"rgb": [0.7, 0.3, 0.2]}
                scene.material("clay")
                size = (24 + (k + n) % 2, 24)
                picture = np.asarray(scene.render(spp=2, size=size, threads=1))
                assert size != (24, 24) or np.array_equal(picture, expected)
        except BaseException as e:
            failed.append(e)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    [t.start() for t in threads]
    [t.join() for t in threads]
    assert not failed


def test_numbers_that_no_render_can_have_are_refused():
    scene = st.scene(BALL)
    for threads in [1025, 2**31, 2**63]:
        with pytest.raises(ValueError, match=f"threads are whole numbers from 0 to 1024, not {threads}"):
            scene.render(spp=1, threads=threads)
    for spp in [0, 2**24 + 1]:
        with pytest.raises(ValueError, match=f"samples per pixel are whole numbers from 1 to 16777216, not {spp}"):
            scene.render(spp=spp)


def test_a_diffuse_material_is_its_cosine():
    clay = st.material("diffuse", reflectance=(0.5, 0.25, 1.0))
    theta = np.linspace(0, 1.5, 7)
    wi = np.stack([np.sin(theta), 0 * theta, np.cos(theta)], -1)
    value = clay.eval([0, 0, 1], wi)
    assert value.shape == (7, 3)
    assert np.allclose(value, np.cos(theta)[:, None] * [0.5, 0.25, 1.0] / np.pi, rtol=1e-4)
    assert np.allclose(clay.pdf([0, 0, 1], wi), np.cos(theta) / np.pi, rtol=1e-4)
    with pytest.raises(ValueError, match="length one"):
        clay.eval([0, 0, 2], wi)
    named = st.scene(BALL).material("clay")
    assert np.allclose(named.eval([0, 0, 1], [0, 0, 1]), np.array([0.7, 0.3, 0.2]) / np.pi, rtol=1e-3)


def test_spectra_are_functions_of_wavelength():
    k = st.spectrum("metal-Au-k", np.array([[450.0, 550.0], [600.0, 700.0]]))
    assert k.shape == (2, 2) and (k > 1).all()
    with pytest.raises(KeyError, match="metal-Zz"):
        st.spectrum("metal-Zz", [500.0])


def test_the_readers_are_all_there():
    for name in ["showcase.pbrt", "showcase.xml"]:
        scene = st.load(os.path.join(ROOT, "scenes", name))
        assert "Scene" in repr(scene) and len(scene.cameras) == 1
    assert "path" in st.registry()["integrators"]


def test_parameters_are_described():
    scene = st.scene(BALL)
    params = scene.params()
    assert {key.rpartition(".")[0] for key in params} >= {"clay", "sky", "camera"} & set(scene)
    reflectance = params["clay.reflectance"]
    assert reflectance.value == {"rgb": [0.7, 0.3, 0.2]} and reflectance.range is not None and reflectance.doc
    unset = [p for p in params.values() if p.value is None]
    assert unset and all(p.default and p.type and p.doc for p in unset)
    before = scene.render(spp=1, size=(8, 8))["R"].sum()
    params["clay.reflectance"] = 0.0
    assert params["clay.reflectance"].value == 0.0
    assert scene.render(spp=1, size=(8, 8))["R"].sum() < before
    assert "clay.reflectance" in repr(params) and "reflectance" in repr(reflectance)
    with pytest.raises(KeyError, match="did you mean 'clay'"):
        params["clya.reflectance"]
    with pytest.raises(st.SceneError):
        params["clay.reflektance"] = 0.5


def test_a_part_of_a_value_sets_the_whole():
    scene = st.scene({"materials": {"clay": {"material": "diffuse", "reflectance": {"blackbody": 3000}}},
                      "shapes": [{"shape": "sphere", "material": "clay"}]})
    value = scene["clay"]["reflectance"]
    assert isinstance(value, dict), value
    value["blackbody"] = 5000
    assert scene["clay"]["reflectance"] == {"blackbody": 5000}


def test_losses_are_shown_once():
    text = "WorldBegin\nLightSource \"infinite\"\nMaterial \"diffuse\" \"float nonsense\" 1\nShape \"sphere\"\n"
    with pytest.warns(st.SceneWarning, match="nonsense"):
        scene = st.scene(text, format="pbrt")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        scene.render(spp=1, size=(4, 4))


def test_scenes_are_saved_by_extension(tmp_path):
    scene = st.load("builtin:cornell-box")
    scene.save(tmp_path / "c.xml")
    assert (tmp_path / "c.xml").read_text().lstrip().startswith("<")
    again = st.load(tmp_path / "c.xml")
    one, other = (np.asarray(s.render(spp=4, size=(16, 16), color="rgb", seed=1)).mean() for s in (scene, again))
    assert abs(one - other) < 0.1 * one
    with pytest.raises(ValueError, match="scenes are written as"):
        scene.save(tmp_path / "c.obj")


def test_pictures_are_read_compared_and_shown(tmp_path):
    image = st.load("builtin:cornell-box").render(spp=2, size=(12, 9))
    image.save(tmp_path / "a.exr")
    again = st.read_image(tmp_path / "a.exr")
    assert sorted(again.channels) == sorted(image.channels) and np.array_equal(again["R"], image["R"])
    same = st.compare(again, image)
    assert same["mse"] == 0 and same["psnr"] == float("inf") and same["ratio"] == [1.0, 1.0, 1.0]
    again["R"][:] *= 2
    assert st.compare(again, image)["ratio"][0] == pytest.approx(2)
    shown = image.to_uint8(exposure=1)
    assert shown.shape == (9, 12, 3) and shown.dtype == np.uint8
    assert (image.to_uint8(exposure=-60) == 0).all()
    with pytest.raises(ValueError, match="nothing.exr"):
        st.read_image(tmp_path / "nothing.exr")


def test_the_version_is_that_of_the_package():
    assert st.__version__.count(".") == 2


def test_models_on_a_transparent_background_have_no_ground(tmp_path):
    model = tmp_path / "square.obj"
    model.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
    scene = st.load(model)

    def covered(scene, **settings):
        image = scene.render(spp=2, size=(16, 12), layers=["alpha"], **settings)
        return float(image.layer("alpha").mean())

    opaque = covered(scene)
    clear = covered(scene, transparent=True)
    assert clear < 0.7 < opaque, "the ground is not there"
    assert covered(scene) == opaque, "the scene keeps it"
    asked = st.load(model, defines={"ground": "true"})
    assert covered(asked, transparent=True) == opaque


def test_parameters_with_the_name_of_their_family_are_written_with_an_underscore():
    scene = st.scene(
        {
            "camera": {"camera": "perspective"},
            "lights": {"sky": {"light": "environment"}},
            "textures": {"half": {"texture": "scale", "texture_": {"texture": "constant", "value": 0.5}, "scale": 0.5}},
            "materials": {"m": {"material": "mask", "material_": {"material": "diffuse", "reflectance": "half"}, "opacity": 0.25}},
            "shapes": {"ball": {"shape": "sphere", "material": "m"}},
        }
    )
    text = scene.text()
    assert "texture: scale, texture: {texture: constant" in text and "material: mask, material: {material: diffuse" in text
    assert st.scene(text, format="steradian").text() == text
    with pytest.raises(st.SceneError, match="texture_"):
        st.scene({"textures": {"a": {"texture_": {"texture": "constant"}}}})
