"""Rays at closed forms, and directions at materials."""

import os
import subprocess
import sys

import numpy as np
import pytest

import steradian as st
from scenes import BALL, SQUARE, of_mesh


def directions(n, seed):
    d = np.random.default_rng(seed).normal(size=(n, 3))
    return d / np.linalg.norm(d, axis=-1, keepdims=True)


def test_rays_meet_a_sphere_where_the_quadratic_says():
    scene = st.scene(BALL)
    d = directions(2000, 1)
    o = np.array([0.3, -0.2, -2.5])
    hits = scene.trace(o, d)
    b, c = d @ o, o @ o - 1
    inside = b * b - c
    meets = (inside > 0) & (b < 0)
    assert np.array_equal(hits.hit, meets) and 50 < meets.sum() < 1950
    t = -b[meets] - np.sqrt(inside[meets])
    assert np.allclose(hits.t[meets], t, rtol=1e-4) and np.isinf(hits.t[~meets]).all()
    p = o + t[:, None] * d[meets]
    assert np.allclose(hits.position[meets], p, atol=1e-4)
    assert np.allclose(hits.geometric_normal[meets], p, atol=1e-4) and np.allclose(hits.normal[meets], p, atol=1e-4)
    assert (hits.geometric_normal[~meets] == 0).all() and (hits.primitive[~meets] == -1).all() and (hits.instance == -1).all()
    assert set(hits.material_name[meets]) == {"clay"} and set(hits.material_name[~meets]) == {""}
    # In units of a longer direction distances are shorter.
    assert np.allclose(scene.trace(o, 4 * d).t[meets], t / 4, rtol=1e-4)
    assert np.array_equal(scene.trace(o, d, max_distance=1.6).hit, meets & (np.where(meets, hits.t, np.inf) < 1.6))
    assert np.array_equal(scene.occluded(o, d), meets)
    assert np.array_equal(scene.occluded(o, d, 1.6), meets & (np.where(meets, hits.t, np.inf) < 1.6))


def test_rays_see_what_layers_show():
    scene = st.load("builtin:cornell-box")
    shown = scene.render(spp=1, size=(24, 18), integrator="raycast", layers=["position", "normal", "geometric_normal", "ids", "uv"])
    there = shown.layer("ids")[..., 0] > 0
    to_camera = np.reshape(shown.metadata["worldToCamera"], (4, 4)).T
    eye = np.linalg.inv(to_camera)[:3, 3]
    p = shown.layer("position")[there]
    hits = scene.trace(eye, p - eye)
    assert hits.hit.all() and np.allclose(hits.t, 1, atol=1e-3)
    same = np.isclose(hits.t, 1, atol=1e-4)
    assert same.mean() > 0.95
    assert np.array_equal(hits.shape[same], shown.layer("ids")[there][same, 0].astype(int))
    assert np.array_equal(hits.material[same], shown["material_id.Y"][there][same].astype(int))
    assert np.allclose(hits.normal[same], shown.layer("normal")[there][same], atol=1e-3)


def test_rays_have_shapes_triangles_and_parameters():
    uvs = SQUARE["positions"][:, :2] * [2, 3]
    scene = st.scene(of_mesh({**SQUARE, "uvs": uvs}))
    at = np.array([[[0.2, 0.3], [0.9, 0.8]], [[0.5, 0.1], [7, 7]]])
    hits = scene.trace(np.concatenate([at, np.full((2, 2, 1), 2.0)], -1), [0, 0, -1])
    assert hits.t.shape == (2, 2) and hits.position.shape == (2, 2, 3) and hits.uv.shape == (2, 2, 2)
    assert hits.primitive.tolist() == [[0, 1], [0, -1]]
    assert hits.shape_name.tolist() == [["sheet", "sheet"], ["sheet", ""]]
    assert np.allclose(hits.uv[hits.hit], at[hits.hit] * [2, 3], atol=1e-5)
    one = scene.trace([0.2, 0.3, 2], [0, 0, -1])
    assert one.t.shape == () and float(one.t) == 2 and "1 of 1" in repr(one)
    # Two shadows of points: behind the sheet and before it.
    assert scene.occluded([0.2, 0.3, 2], [0, 0, -1], [[1.9], [2.1]]).tolist() == [[False], [True]]
    scene["sheet"].positions = SQUARE["positions"] + [0, 0, 1]
    assert float(scene.trace([0.2, 0.3, 2], [0, 0, -1]).t) == 1


def test_rays_need_no_camera():
    scene = st.scene({"shapes": {"ball": {"shape": "sphere"}}})
    assert float(scene.trace([0, 0, 3], [0, 0, -1]).t) == pytest.approx(2)
    with pytest.raises(st.SceneError, match="the scene has no camera"):
        scene.render(spp=1)
    assert scene.occluded([0, 0, 3], [0, 0, -1]) and scene.cameras == [] and len(scene) == 1


def test_rays_of_wrong_shapes_are_refused():
    scene = st.scene(BALL)
    for o, d, end, said in [
        ([0, 0], [0, 0, 1], 1, r"origins has the shape \(2,\), where \(…, 3\)"),
        ([0, 0, 0], np.ones((3, 2)), 1, r"directions has the shape \(3, 2\)"),
        (np.ones((2, 3)), np.ones((5, 3)), 1, r"do not go together: origins \(2, 3\), directions \(5, 3\)"),
        ([0, 0, 0], ["a", "b", "c"], 1, "directions has the dtype"),
        ([0, 0, 0], [[0, 0, 1], [0, 0, 0]], 1, "row 1 of directions has no length"),
        ([0, np.nan, 0], [0, 0, 1], 1, "row 0 of origins is not finite"),
        ([0, 0, 0], [0, 0, 1], -1, "row 0 of max_distance is not above 0"),
    ]:
        for query in (scene.trace, scene.occluded):
            with pytest.raises(ValueError, match=said):
                query(o, d, max_distance=end)
    with pytest.raises(ValueError, match="time is a number from 0 to 1, not 2"):
        scene.trace([0, 0, 0], [0, 0, 1], time=2)
    assert scene.trace(np.empty((0, 3)), np.empty((0, 3))).t.shape == (0,)


MATERIALS = {
    "diffuse": {},
    "conductor": {"eta": "metal-Au-eta", "k": "metal-Au-k", "alpha_u": 0.4, "alpha_v": 0.3},
    "dielectric": {"alpha_u": 0.5, "alpha_v": 0.5},
    "coated_diffuse": {"reflectance": (0.5, 0.2, 0.1), "alpha_u": 0.5, "alpha_v": 0.5},
}


@pytest.mark.parametrize("kind", MATERIALS)
def test_samples_are_drawn_by_their_density_and_weighed(kind):
    material = st.material(kind, **MATERIALS[kind])
    n = 40000
    wo = np.array([0.48, 0.36, 0.8])
    drawn = material.sample(wo, np.random.default_rng(3).random((n, 4)))
    there = (drawn.pdf > 0) & ~drawn.specular
    assert np.allclose(np.linalg.norm(drawn.wi[there], axis=-1), 1, atol=1e-5)
    if there.any() and kind != "coated_diffuse":
        wi = drawn.wi[there]
        assert np.allclose(material.pdf(wo, wi), drawn.pdf[there], rtol=2e-3, atol=1e-5)
        assert np.allclose(material.eval(wo, wi), drawn.weight[there] * drawn.pdf[there, None], rtol=2e-3, atol=1e-5)
    # The mean of f cos over directions that are drawn evenly is that of the weights: two ways to one integral.
    even = directions(400000, 5)
    values = material.eval(wo, even) * 4 * np.pi
    allowed = 4 * np.hypot(values.std(0) / np.sqrt(len(even)), drawn.weight.std(0) / np.sqrt(n))
    assert (np.abs(values.mean(0) - drawn.weight.mean(0)) < allowed + 1e-4).all(), (values.mean(0), drawn.weight.mean(0), allowed)


def test_albedos_are_known():
    d = directions(6, 2)
    d[:, 2] = np.abs(d[:, 2])
    grey = st.material("diffuse", reflectance=(0.5, 0.25, 1.0))
    assert np.allclose(grey.albedo(d), [0.5, 0.25, 1.0], atol=1e-4) and grey.albedo(d[0]).shape == (3,)
    glass = st.material("dielectric", alpha_u=0.0, alpha_v=0.0)
    assert np.allclose(glass.albedo(d), 1, atol=1e-3), "clear glass takes no light"
    drawn = glass.sample(d, np.random.default_rng(1).random((6, 3)))
    assert drawn.specular.all() and (glass.eval(d, drawn.wi) == 0).all()
    through = drawn.wi[:, 2] < 0
    assert np.allclose(drawn.wi[~through], d[~through] * [-1, -1, 1], atol=1e-5), "mirrored"
    # Snell's law, by the ratio that is told.
    assert np.allclose(drawn.wi[through, :2] * drawn.eta[through, None], -d[through, :2], atol=1e-5)
    spectral = st.material("diffuse", wavelengths=(450, 500, 550, 600))
    assert spectral.albedo(d).shape == (6, 4) and spectral.sample(d, np.full((6, 3), 0.5)).weight.shape == (6, 4)


def test_mixtures_choose_by_a_fourth_number():
    mix = st.scene({
        "materials": {"both": {"material": "mix", "materials": [
            {"material": "diffuse", "reflectance": 0.2}, {"material": "conductor", "alpha_u": 0.0, "alpha_v": 0.0},
        ]}},
        "shapes": [{"shape": "sphere", "material": "both"}],
    }).material("both")
    u = np.random.default_rng(1).random((2000, 4))
    given, hashed = (mix.sample([0, 0, 1], u[:, :k]).specular.mean() for k in (4, 3))
    assert abs(given - 0.5) < 0.05 and abs(hashed - 0.5) < 0.05
    one, other = (mix.sample([0, 0, 1], [0.5, 0.5, 0.5, choice]).specular for choice in (0.1, 0.9))
    assert one != other


def test_samples_of_wrong_shapes_are_refused():
    clay = st.material("diffuse")
    for wo, u, said in [
        ([0, 0, 1], [0.5, 0.5], r"u has the shape \(2,\), where \(…, 3 or 4\) is needed"),
        ([0, 1], [0.5, 0.5, 0.5], r"wo has the shape \(2,\)"),
        ([0, 0, 2], [0.5, 0.5, 0.5], "row 0 of wo is not of length one"),
        ([0, 0, 1], [[0.5, 0.5, 0.5], [0.5, 1.5, 0.5]], "row 1 of u is not within 0 and 1"),
        ([[0, 0, 1]] * 2, [[0.5] * 3] * 3, r"do not go together: wo \(2, 3\), u \(3, 3\)"),
    ]:
        with pytest.raises(ValueError, match=said):
            clay.sample(wo, u)
    with pytest.raises(ValueError, match="samples are whole numbers from 1"):
        clay.albedo([0, 0, 1], samples=0)


ALL = """
import hashlib, sys
import numpy as np
import steradian as st
scene = st.load("builtin:cornell-box")
r = np.random.default_rng(7)
o, d = r.random((20000, 3)) - 0.5, r.normal(size=(20000, 3))
wo = np.abs(d / np.linalg.norm(d, axis=-1, keepdims=True))
hits, gold = scene.trace(o, d), st.material("conductor", alpha_u=0.3, alpha_v=0.2)
drawn = gold.sample(wo, r.random((20000, 3)))
arrays = [hits.t, hits.normal, hits.uv, hits.primitive, hits.shape, scene.occluded(o, d, 0.4)]
arrays += [drawn.wi, drawn.weight, drawn.pdf, gold.eval(wo, drawn.wi), gold.albedo(wo[:300], samples=64)]
print(hashlib.sha256(b"".join(np.ascontiguousarray(a).tobytes() for a in arrays)).hexdigest())
"""


def test_any_number_of_threads_gives_the_same_bits():
    def run(threads):
        environment = {**os.environ, "RAYON_NUM_THREADS": str(threads)}
        return subprocess.run([sys.executable, "-c", ALL], env=environment, check=True, capture_output=True, text=True).stdout

    one = run(1)
    assert len(one) == 65 and all(run(threads) == one for threads in (2, 5))
