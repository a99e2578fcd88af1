"""Materials, textures and integrators of a program's own, beside those that are built in."""

import os
import re
import threading

import numpy as np
import pytest

import steradian as st

CAMERA = {"camera": "perspective", "fov": 40, "to_world": {"look_at": [0, 0, 0], "from": [0, 1, 5], "up": [0, 1, 0]}}
LIGHTS = [{"light": "environment", "radiance": 1}, {"light": "point", "position": [0, 3, 2], "intensity": 20}]


def ball(material):
    shapes = [{"shape": "sphere", "material": material}]
    return st.scene({"film": {"film": "rgb", "width": 16, "height": 16}, "camera": CAMERA, "lights": LIGHTS, "shapes": shapes})


def agree(a, b, relative=0.01):
    """Means of two pictures with the layer variance differ by noise alone."""
    means = [np.asarray(image).mean() for image in (a, b)]
    error = np.sqrt(sum(image.layer("variance").mean() / np.asarray(image)[..., 0].size for image in (a, b)))
    assert abs(means[0] - means[1]) < 3.5 * error and error < relative * means[1], (means, error)


def lobe(wo, wi, at):
    mirrored = np.maximum((wo * [-1, -1, 1] * wi).sum(1), 0)
    return mirrored ** at["exponent"]


def glossy(wo, wi, at):
    n = at["exponent"]
    value = at["diffuse"] / np.pi + at["glossy"] * ((n + 2) / (2 * np.pi) * lobe(wo, wi, at))[:, None]
    return value * wi[:, 2:]


def density(wo, wi, at):
    return 0.5 * wi[:, 2] / np.pi + 0.5 * (at["exponent"] + 1) / (2 * np.pi) * lobe(wo, wi, at)


def draw(wo, u, at):
    """Half by the cosine, half by the lobe about the mirror direction."""
    phi = 2 * np.pi * u[:, 1]
    by_lobe = u[:, 0] >= 0.5
    cos = np.where(by_lobe, u[:, 2] ** (1 / (at["exponent"] + 1)), np.sqrt(u[:, 2]))
    sin = np.sqrt(np.maximum(1 - cos * cos, 0))
    local = np.stack([sin * np.cos(phi), sin * np.sin(phi), cos], 1)
    axis = np.where(by_lobe[:, None], wo * [-1, -1, 1], [0, 0, 1])
    helper = np.where(np.abs(axis[:, :1]) < 0.9, [1, 0, 0], [0, 1, 0])
    x = np.cross(helper, axis)
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    wi = local[:, :1] * x + local[:, 1:2] * np.cross(axis, x) + local[:, 2:] * axis
    return np.where(wi[:, 2:] > 0, wi, 0)


COLORS = {"diffuse": [0.2, 0.4, 0.6], "glossy": 0.3}


def test_a_material_looks_as_the_built_in_one():
    sizes = []

    def value(wo, wi, at):
        sizes.append(len(wo))
        return glossy(wo, wi, at)

    own = st.material("py_glossy", eval=value, sample=draw, pdf=density, colors=COLORS, numbers={"exponent": 2})
    built_in = st.material("phong", diffuse_reflectance=[0.2, 0.4, 0.6], specular_reflectance=0.3, exponent=2)
    rng = np.random.default_rng(1)
    w = rng.normal(size=(2, 100, 3))
    w[..., 2] = np.abs(w[..., 2])
    wo, wi = w / np.linalg.norm(w, axis=-1, keepdims=True)
    assert np.allclose(own.eval(wo, wi), built_in.eval(wo, wi), rtol=1e-3, atol=1e-6)
    # Directions are drawn by the density that is told for them, and weigh what they are worth.
    drawn = own.sample(np.broadcast_to(wo[0], (4096, 3)), rng.random((4096, 3)))
    there = drawn.pdf > 0
    assert np.allclose(own.pdf(wo[0], drawn.wi[there]), drawn.pdf[there], rtol=1e-3)
    assert np.allclose(drawn.weight[there] * drawn.pdf[there, None], own.eval(wo[0], drawn.wi[there]), rtol=1e-3)
    error = 3.5 * drawn.weight.std(0) / np.sqrt(len(there))
    assert (np.abs(drawn.weight.mean(0) - built_in.albedo(wo[:1], samples=65536)[0]) < error + 1e-3).all()
    # Threads that wait at the same time share a call.
    of_scene = {"material": "py_glossy", "exponent": 20}
    pictures = [ball(m).render(integrator="path", spp=32, layers=["variance"], seed=2, threads=8) for m in (of_scene, {
        "material": "phong", "diffuse_reflectance": [0.2, 0.4, 0.6], "specular_reflectance": 0.3, "exponent": 20})]
    agree(*pictures)
    assert sizes and min(sizes) >= 1


def test_laws_hold_or_are_told_as_broken():
    velvet = st.material("py_velvet", eval=lambda wo, wi, at: (1 - 0.4 * (wo[:, 2] + wi[:, 2])) * wi[:, 2] / np.pi)
    assert all(law["holds"] for law in velvet.laws(samples=1000))

    def without_cosine(wo, wi, at):
        return at["diffuse"] / np.pi

    bad = st.material("py_bright", eval=without_cosine, colors={"diffuse": 0.9})
    broken = {law["law"].split(":")[0] for law in bad.laws(samples=1000) if not law["holds"]}
    assert "energy" in broken and "reciprocity" in broken, broken


def test_the_same_name_replaces():
    st.material("py_flat", eval=lambda wo, wi, at: wi[:, 2] / np.pi * 0.2)
    dark = np.asarray(ball({"material": "py_flat"}).render(integrator="path", spp=8, seed=1)).mean()
    st.material("py_flat", eval=lambda wo, wi, at: wi[:, 2] / np.pi * 0.8)
    assert np.asarray(ball({"material": "py_flat"}).render(integrator="path", spp=8, seed=1)).mean() > 1.05 * dark


def test_a_texture_has_the_values_of_its_function():
    st.texture("py_rings", lambda uv, p: 0.5 + 0.5 * np.sin(2 * np.pi * 3 * np.linalg.norm(p, axis=1)))
    st.texture("py_warm", lambda uv, p: np.stack([p[:, 0] * 0 + 0.9, p[:, 0] * 0 + 0.4, p[:, 0] * 0], 1))
    formula = {"texture": "expression", "expression": "0.5 + 0.5*sin(2*pi*3*sqrt(x*x + y*y + z*z))"}
    own, reference = (ball({"material": "diffuse", "reflectance": t}).render(integrator="path", spp=8, seed=1) for t in ({"texture": "py_rings"}, formula))
    assert np.abs(np.asarray(own) - np.asarray(reference)).max() < 1e-3
    warm = np.asarray(ball({"material": "diffuse", "reflectance": {"texture": "py_warm"}}).render(integrator="path", spp=8))[8, 8]
    assert warm[0] > 1.5 * warm[1] > 0 and warm[2] < 0.1 * warm[0]


def test_an_integrator_gets_waves_of_rays():
    scene = ball({"material": "diffuse"})

    def openness(wave):
        hits = scene.trace(wave.origins, wave.directions)
        u = wave.random(0)
        r, phi = np.sqrt(u[:, :1]), 2 * np.pi * u[:, 1:]
        n = np.where(hits.hit[:, None], hits.normal, [0, 0, 1])
        helper = np.where(np.abs(n[:, :1]) < 0.9, [1, 0, 0], [0, 1, 0])
        x = np.cross(helper, n)
        x /= np.linalg.norm(x, axis=1, keepdims=True)
        w = r * np.cos(phi) * x + r * np.sin(phi) * np.cross(n, x) + np.sqrt(1 - u[:, :1]) * n
        p = np.where(hits.hit[:, None], hits.position, 0)
        return np.repeat((hits.hit & ~scene.occluded(p + 1e-3 * n, w, 1.0))[:, None], 3, 1).astype(float)

    st.integrator("py_openness", openness)
    own = scene.render(integrator="py_openness", spp=32, seed=1)
    reference = scene.render(integrator="ao:distance=1", spp=32, seed=1)
    assert np.allclose(np.asarray(own).mean(), np.asarray(reference).mean(), rtol=0.02)
    assert np.array_equal(np.asarray(own), np.asarray(scene.render(integrator="py_openness", spp=32, seed=1, threads=1)))
    with pytest.raises(ValueError, match="did you mean 'py_openness'"):
        scene.render(integrator="py_opennes", spp=1)


def test_faults_of_functions_are_raised():
    def raises(wo, wi, at):
        raise KeyError("nothing of that name")

    scene = ball({"material": "py_faulty"}) if st.material("py_faulty", eval=raises) else None
    with pytest.raises(KeyError, match="nothing of that name"):
        scene.render(integrator="path", spp=4)
    # The next render knows nothing of it.
    assert np.asarray(ball({"material": "diffuse"}).render(integrator="path", spp=1)).mean() > 0
    st.material("py_wrong", eval=lambda wo, wi, at: np.zeros((len(wo), 2)))
    with pytest.raises(ValueError, match=r"'eval' gave an array of shape \[\d+, 2\], where"):
        ball({"material": "py_wrong"}).render(integrator="path", spp=4)
    st.integrator("py_words", lambda wave: ["a"] * len(wave))
    with pytest.raises(TypeError, match="no array of numbers"):
        ball({"material": "diffuse"}).render(integrator="py_words", spp=1)
    # What is no number is darkness.
    st.material("py_nan", eval=lambda wo, wi, at: np.full(len(wo), np.nan))
    assert np.isfinite(np.asarray(ball({"material": "py_nan"}).render(integrator="path", spp=4))).all()


@pytest.mark.parametrize("call, what", [
    (lambda: st.material("diffuse", eval=glossy), "the material 'diffuse' is there already"),
    (lambda: st.material("two words", eval=glossy), "is no name"),
    (lambda: st.material("py_half", eval=glossy, sample=draw), "go together"),
    (lambda: st.material("phong", colors={"a": 1}), "needs 'eval'"),
    (lambda: st.material("py_many", eval=glossy, colors={c: 0.5 for c in "abcde"}), "at most four"),
    (lambda: st.material("py_color", eval=glossy, colors={"a": [1, 2]}), r"\(3,\)"),
    (lambda: st.material("py_color", eval=glossy, colors={"a": 5}), "not within 0 and 1"),
    (lambda: st.material("py_number", eval=glossy, numbers={"a": float("nan")}), "not finite"),
    (lambda: st.material("py_alike", eval=glossy, colors={"a": 0.5}, numbers={"a": 1}), "two parameters 'a'"),
    (lambda: st.material("py_bumps", eval=glossy, colors={"bump": 0.5}), "two parameters 'bump'"),
    (lambda: st.texture("checkerboard", glossy), "the texture 'checkerboard' is there already"),
    (lambda: st.integrator("path", glossy), "the integrator 'path' is there already"),
])
def test_names_and_parameters_are_checked(call, what):
    with pytest.raises(ValueError, match=what):
        call()


def test_a_fault_is_that_of_the_renders_that_called_it():
    def raises(wo, wi, at):
        raise KeyError("mine")

    st.material("py_good", eval=lambda wo, wi, at: wi[:, 2] / np.pi * 0.5)
    st.material("py_bad", eval=raises)
    good, bad = ball({"material": "py_good"}), ball({"material": "py_bad"})
    reference = np.asarray(good.render(integrator="path", spp=4, seed=1))
    raised = []

    def fail():
        for _ in range(30):
            try:
                bad.render(integrator="path", spp=4)
                raised.append(None)
            except Exception as why:
                raised.append(str(why))

    other = threading.Thread(target=fail)
    other.start()
    pictures = [np.asarray(good.render(integrator="path", spp=4, seed=1)) for _ in range(30)]
    other.join()
    assert raised == ["'mine'"] * 30, raised
    assert all(np.array_equal(picture, reference) for picture in pictures)


def test_functions_may_ask_for_other_materials_but_not_render():
    gold = st.material("conductor", alpha_u=0.3)

    def unit(w):
        return w / np.linalg.norm(w, axis=1, keepdims=True)

    st.material("py_gold", eval=lambda wo, wi, at: gold.eval(unit(wo), unit(wi)))
    agree(*(ball({"material": m, **more}).render(integrator="path", spp=64, layers=["variance"], seed=i, threads=8)
            for i, (m, more) in enumerate([("py_gold", {}), ("conductor", {"alpha_u": 0.3})])), relative=0.05)
    inner = ball({"material": "diffuse"})
    st.material("py_renders", eval=lambda wo, wi, at: np.asarray(inner.render(spp=1)).mean() * wi[:, 2])
    with pytest.raises(RuntimeError, match="cannot render"):
        ball({"material": "py_renders"}).render(integrator="path", spp=1)
    st.material("py_self", eval=lambda wo, wi, at: own.eval(unit(wo), unit(wi)))
    own = st.material("py_self")
    for threads in (1, 4):
        with pytest.raises(RecursionError, match="ask for themselves"):
            ball({"material": "py_self"}).render(integrator="path", spp=1, threads=threads)
    # An integrator may begin with the picture of another one; one of itself has no end.
    st.integrator("py_twice", lambda wave: 2 * np.asarray(inner.render(integrator="path", spp=1)).reshape(-1, 3))
    once = np.asarray(inner.render(integrator="path", spp=1))
    assert np.allclose(np.asarray(inner.render(integrator="py_twice", spp=1)), 2 * once)
    st.integrator("py_endless", lambda wave: np.asarray(inner.render(integrator="py_endless", spp=1)).reshape(-1, 3))
    with pytest.raises(RuntimeError, match="cannot render with 'py_endless'"):
        inner.render(integrator="py_endless", spp=1)


@pytest.mark.parametrize("threads", [1, 64])
@pytest.mark.parametrize("value", [None, 0.3, 1j, "x", (x for x in "ab"), [None]])
def test_results_that_are_no_rows_are_refused(value, threads):
    """Of one row, too, which depends on threads."""
    st.material("py_row", eval=lambda wo, wi, at: value)
    with pytest.raises((TypeError, ValueError), match="'eval' gave"):
        ball({"material": "py_row"}).render(integrator="path", spp=1, threads=threads)


def test_models_are_functions():
    for make in (lambda: st.material("py_five", eval=5), lambda: st.texture("py_five", 5), lambda: st.integrator("py_five", 5)):
        with pytest.raises(TypeError, match="'py_five' needs a function, not int"):
            make()


def test_the_page_on_own_models_runs(tmp_path, monkeypatch):
    page = os.path.join(os.path.dirname(__file__), *[os.pardir] * 3, "docs", "own-models.md")
    with open(page, encoding="utf-8") as file:
        program = re.search(r"```python\n(.*?)```", file.read(), re.DOTALL).group(1)
    monkeypatch.chdir(tmp_path)
    exec(compile(program, page, "exec"), {})  # noqa: S102
    pictures = [np.asarray(st.read_image(str(tmp_path / name))) for name in ("cloth.exr", "depth.exr")]
    assert all(np.isfinite(p).all() and p.max() > 0 for p in pictures)
