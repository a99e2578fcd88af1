"""Names of nodes in compiled scenes."""

import blend
import numpy as np
import steradian

names = blend.addon.load("export.names")
edit = blend.addon.load("export.edit")
TRIANGLE = {"positions": np.eye(3), "triangles": np.array([[0, 1, 2]])}


def described(height=0.0):
    """Shapes, materials and lights that share their names."""
    mesh = {"shape": "mesh", "mesh": "m"}
    place = np.eye(4)
    place[2, 3] = height
    return {
        "nodes": {"Lamp": {"light": "area", "radiance": 1.0}},
        "materials": {"Cube": {"material": "diffuse", "reflectance": 0.1}, "Cube#3": {"material": "diffuse", "reflectance": 0.3}},
        "lights": {"Lamp#2": {"light": "point", "intensity": 2.0}},
        "meshes": {"m": TRIANGLE},
        "groups": {"g": {"Cube#4": {**mesh, "material": "Cube"}}},
        "shapes": {"Cube#5": {**mesh, "material": "Cube#3", "to_world": place}},
        "instances": [{"group": "g", "to_world": np.eye(4)}],
    }


def test_names_are_found_though_they_are_counted_anew():
    description = described()
    scene = steradian.scene(description)
    found = names.resolved(description, scene.nodes)
    assert scene[found["materials", "Cube#3"]]["reflectance"] == 0.3
    assert scene[found["lights", "Lamp#2"]]["intensity"] == 2.0
    assert scene[found["nodes", "Lamp"]]["radiance"] == 1.0


def test_an_edit_moves_the_shape_and_not_its_namesake_in_a_group():
    old, new = described(), described(5.0)
    scene = steradian.scene(old)
    changes = edit.edits(old, new)
    assert [change[:3] for change in changes] == [("shapes", "Cube#5", "to_world")]
    assert edit.apply(scene, new, changes)
    hits = scene.trace([[0.33, 0.33, 20.0]], [[0, 0, -1.0]])
    assert np.isclose(hits.position[0, 2], 5.34, atol=0.01)


def test_what_comes_goes_or_changes_its_kind_is_no_edit():
    old = described()
    for change in ({"shapes": {}}, {"lights": {"Lamp#2": {"light": "distant"}}}, {"instances": []}):
        assert edit.edits(old, {**old, **change}) is None
    assert edit.edits(old, described()) == []


def test_names_are_unique_and_keep_what_is_before_the_mark():
    name = names.Names()
    assert [name("Cube"), name("Cube"), name("a#b"), name("")] == ["Cube", "Cube#2", "a♯b", "unnamed"]
