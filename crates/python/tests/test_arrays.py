"""Arrays in dictionaries, and of meshes and places of shapes."""

import numpy as np
import pytest

import steradian as st
from scenes import BALL, SQUARE, of_mesh

COLOURS = [(0.5, 0.25, 0.125), [0.5, 0.25, 0.125], np.array([0.5, 0.25, 0.125]), np.array([4, 2, 1]) / 8, {"rgb": [0.5, 0.25, 0.125]}]


def picture(description):
    return np.asarray(st.scene(description).render(spp=2, size=(12, 12)))


@pytest.mark.parametrize("colour", COLOURS)
def test_three_numbers_are_a_colour_wherever_one_is_taken(colour):
    def scene(c):
        return {
            "film": BALL["film"],
            "textures": {"checks": {"texture": "checkerboard", "a": c, "b": {"texture": "constant", "value": c}}},
            "materials": {
                "clay": {"material": "mix", "materials": [
                    {"material": "diffuse", "reflectance": {"ref": "checks"}},
                    {"material": "coated_diffuse", "reflectance": c},
                ]},
            },
            "lights": {"sky": {"light": "environment", "radiance": c}, "lamp": {"light": "point", "position": [0, 3, -3], "intensity": c}},
            "cameras": BALL["cameras"],
            "shapes": BALL["shapes"],
        }

    expected = picture(scene({"rgb": [0.5, 0.25, 0.125]}))
    assert np.array_equal(picture(scene(colour)), expected) and expected.max() > 0.1
    edited = st.scene(BALL)
    edited["clay"]["reflectance"] = colour
    edited.params()["sky.radiance"] = colour
    assert edited["clay"]["reflectance"] == edited["sky"]["radiance"] == {"rgb": [0.5, 0.25, 0.125]}
    if not isinstance(colour, dict):
        assert np.allclose(st.material("diffuse", reflectance=colour).eval([0, 0, 1], [0, 0, 1]) * np.pi, [0.5, 0.25, 0.125], atol=1e-3)


def test_meshes_are_arrays_of_any_dtype_or_lists():
    expected = picture(of_mesh({name: a.ravel().tolist() for name, a in SQUARE.items()}))
    for mesh in [
        SQUARE,
        {name: a.astype(np.int16) for name, a in SQUARE.items()},
        {name: a.tolist() for name, a in SQUARE.items()},
        {"positions": np.asfortranarray(SQUARE["positions"].astype(float)), "triangles": SQUARE["triangles"][::-1][::-1]},
    ]:
        assert np.array_equal(picture(of_mesh(mesh)), expected)
        named = {"meshes": {"sheet of paper": mesh}, **of_mesh("sheet of paper")}
        assert np.array_equal(picture(named), expected)
    # A white sky on a diffuse sheet is its reflectance.
    assert np.allclose(expected[6, 6], [0.5, 0.25, 0.125], atol=0.02)


def test_colours_of_vertices_and_faces():
    corners = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], np.float32)
    for attribute, at, seen in [
        (corners, [0.5, 0.5], [0, 0.5, 0.5]),
        ({"vertex": 3, "data": corners.ravel()}, [0.25, 0.25], [0.5, 0.25, 0.25]),
        ({"face": 3, "data": corners[:2]}, [0.1, 0.1], [1, 0, 0]),
        ({"face": 3, "data": corners[:2]}, [0.9, 0.9], [0, 1, 0]),
    ]:
        domain = "face" if isinstance(attribute, dict) and "face" in attribute else "vertex"
        scene = of_mesh({**SQUARE, "attributes": {"color": attribute}})
        scene["materials"]["clay"]["reflectance"] = {"texture": "mesh_attribute", "name": "color"}
        view = {"look_at": [*at, 0], "from": [*at, 4]}
        scene["camera"] = {"camera": "orthographic", "to_world": view, "screen_window": [-1e-3, 1e-3, -1e-3, 1e-3]}
        scene = st.scene(scene)
        assert scene["sheet"].attributes["color"][0] == domain
        hit = scene.render(spp=1, size=(4, 4), layers=["albedo"]).layer("albedo")[2, 2]
        assert np.allclose(hit, seen, atol=0.02), (attribute, hit)


def test_transforms_are_matrices():
    matrix = np.array([[0, -2, 0, 1], [2, 0, 0, 0], [0, 0, 2, -1], [0, 0, 0, 1.0]])
    for given in [matrix, matrix.tolist(), tuple(map(tuple, matrix)), {"matrix": matrix.ravel()}]:
        scene = st.scene(of_mesh(SQUARE, to_world=given))
        assert np.array_equal(scene["sheet"].to_world, matrix)
    # A point of the square goes where the matrix says.
    hits = scene.trace(matrix[:3, :3] @ [0.25, 0.5, 0] + matrix[:3, 3] + [0, 0, 3], [0, 0, -1])
    assert hits.t == pytest.approx(3) and np.allclose(hits.geometric_normal, [0, 0, 1])
    scene = st.scene(BALL)
    camera = np.diag([1.0, 1, -1, 1])
    camera[2, 3] = 4
    scene["front"]["to_world"] = camera
    assert np.array_equal(np.reshape(scene["front"]["to_world"]["matrix"], (4, 4)), camera)


@pytest.mark.parametrize(("parts", "said"), [
    ({"positions": np.zeros((4, 2))}, r"'shapes.sheet.mesh.positions' has the shape \(4, 2\), where \(n, 3\) is needed"),
    ({"positions": np.zeros(4)}, r"positions' has the shape \(4,\), where \(n, 3\)"),
    ({"positions": SQUARE["positions"] * 1j}, "positions' has the dtype complex"),
    ({"positions": [[0, 0, 0], [1, 0]]}, "positions' is no array"),
    ({"positions": np.full((4, 3), np.nan)}, "the position of vertex 0 is not a finite number"),
    ({"triangles": SQUARE["triangles"] * 1.0}, "triangles' has the dtype float64, where whole numbers are needed"),
    ({"triangles": np.array([[0, 1, -2]])}, "triangles' has the index -2"),
    ({"triangles": np.array([[0, 1, 9]])}, "refers to vertex 9"),
    ({"triangles": np.zeros((1, 4), int)}, r"triangles' has the shape \(1, 4\), where \(n, 3\)"),
    ({"normals": np.ones((3, 3))}, "normals: 3 values where 4 are needed"),
    ({"uvs": np.ones((4, 3))}, r"uvs' has the shape \(4, 3\), where \(n, 2\)"),
    ({"faces": SQUARE["triangles"]}, "has 'faces'; the parts of a mesh are positions, .* triangles"),
    ({"attributes": {"color": np.ones((4, 5))}}, r"attributes.color' has the shape \(4, 5\), where \(n, 1 to 4\)"),
    ({"attributes": {"color": np.ones((3, 3))}}, "attribute 'color': 9 values where 12 are needed"),
    ({"attributes": {"color": {"vertices": 3, "data": []}}}, "attributes.color' is written"),
])
def test_wrong_meshes_are_told_by_name_and_shape(parts, said):
    with pytest.raises(st.SceneError, match=said):
        st.scene(of_mesh({**SQUARE, **parts}))
    scene = st.scene(of_mesh(SQUARE))
    with pytest.raises(st.SceneError, match=said.replace("shapes.sheet.mesh", "sheet")):
        scene["sheet"].set_mesh(**parts)
    assert np.array_equal(scene["sheet"].positions, SQUARE["positions"])


@pytest.mark.parametrize(("value", "said"), [
    (np.ones(2), "'reflectance' takes a colour of 3 numbers, not a list of 2"),
    ([0.1, 0.2, 0.3, 0.4], "'reflectance' takes a colour of 3 numbers, not a list of 4"),
    (np.ones((3, 3)), r"clay.reflectance' has the shape \(3, 3\), where \(3,\) for a colour"),
    (np.array(["red"]), "clay.reflectance' has the dtype <U3, where numbers are needed"),
    (float("nan"), "clay.reflectance' is nan, where a finite number"),
    (np.array([1, np.inf, 1]), "clay.reflectance' has numbers that are not finite"),
    ({1, 2}, "clay.reflectance' is a set, which has no place in a scene"),
    ({"rgb": np.ones((1, 3))}, r"clay.reflectance.rgb' has the shape \(1, 3\)"),
])
def test_wrong_values_are_told_by_name_and_shape(value, said):
    with pytest.raises(st.SceneError, match=said):
        st.scene({**BALL, "materials": {"clay": {"material": "diffuse", "reflectance": value}}})
    scene = st.scene(BALL)
    with pytest.raises(st.SceneError, match=said):
        scene["clay"]["reflectance"] = value
    with pytest.raises(st.SceneError, match=said):
        scene.params()["clay.reflectance"] = value
    assert scene["clay"]["reflectance"] == {"rgb": [0.7, 0.3, 0.2]}


def test_an_edit_of_vertices_is_rendered():
    scene = st.scene(of_mesh(SQUARE))
    sheet = scene["sheet"]
    before = np.asarray(scene.render(spp=2))
    sheet.positions = sheet.positions * [0.5, 1, 1]
    after = np.asarray(scene.render(spp=2))
    fresh = np.asarray(st.scene(of_mesh({**SQUARE, "positions": SQUARE["positions"] * [0.5, 1, 1]})).render(spp=2))
    assert np.array_equal(after, fresh) and not np.array_equal(before, after)
    # More vertices: all arrays together.
    sheet.set_mesh(positions=np.vstack([SQUARE["positions"], [[0.5, 0.5, 1]]]), triangles=[[0, 1, 4]])
    assert sheet.triangles.tolist() == [[0, 1, 4]] and len(sheet.positions) == 5
    sheet.normals = np.tile([0.0, 0, 1], (5, 1))
    sheet.uvs = sheet.positions[:, :2]
    assert sheet.normals.shape == (5, 3) and sheet.uvs.shape == (5, 2)
    sheet.normals = None
    assert sheet.normals.shape == (0, 3) and sheet.patches.shape == (0, 4)
    with pytest.raises(ValueError, match="read-only"):
        sheet.positions[0] = 1
    sheet.to_world = np.diag([1, 1, 1, 1.0]) + np.eye(4, k=3) * 7
    assert not scene.trace([0.5, 0.25, 5], [0, 0, -1]).hit and scene.trace([7.5, 0.25, 5], [0, 0, -1]).hit
    with pytest.raises(st.SceneError, match=r"'sheet.to_world' has the shape \(3, 4\)"):
        sheet.to_world = np.eye(4)[:3]
    with pytest.raises(st.SceneError, match="'sheet' has no inverse"):
        sheet.to_world = np.zeros((4, 4))
    with pytest.raises(AttributeError, match="'clay' is a material, which has no mesh"):
        scene["clay"].positions
    assert not hasattr(scene["sky"], "to_world")


def test_a_mesh_of_many_vertices_is_read_as_it_is():
    n = 300
    x, y = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n))
    k = np.arange(n * n).reshape(n, n)
    corners = [k[:-1, :-1], k[:-1, 1:], k[1:, :-1], k[1:, 1:]]
    triangles = np.concatenate([np.stack([corners[i].ravel() for i in t], -1) for t in [(0, 1, 2), (1, 3, 2)]])
    scene = st.scene(of_mesh({"positions": np.stack([x, y, 0 * x], -1).reshape(-1, 3), "triangles": triangles}))
    hits = scene.trace(np.stack([x, y, 0 * x + 1], -1)[1:-1, 1:-1] + 1e-4, [0, 0, -1])
    assert hits.hit.all() and len(scene["sheet"].triangles) == 2 * (n - 1) ** 2
    inside = scene["sheet"].positions[scene["sheet"].triangles[hits.primitive]]
    assert (np.abs(inside[..., :2].mean(-2) - hits.position[..., :2]) < 1 / (n - 1)).all(), "triangles are counted as they were given"
