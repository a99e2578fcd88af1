"""Node trees become dictionaries that the renderer reads, and look as by Cycles."""

import math
import pathlib
import sys

import pytest

bpy = pytest.importorskip("bpy", reason="Blender's module bpy is not installed: its node trees are not tested")
np = pytest.importorskip("numpy")

# The folder of the extension has the name of the module.
ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path[:] = [p for p in sys.path if pathlib.Path(p or ".").resolve() != ROOT]
st = pytest.importorskip("steradian")
sys.path[:0] = [str(ROOT / "steradian")]
sys.path.append(str(ROOT))
import nodes  # noqa: E402
import principled as compared  # noqa: E402
from nodes import metal  # noqa: E402
from nodes.colours import blackbody  # noqa: E402
from least import Context  # noqa: E402
from nodes.principled import ior_of_f0, mean_free_path  # noqa: E402


class Tree:
    """A material's tree in the making, with its Principled BSDF."""

    def __init__(self):
        self.material = bpy.data.materials.new("tested")
        self.material.use_nodes = True
        self.tree = self.material.node_tree
        self.surface = self.tree.nodes["Principled BSDF"]
        self.end = self.tree.nodes["Material Output"]

    def new(self, kind, tree=None, **inputs):
        """A node with inputs by name: other nodes' outputs or values."""
        node = (tree or self.tree).nodes.new(f"ShaderNode{kind}")
        self.give(node, tree=tree, **inputs)
        return node

    def give(self, node, tree=None, **inputs):
        for key, value in inputs.items():
            socket = self.socket(node, key)
            if isinstance(value, bpy.types.NodeSocket):
                (tree or self.tree).links.new(socket, value)
            else:
                socket.default_value = value
        return node

    @staticmethod
    def socket(node, key):
        key = key.replace("_", " ") if all(s.identifier != key for s in node.inputs) else key
        return next((s for s in node.inputs if s.identifier == key), None) or node.inputs[key]

    def math(self, operation, *values, **kind):
        node = self.tree.nodes.new("ShaderNodeMath")
        node.operation = operation
        for socket, value in zip(node.inputs, values):
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(socket, value)
            else:
                socket.default_value = value
        return node.outputs[0]

    def read(self, **more):
        """The entry and what was reported."""
        self.context = Context("UVMap", **more)
        entry = nodes.material(self.material, self.context)
        return entry, dict(self.context.reports)


@pytest.fixture
def tree():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return Tree()


def on_card(entry, at=((0.5, 0.5),)):
    """What a square of coordinates from 0 to 1 emits at points of it, for entries of emission."""
    corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    mesh = {"positions": corners, "triangles": [[0, 1, 2], [0, 2, 3]], "uvs": [c[:2] for c in corners]}
    entry = dict(entry)
    shape = {"shape": "mesh", "mesh": {k: np.array(x) for k, x in mesh.items()}, "emission": entry.pop("emission"),
             "material": "m"}
    camera = {"camera": "orthographic", "screen_window": {"floats": [-0.5, 0.5, -0.5, 0.5]},
              "to_world": [{"scale": [-1, 1, 1]}, {"look_at": [0.5, 0.5, 0], "from": [0.5, 0.5, 3], "up": [0, 1, 0]}]}
    whole = {"materials": {"m": entry}, "shapes": {"card": shape}, "camera": camera, "filter": {"filter": "box"}}
    picture = np.asarray(st.scene(whole).render(spp=16, size=(64, 64)))[..., :3]
    return [picture[min(int((1 - y) * 64), 63), min(int(x * 64), 63)] for x, y in at]


def shows(tree, output, at):
    """The colour of an output at points of a card."""
    glow = tree.new("Emission", Color=output)
    tree.give(tree.end, Surface=glow.outputs[0])
    return on_card(tree.read()[0], at)


def test_a_principled_bsdf_without_links_is_told_nothing(tree):
    entry, told = tree.read()
    assert not told
    assert entry["material"] == "openpbr" and entry["specular_ior"] == 1.5 and entry["specular_roughness"] == 0.5


def test_every_input_of_the_principled_bsdf_is_read(tree):
    changed = {"Normal", "Tangent", "Coat Normal", "Weight", "Subsurface IOR"}
    base = {"Subsurface Weight": 0.5, "Transmission Weight": 0.3, "Coat Weight": 0.5, "Sheen Weight": 0.5, "Anisotropic": 0.5,
            "Emission Strength": 1.0, "Thin Film Thickness": 200.0, "Metallic": 0.2}
    for key, value in base.items():
        tree.surface.inputs[key].default_value = value
    before = tree.read()[0]
    for socket in tree.surface.inputs:
        if socket.identifier in changed:
            continue
        kept = socket.default_value
        kept = tuple(kept) if hasattr(kept, "__len__") else kept
        socket.default_value = tuple(0.5 * c + 0.03 for c in kept) if isinstance(kept, tuple) else 0.7 * kept + 0.04
        assert tree.read()[0] != before, socket.identifier
        socket.default_value = kept
    tree.surface.subsurface_method = "RANDOM_WALK_SKIN"
    assert tree.read()[0] != before


def test_constant_arithmetic_is_folded(tree):
    product = tree.math("MULTIPLY_ADD", 0.5, tree.math("POWER", 0.25, 0.5), 0.125)
    tree.give(tree.surface, Roughness=product)
    entry, told = tree.read()
    assert entry["specular_roughness"] == 0.375 and not told


@pytest.mark.parametrize("operation, values, expected", [
    ("WRAP", (2.75, 1.0, 0.0), 0.75), ("PINGPONG", (0.75, 0.5, 0.0), 0.25), ("SNAP", (0.8, 0.25, 0.0), 0.75),
    ("COMPARE", (0.5, 0.52, 0.1), 1.0), ("DIVIDE", (1.0, 0.0, 0.0), 0.0), ("FLOORED_MODULO", (-0.25, 1.0, 0.0), 0.75),
    ("MODULO", (-0.25, 1.0, 0.0), -0.25), ("LOGARITHM", (8.0, 2.0, 0.0), 3.0), ("SMOOTH_MIN", (1.0, 0.5, 0.0), 0.5),
    ("ARCTAN2", (1.0, 1.0, 0.0), math.pi / 4), ("SQRT", (-1.0, 0.0, 0.0), 0.0), ("LESS_THAN", (0.2, 0.3, 0.0), 1.0),
])
def test_math_has_blenders_conventions(tree, operation, values, expected):
    tree.give(tree.surface, Thin_Film_Thickness=tree.math("ADD", tree.math(operation, *values), 10.0))
    assert tree.read()[0]["thin_film_thickness"] == pytest.approx(expected + 10.0, abs=1e-6)


@pytest.mark.parametrize("mode", [e.identifier for e in bpy.types.ShaderNodeMix.bl_rna.properties["blend_type"].enum_items])
def test_blend_modes_of_constants_are_those_of_cycles(tree, mode):
    a, b, t = (0.2, 0.6, 0.9), (0.7, 0.3, 0.5), 0.6
    mix = tree.new("Mix")
    mix.data_type, mix.blend_type = "RGBA", mode
    tree.give(mix, Factor_Float=t, A_Color=(*a, 1), B_Color=(*b, 1))
    tree.give(tree.surface, Base_Color=mix.outputs[2])
    found = tree.read()[0]["base_color"]
    assert found == pytest.approx(np.clip(cycles_emits(tree, mix.outputs[2]), 0, 1), abs=2e-3)


def cycles_emits(tree, output):
    """The colour that Cycles shows of an output on a card that fills the picture."""
    scene = compared.set_up_here(4)
    glow = tree.new("Emission", Color=output)
    tree.give(tree.end, Surface=glow.outputs[0])
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    compared.quad("card", [(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)], tree.material)
    compared.look(scene, (0, 0, 2), (0, 0, 0), 40.0, 0.0)
    return compared.by_cycles(scene, 1, 0).mean((0, 1))


def test_groups_are_followed_with_their_inputs(tree):
    group = bpy.data.node_groups.new("half", "ShaderNodeTree")
    group.interface.new_socket("Number", in_out="INPUT", socket_type="NodeSocketFloat")
    group.interface.new_socket("Half", in_out="OUTPUT", socket_type="NodeSocketFloat")
    start, end = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    half = group.nodes.new("ShaderNodeMath")
    half.operation = "MULTIPLY"
    half.inputs[1].default_value = 0.5
    group.links.new(half.inputs[0], start.outputs[0])
    group.links.new(end.inputs[0], half.outputs[0])
    first, second = tree.tree.nodes.new("ShaderNodeGroup"), tree.tree.nodes.new("ShaderNodeGroup")
    first.node_tree = second.node_tree = group
    first.inputs[0].default_value = 0.8
    reroute = tree.tree.nodes.new("NodeReroute")
    tree.tree.links.new(reroute.inputs[0], first.outputs[0])
    tree.tree.links.new(second.inputs[0], reroute.outputs[0])
    tree.give(tree.surface, Roughness=second.outputs[0], Metallic=first.outputs[0])
    entry, told = tree.read()
    assert entry["specular_roughness"] == pytest.approx(0.2) and entry["base_metalness"] == pytest.approx(0.4)
    assert not told


def test_muted_nodes_pass_their_input(tree):
    invert = tree.new("Invert", Color=(0.25, 0.5, 0.75, 1.0))
    tree.give(tree.surface, Base_Color=invert.outputs[0])
    assert tree.read()[0]["base_color"] == pytest.approx([0.75, 0.5, 0.25])
    invert.mute = True
    assert tree.read()[0]["base_color"] == pytest.approx([0.25, 0.5, 0.75])


def test_unknown_nodes_are_told_by_name(tree):
    script = tree.new("Script")
    script.name = "My own"
    gabor = tree.new("TexGabor")
    tree.give(tree.surface, Roughness=gabor.outputs["Value"])
    entry, told = tree.read()
    assert "ShaderNodeTexGabor" in told[f"tested: {gabor.name}"] and entry["specular_roughness"] == 0.5
    eevee = tree.new("EeveeSpecular")
    tree.give(tree.end, Surface=eevee.outputs[0])
    entry, told = tree.read()
    assert "ShaderNodeEeveeSpecular" in told[f"tested: {eevee.name}"] and entry["material"] == "diffuse"


def test_formulas_are_evaluated_where_they_stand(tree):
    place = tree.new("TexCoord")
    parts = tree.new("SeparateXYZ", Vector=place.outputs["UV"])
    value = tree.math("GREATER_THAN", tree.math("ADD", parts.outputs[0], parts.outputs[1]), 1.0)
    found = shows(tree, value, [(0.2, 0.3), (0.8, 0.9), (0.7, 0.2)])
    assert [f[0] for f in found] == pytest.approx([0.0, 1.0, 0.0], abs=1e-5)


def test_mappings_move_pictures_and_patterns_alike(tree):
    place = tree.new("TexCoord")
    mapping = tree.new("Mapping", Vector=place.outputs["UV"], Location=(0.25, 0, 0), Scale=(2, 1, 1), Rotation=(0, 0, 0.3))
    image = bpy.data.images.new("ramp", 64, 64, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    u, w = np.meshgrid((np.arange(64) + 0.5) / 64, (np.arange(64) + 0.5) / 64)
    image.pixels.foreach_set(np.stack([u, w, 0 * u, 1 + 0 * u], -1).astype(np.float32).ravel())
    picture = tree.new("TexImage", Vector=mapping.outputs[0])
    picture.image = image
    at = [(0.1, 0.2), (0.15, 0.6), (0.3, 0.35)]
    shown, made = shows(tree, picture.outputs[0], at), shows(tree, mapping.outputs[0], at)
    for point, a, b in zip(at, shown, made):
        x, y = 2 * point[0], point[1]
        expected = x * math.cos(0.3) - y * math.sin(0.3) + 0.25, x * math.sin(0.3) + y * math.cos(0.3)
        assert a[:2] == pytest.approx(expected, abs=0.03) and b[:2] == pytest.approx(expected, abs=0.03), point


def test_colours_are_multiplied_by_components(tree):
    image = bpy.data.images.new("plain", 4, 4, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set(np.tile(np.array([0.8, 0.5, 0.2, 1.0], np.float32), 16))
    picture = tree.new("TexImage")
    picture.image = image
    parts = tree.new("SeparateColor", Color=picture.outputs[0])
    turned = tree.new("CombineColor", Red=parts.outputs[2], Green=parts.outputs[0], Blue=0.5)
    for other, factor in ((turned.outputs[0], (0.2, 0.8, 0.5)), ((0.5, 1.0, 0.25, 1.0), (0.5, 1.0, 0.25))):
        mix = tree.new("Mix")
        mix.data_type, mix.blend_type = "RGBA", "MULTIPLY"
        tree.give(mix, Factor_Float=1.0, A_Color=picture.outputs[0], B_Color=other)
        found = shows(tree, mix.outputs[2], [(0.5, 0.5)])[0]
        assert found == pytest.approx([0.8 * factor[0], 0.5 * factor[1], 0.2 * factor[2]], abs=1e-3)


def test_pictures_stand_upright(tree):
    image = bpy.data.images.new("halves", 8, 8, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    pixels = np.zeros((8, 8, 4), np.float32)
    pixels[4:, :, 0], pixels[..., 3] = 1.0, 1.0
    image.pixels.foreach_set(pixels.ravel())
    picture = tree.new("TexImage")
    picture.image = image
    above, below = shows(tree, picture.outputs[0], [(0.5, 0.9), (0.5, 0.1)])
    assert above[0] > 0.99 and below[0] < 0.01


def test_opacities_and_emission_of_mixes(tree):
    clear, glow = tree.new("BsdfTransparent"), tree.new("Emission", Strength=2.0)
    inner = tree.new("MixShader", Fac=0.5)
    tree.give(inner, Shader=clear.outputs[0], Shader_001=glow.outputs[0])
    outer = tree.new("MixShader", Fac=0.25)
    tree.give(outer, Shader=inner.outputs[0], Shader_001=tree.surface.outputs[0])
    tree.give(tree.end, Surface=outer.outputs[0])
    entry, told = tree.read()
    # 0.375 is clear, 0.375 glows, 0.25 is Principled.
    assert entry["alpha"] == pytest.approx(0.625) and not told
    assert entry["emission"]["radiance"] == pytest.approx([2.0 * 0.375 / 0.625] * 3)
    assert entry["material"] == "mix" and entry["amount"] == pytest.approx(0.25 / 0.625)


def test_sums_keep_energy_or_are_told(tree):
    a, b = tree.new("BsdfDiffuse", Color=(0.2, 0.1, 0.4, 1)), tree.new("BsdfAnisotropic", Color=(0.3, 0.3, 0.3, 1))
    whole = tree.new("AddShader")
    tree.give(whole, Shader=a.outputs[0], Shader_001=b.outputs[0])
    tree.give(tree.end, Surface=whole.outputs[0])
    entry, told = tree.read()
    assert entry["materials"][0]["reflectance"] == pytest.approx([0.4, 0.2, 0.8]) and not told
    a.inputs["Color"].default_value = (0.9, 0.9, 0.9, 1)
    assert "sum" in tree.read()[1]["tested: " + whole.name]


def test_volumes_are_interiors(tree):
    volume = tree.new("VolumePrincipled", Color=(0.5, 0.25, 0.0, 1), Density=4.0, Anisotropy=0.3)
    tree.tree.links.remove(tree.end.inputs["Surface"].links[0])
    tree.give(tree.end, Volume=volume.outputs[0])
    entry, told = tree.read()
    assert entry["material"] == "interface" and not told
    assert entry["interior"]["sigma_s"] == [2.0, 1.0, 0.0] and entry["interior"]["sigma_a"] == [2.0, 3.0, 4.0]
    assert entry["interior"]["g"] == pytest.approx(0.3)


def test_bumps_and_normal_maps(tree):
    checks = tree.new("TexChecker", Vector=tree.new("TexCoord").outputs["UV"])
    bump = tree.new("Bump", Height=checks.outputs["Fac"], Distance=0.1, Strength=0.5)
    normal = tree.new("NormalMap", Color=(0.6, 0.5, 0.9, 1.0), Strength=0.5)
    tree.give(bump, Normal=normal.outputs[0])
    tree.give(tree.surface, Normal=bump.outputs[0], Coat_Weight=1.0, Coat_Normal=normal.outputs[0])
    entry, _ = tree.read()
    assert entry["normal_map_strength"] == 0.5 and "bump" in entry and "coat_normal_map" in entry


def test_generated_coordinates_are_those_of_the_object(tree):
    corners = [(0, 0, 1), (4, 0, 1), (4, 2, 1), (0, 2, 1)]
    card = compared.quad("card", corners, tree.material)
    card.location = (1, 0, 0)
    bpy.context.view_layer.update()
    parts = tree.new("SeparateXYZ", Vector=tree.new("TexCoord").outputs["Generated"])
    glow = tree.new("Emission", Color=parts.outputs[0])
    tree.give(tree.end, Surface=glow.outputs[0])
    for more in ({}, {"thing": card}):
        entry, told = tree.read(**more)
        place = np.array(entry["emission"]["radiance"]["texture_from_world"]["matrix"]).reshape(4, 4)
        assert place @ (1, 0, 1, 1) == pytest.approx((0, 0, 0.5, 1)) and place @ (5, 2, 1, 1) == pytest.approx((1, 1, 0.5, 1))
        assert not told
    assert nodes.depends_on_object(tree.tree)
    compared.placed("twin", card.data, tree.material)
    assert "card" in tree.read()[1]["tested"] or "twin" in tree.read()[1]["tested"]


def test_lights_and_worlds_have_the_colour_of_their_trees():
    lamp = bpy.data.lights.new("lamp", "POINT")
    lamp.use_nodes = True
    glow = lamp.node_tree.nodes["Emission"]
    body = lamp.node_tree.nodes.new("ShaderNodeBlackbody")
    body.inputs[0].default_value = 6500.0
    lamp.node_tree.links.new(glow.inputs["Color"], body.outputs[0])
    glow.inputs["Strength"].default_value = 3.0
    found = nodes.light_colour(lamp, Context())
    assert found == pytest.approx(tuple(3.0 * c for c in blackbody(6500.0))) and abs(found[0] / found[2] - 1) < 0.1
    world = bpy.data.worlds.new("world")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.1, 0.2, 0.3, 1)
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 2.0
    assert nodes.world_colour(world, Context()) == pytest.approx((0.2, 0.4, 0.6))


def test_indices_and_mean_free_paths_of_cycles():
    assert ior_of_f0(0.04) == pytest.approx(1.5) and ior_of_f0(0.0) == 1.0
    assert mean_free_path(0.0, 1.4) > mean_free_path(0.5, 1.4) > mean_free_path(0.99, 1.4) > 0


def test_conductors_have_the_mean_reflectance_of_f82():
    for tint, within in ((1.0, 0.02), (0.4, 0.13)):
        n, k = metal.table(tint)
        means = metal.reflectance(n[:, None], k[:, None] ** 2, metal.DIRECTIONS).mean(1)
        assert np.abs(means - metal.mean_f82(metal.BASES, tint)).max() < 2e-3
        assert np.abs(metal.reflectance(n, k * k, 1.0) - metal.BASES).max() < within


PATTERNS = ["TexChecker", "TexWave", "TexGradient", "TexMagic", "radial"]


@pytest.mark.parametrize("kind", PATTERNS)
def test_patterns_that_are_formulas_look_as_by_cycles(tree, kind):
    settings = {}
    if kind == "radial":
        kind, settings = "TexGradient", {"gradient_type": "RADIAL"}
    place = tree.new("TexCoord")
    mapping = tree.new("Mapping", Vector=place.outputs["UV"], Rotation=(0, 0, 0.4), Location=(0.1, 0.05, 0.3))
    pattern = tree.new(kind, Vector=mapping.outputs[0])
    for key, value in settings.items():
        setattr(pattern, key, value)
    if "Scale" in pattern.inputs:
        pattern.inputs["Scale"].default_value = 2.0
    theirs, ours = both_cards(tree, pattern.outputs["Color"])
    assert np.abs(theirs - ours).mean() < 0.015 and abs(theirs.mean() - ours.mean()) < 0.003


def test_bricks_lie_where_those_of_cycles_do(tree):
    place = tree.new("TexCoord")
    bricks = tree.new("TexBrick", Vector=place.outputs["UV"], Scale=2.0)
    theirs, ours = both_cards(tree, bricks.outputs["Fac"])
    assert np.abs(theirs - ours).mean() < 0.01


@pytest.mark.parametrize("kind, output", [("TexNoise", "Color"), ("TexVoronoi", "Color"), ("TexVoronoi", "Distance")])
def test_patterns_of_other_random_numbers_have_their_mean_and_spread(tree, kind, output):
    pattern = tree.new(kind, Scale=20.0)
    theirs, ours = both_cards(tree, pattern.outputs[output])
    assert ours.mean() == pytest.approx(theirs.mean(), rel=0.06) and ours.std() == pytest.approx(theirs.std(), rel=0.15)


def both_cards(tree, output, size=32):
    """A card that shows an output, by both renderers."""
    scene = compared.set_up_here(size)
    glow = tree.new("Emission", Color=output)
    tree.give(tree.end, Surface=glow.outputs[0])
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    compared.quad("card", [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], tree.material)
    view = (0, 0, 3), (0, 0, 0), 35.0, 0.0
    compared.look(scene, *view)
    ours = st.scene(compared.description(*view, set()))
    return compared.by_cycles(scene, 64, 1), np.asarray(ours.render(spp=64, size=(size, size)))[..., :3]


# Bounds in percent of the mean, for the picture and for a region.
SURFACES = [
    ({}, 0.5, 3.0),
    ({"Base Color": (0.8, 0.1, 0.05), "Roughness": 0.2}, 0.8, 7.0),
    ({"Metallic": 1.0, "Roughness": 0.1}, 0.5, 3.0),
    ({"Alpha": 0.4, "Emission Strength": 0.5}, 0.5, 3.0),
    ({"Transmission Weight": 1.0, "Roughness": 0.0, "Base Color": (0.5, 0.8, 0.6)}, 1.0, 6.0),
    ({"Specular IOR Level": 1.0, "Specular Tint": (1.0, 0.4, 0.2)}, 0.8, 4.0),
]


@pytest.mark.parametrize("values, mean, region", SURFACES)
def test_the_principled_bsdf_looks_as_by_cycles(values, mean, region):
    theirs, ours, _ = compared.pictures("ball", values, spp=128, size=32, seeds=2)
    of_mean, of_region, _ = compared.figures(theirs, ours)
    assert abs(of_mean) < mean and of_region < region
