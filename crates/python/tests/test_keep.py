"""Pickles, copies, and files that are not written over."""

import copy
import os
import pickle
import warnings

import numpy as np
import pytest

import steradian as st
from scenes import BALL, SQUARE, of_mesh

ROOT = os.path.join(os.path.dirname(__file__), "..", "..", "..")


def test_pictures_are_pickled_and_copied():
    image = st.load("builtin:cornell-box").render(spp=2, size=(12, 9), crop=[2, 1, 10, 7], layers=["albedo", "depth", "samples"])
    for other in [pickle.loads(pickle.dumps(image)), copy.deepcopy(image)]:
        assert other.channels == image.channels and all(np.array_equal(other[c], image[c]) for c in image.channels)
        assert (other.about(), repr(other)) == (image.about(), repr(image))
        other["R"][:] = 7
        assert (image["R"] != 7).any()
    assert image.metadata["whiteLuminance"] > 0 and len(image.metadata["worldToCamera"]) == 16


def test_pictures_are_made_of_arrays(tmp_path):
    r = np.linspace(0, 1, 12).reshape(3, 4)
    image = st.Image({"R": r, "G": r * 2, "B": r[::-1]}, {"metadata": {"note": "a", "n": 3, "x": 0.5, "m": [1.0] * 16}, "spp": 2})
    assert image.shape == (3, 4, 3) and image.spp == 2 and np.allclose(image["G"], 2 * r) and image["R"].dtype == np.float32
    image.save(tmp_path / "a.exr")
    again = st.read_image(tmp_path / "a.exr")
    assert np.array_equal(again["B"], image["B"]) and again.metadata["note"] == "a" and again.metadata["n"] == 3
    for planes, said in [
        ({}, "one plane at least"),
        ({"R": r, "G": r[:2]}, r"plane 'G' has the shape \(2, 4\), not \(3, 4\)"),
        ({"R": r[..., None]}, r"plane 'R' has the shape \(3, 4, 1\), not \(height, width\)"),
        ({"R": np.empty((0, 4))}, "plane 'R' has the shape"),
    ]:
        with pytest.raises(ValueError, match=said):
            st.Image(planes)
    with pytest.raises(ValueError, match="metadata 'a' is a text, a number"):
        st.Image({"R": r}, {"metadata": {"a": {}}})


def grid(n=9):
    x, y = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n))
    k = np.arange(n * n).reshape(n, n)
    corners = [k[:-1, :-1], k[:-1, 1:], k[1:, :-1], k[1:, 1:]]
    triangles = np.concatenate([np.stack([corners[i].ravel() for i in t], -1) for t in [(0, 1, 2), (1, 3, 2)]])
    return {"positions": np.stack([x, y, np.sin(7 * x) / 9], -1).reshape(-1, 3), "triangles": triangles}


def test_scenes_are_pickled_by_their_description():
    for scene in [st.scene(BALL), st.scene(of_mesh(SQUARE)), st.scene(of_mesh(grid())), st.load("builtin:cornell-box"),
                  st.load(os.path.join(ROOT, "scenes", "showcase.pbrt"))]:
        expected = np.asarray(scene.render(spp=1, size=(16, 12)))
        for other in [pickle.loads(pickle.dumps(scene)), copy.deepcopy(scene), copy.copy(scene)]:
            assert np.array_equal(np.asarray(other.render(spp=1, size=(16, 12))), expected)


def test_a_pickle_holds_pictures_that_are_in_memory_and_names_files(tmp_path, monkeypatch):
    st.Image({c: np.full((2, 2), v) for c, v in zip("RGB", (0.25, 0.5, 1.0))}).save(tmp_path / "t.exr")
    scene = st.scene({**BALL, "materials": {"clay": {"material": "diffuse", "reflectance":
                      {"texture": "image", "file": {"file": "t.exr"}}}}}, search=[tmp_path])
    expected = np.asarray(scene.render(spp=1))
    data = pickle.dumps(scene)
    monkeypatch.chdir(tmp_path)
    assert np.array_equal(np.asarray(pickle.loads(data).render(spp=1)), expected)
    # In memory only, as glTF has its pictures.
    inner = st._steradian.Scene.describe(scene.text(tmp_path / "s.steradian"), files={"t.exr": (tmp_path / "t.exr").read_bytes()})
    data = pickle.dumps(st.Scene(inner))
    (tmp_path / "t.exr").unlink()
    assert np.array_equal(np.asarray(pickle.loads(data).render(spp=1)), expected)


def test_copies_are_edited_alone():
    scene = st.scene(of_mesh(SQUARE))
    before = np.asarray(scene.render(spp=1))
    other = copy.deepcopy(scene)
    other["clay"]["reflectance"] = 0
    other["sheet"].positions = SQUARE["positions"] + [0, 0, 1]
    assert np.array_equal(np.asarray(scene.render(spp=1)), before)
    assert np.array_equal(scene["sheet"].positions, SQUARE["positions"]) and np.asarray(other.render(spp=1))[8, 8].max() == 0


def test_a_copy_tells_no_loss_again():
    with pytest.warns(st.SceneWarning, match="scael"):
        scene = st.scene({**BALL, "lights": [{"light": "environment", "scael": 2.0}]})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert [m.text for m in copy.deepcopy(scene).messages] == [m.text for m in scene.messages]
        copy.deepcopy(scene).render(spp=1, size=(4, 4))


def test_what_was_read_is_not_written_over(tmp_path):
    texture = tmp_path / "t.exr"
    st.Image({c: np.full((2, 2), 0.5) for c in "RGB"}).save(texture)
    st.scene({**BALL, "materials": {"clay": {"material": "diffuse", "reflectance": {"texture": "image", "file": {"file": "t.exr"}}}}},
             search=[tmp_path]).save(tmp_path / "a.steradian")
    scene = st.load(tmp_path / "a.steradian")
    image = scene.render(spp=1)
    os.symlink(texture, tmp_path / "link.exr")
    before = texture.read_bytes(), (tmp_path / "a.steradian").read_bytes()
    for name in ["t.exr", "link.exr"]:
        with pytest.raises(FileExistsError, match="t.exr' is a file that is read here .*; give another name, or overwrite=True"
                           if name == "t.exr" else "is a file that is read here"):
            image.save(tmp_path / name)
    with pytest.raises(FileExistsError, match="a.steradian' is a file that is read here"):
        scene.save(tmp_path / "a.steradian")
    assert before == (texture.read_bytes(), (tmp_path / "a.steradian").read_bytes())
    # What was written by the scene or the picture itself may be written again.
    for _ in range(2):
        image.save(tmp_path / "out.exr")
        scene.save(tmp_path / "b.steradian")
    scene["clay"]["reflectance"] = 0.25
    scene.save(tmp_path / "a.steradian", overwrite=True)
    image.save(texture, overwrite=True)
    assert (tmp_path / "a.steradian").read_bytes() != before[1] and texture.read_bytes() != before[0]
    read = st.read_image(texture)
    with pytest.raises(FileExistsError, match="t.exr"):
        read.save(texture)
    read.save(texture, overwrite=True)
