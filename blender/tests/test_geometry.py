"""Meshes, instances and hair as the exporter reads them."""

import bpy
import common
import numpy as np
from blend import both, exported, rendered


def meshes(description):
    return description["meshes"]


def test_a_cube_has_its_corners_apart_and_a_smooth_ball_shares_its_vertices():
    common.empty()
    common.shape("cube", size=2)
    found, _ = exported()
    (cube,) = meshes(found.description).values()
    assert len(cube["triangles"]) == 12 and len(cube["positions"]) == 24
    faces = cube["positions"][cube["triangles"]]
    geometric = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    shading = cube["normals"][cube["triangles"]]
    assert np.allclose(shading, (geometric / np.linalg.norm(geometric, axis=1, keepdims=True))[:, None], atol=1e-6)

    common.empty()
    common.shape("ico_sphere", smooth=True, subdivisions=3, calc_uvs=False)
    found, _ = exported()
    (ball,) = meshes(found.description).values()
    assert len(ball["positions"]) == 162 and len(ball["triangles"]) == 320
    assert np.allclose(ball["normals"], ball["positions"], atol=0.02)


def test_a_sharp_edge_parts_the_normals_of_a_smooth_mesh():
    common.empty()
    thing = common.shape("cube", smooth=True, size=2, calc_uvs=False)
    (soft,) = meshes(exported()[0].description).values()
    assert len(soft["positions"]) == 8
    for edge in thing.data.edges:
        edge.use_edge_sharp = True
    thing.data.update_tag()
    (hard,) = meshes(exported()[0].description).values()
    assert len(hard["positions"]) == 24
    assert set(map(tuple, np.abs(hard["normals"]).round(5))) == {(1, 0, 0), (0, 1, 0), (0, 0, 1)}


def test_coordinates_colours_and_faces_keep_their_corners():
    common.empty()
    thing = common.shape("plane", size=2)
    colour = thing.data.color_attributes.new("Paint", "FLOAT_COLOR", "CORNER")
    for k, item in enumerate(colour.data):
        item.color = (k, 0, 0, 1)
    mark = thing.data.attributes.new("Mark", "INT", "FACE")
    mark.data[0].value = 7
    (plane,) = meshes(exported()[0].description).values()
    assert np.allclose(plane["uvs"], plane["positions"][:, :2] / 2 + 0.5)
    assert np.array_equal(plane["uvs"], plane["attributes"]["UVMap"])
    of_vertex = {tuple(p): c[0] for p, c in zip(plane["positions"].round(4), plane["attributes"]["Paint"])}
    corners = [tuple(np.round(thing.data.vertices[loop.vertex_index].co, 4)) for loop in thing.data.loops]
    assert [of_vertex[corner] for corner in corners] == [0, 1, 2, 3]
    assert plane["attributes"]["Mark"]["data"].tolist() == [[7], [7]]


def test_slots_are_shapes_of_their_own_and_modifiers_count():
    common.empty()
    thing = common.shape("cube", common.matte("A", (1, 0, 0)), size=2)
    thing.data.materials.append(common.matte("B", (0, 1, 0)))
    thing.data.polygons[2].material_index = 1
    found, _ = exported()
    shapes = found.description["shapes"]
    assert len(shapes) == 2 and {shape["material"] for shape in shapes.values()} == {"A", "B"}
    assert sorted(len(mesh["triangles"]) for mesh in meshes(found.description).values()) == [2, 10]
    thing.modifiers.new("Subdivision", "SUBSURF").levels = 2
    found, _ = exported()
    assert sum(len(mesh["triangles"]) for mesh in meshes(found.description).values()) == 6 * 16 * 2


def test_text_and_surfaces_are_read_too():
    common.empty()
    curve = bpy.data.curves.new("Word", "FONT")
    curve.body, curve.extrude = "ab", 0.1
    common.put("Word", curve)
    found, _ = exported()
    assert sum(len(mesh["triangles"]) for mesh in meshes(found.description).values()) > 50


def test_instances_share_one_mesh():
    import instances

    instances.build(60)
    found, _ = exported()
    description = found.description
    assert len(description["instances"]) == 60
    assert len(description["groups"]) == 3 and len(meshes(description)) == 4
    places = [thing.matrix_world.translation for thing in bpy.data.objects if thing.instance_type == "COLLECTION"]
    given = np.array(sorted(tuple(row["to_world"][:3, 3].round(4)) for row in description["instances"]))
    assert np.allclose(given, sorted(tuple(np.round(place, 4)) for place in places), atol=1e-4)


def test_geometry_nodes_give_instances():
    common.empty()
    thing = common.shape("grid", size=4, x_subdivisions=5, y_subdivisions=5)
    tree = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    begin, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    on, cube = tree.nodes.new("GeometryNodeInstanceOnPoints"), tree.nodes.new("GeometryNodeMeshCube")
    tree.links.new(begin.outputs[0], on.inputs["Points"])
    tree.links.new(cube.outputs["Mesh"], on.inputs["Instance"])
    tree.links.new(on.outputs[0], end.inputs[0])
    thing.modifiers.new("Scatter", "NODES").node_group = tree
    found, _ = exported()
    assert len(found.description["instances"]) == 36 and len(meshes(found.description)) == 1


def test_a_mesh_turned_inside_out_by_its_scale_looks_the_same():
    pictures = []
    for scale in ((1, 1, 1), (-1, 1, 1)):
        common.empty((24, 24))
        common.world((0.5, 0.5, 0.5), 1.0)
        glass = common.principled("Glass", transmission_weight=1.0, roughness=0.3)
        common.shape("uv_sphere", glass, smooth=True).scale = scale
        common.shape("plane", common.matte("Red", (0.8, 0.1, 0.1)), location=(0, 2, 0), rotation=(1.57, 0, 0))
        common.camera((0, -5, 0), (0, 0, 0))
        pictures.append(rendered("STERADIAN", 64))
    assert np.allclose(*(picture.mean((0, 1)) for picture in pictures), rtol=0.003)


def test_strands_are_tubes_around_their_points():
    import hair

    hair.build(50, 4)
    (fur,) = [shape for shape in exported()[0].description["shapes"].values() if shape["material"] == "Hair"]
    tubes = fur["mesh"]
    rings = tubes["positions"].reshape(50, 7, 12, 3)
    points = np.array([[point.position for point in curve.points] for curve in bpy.data.objects["Fur"].data.curves])
    assert np.allclose(rings.mean(axis=2)[:, ::2], points, atol=1e-5)
    faces = tubes["positions"][tubes["triangles"]]
    geometric = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    assert ((geometric * tubes["normals"][tubes["triangles"]].sum(axis=1)).sum(axis=1) > 0).all()


def test_strands_of_a_hair_material_are_curves():
    import hair

    hair.build(50, 4)
    fur = bpy.data.objects["Fur"]
    fur.data.materials[0] = material = bpy.data.materials.new("Strands")
    nodes = common.tree(material).nodes
    nodes.clear()
    node, out = nodes.new("ShaderNodeBsdfHairPrincipled"), nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(node.outputs[0], out.inputs["Surface"])
    strands = [shape for shape in exported()[0].description["shapes"].values() if shape["shape"] == "curve"]
    assert len(strands) == 50 and all(len(strand["points"]) == 3 * (3 * 3 + 1) for strand in strands)
    assert np.isclose(strands[0]["width0"], 0.018) and np.isclose(strands[0]["width1"], 0.002)
    at = np.array([strand["points"][:3] for strand in strands])
    assert np.allclose(at, [list(curve.points[0].position) for curve in fur.data.curves], atol=1e-6)


def test_a_strand_is_lit_as_in_cycles():
    common.empty((24, 8))
    common.lamp("SUN", 3, rotation=(90, 0, 60), angle=0.0)
    data = bpy.data.hair_curves.new("Strand")
    data.add_curves([4])
    data.position_data.foreach_set("vector", np.array([[0, 0, z] for z in (-3, -1, 1, 3)], np.float32).ravel())
    radius = data.attributes.get("radius") or data.attributes.new("radius", "FLOAT", "POINT")
    radius.data.foreach_set("value", np.full(4, 0.5, np.float32))
    data.materials.append(common.matte("White", (0.8, 0.8, 0.8)))
    common.put("Strand", data)
    eye = common.camera((0, -5, 0), (0, 0, 0))
    eye.data.type, eye.data.ortho_scale = "ORTHO", 1.2
    a, b = both(32)
    assert np.isclose(a.mean(), b.mean(), rtol=0.05)
    assert np.abs(a - b).mean() < 0.06 * b.mean()


def test_particle_hair_is_strands_in_the_world():
    common.empty()
    thing = common.shape("uv_sphere", common.matte("Skin", (1, 1, 1)), location=(3, 0, 0))
    thing.modifiers.new("Hair", "PARTICLE_SYSTEM")
    how = thing.particle_systems[0].settings
    how.type, how.count, how.hair_length = "HAIR", 20, 0.5
    (strands,) = [
        shape["mesh"] for shape in exported()[0].description["shapes"].values() if isinstance(shape["mesh"], dict)
    ]
    far = np.linalg.norm(strands["positions"] - (3, 0, 0), axis=1)
    assert np.isclose(far.min(), 1, atol=0.05) and far.max() > 1.3


def test_what_is_left_out_is_told_once_by_name():
    common.empty()
    for k in range(2):
        thing = common.shape("cube", location=(k, 0, 0))
        thing.name, thing.visible_glossy = f"Box {k}", False
    _, lines = exported()
    assert [line.split(":")[0] for line in lines] == ["Box 0", "Box 1"] and "glossy" in lines[0]
