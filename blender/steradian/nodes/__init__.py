"""Node trees of Blender as materials of the scene language.

`material(material, context)` gives an entry of a scene's "materials", with what its shapes need beside: `emission` (a
light of kind area), `interior` (a medium), `alpha` (opacity), `displacement` and its factors. The context has
`report(name, text)`, which hears what is approximated or left out by the node's name; `image(image)`, the file of a
picture; `uv_map`, the name of the active UV map; `attributes`, a set that gets the names of vertex attributes in use;
and by choice `object`, whose coordinates Generated and Object are; else those are of the first object that has the
material (`depends_on_object`).
"""

from __future__ import annotations

from . import arithmetic, closures, colours, coordinates, principled, textures, volumes  # noqa: F401 (they register nodes)
from . import values as v
from .lights import light_colour, world_colour
from .normals import displacement
from .reader import Reader
from .surface import BLACK
from .tree import Here, output_node

__all__ = ["depends_on_object", "light_colour", "material", "world_colour"]

OBJECT_NODES = {
    "ShaderNodeObjectInfo": None,
    "ShaderNodeTexCoord": ("Generated", "Object"),
    "ShaderNodeTexNoise": (),
    "ShaderNodeTexVoronoi": (),
    "ShaderNodeTexWave": (),
    "ShaderNodeTexMagic": (),
    "ShaderNodeTexBrick": (),
    "ShaderNodeTexChecker": (),
    "ShaderNodeTexGradient": (),
}


def material(material, context) -> dict:
    """The entry of a material."""
    tree = material.node_tree
    end = output_node(tree) if tree else None
    if end is None:
        return {"material": "diffuse", "reflectance": list(material.diffuse_color[:3])}
    reader = Reader(material.name, context, material)
    here = Here(reader, end)
    found, inside = reader.surface(here, "Surface"), reader.volume(here, "Volume")
    has_surface = here.is_linked("Surface")
    entry = dict(found.material or (BLACK if has_surface else {"material": "interface"}))
    moved = displacement(here, material)
    if "bump" in moved and "bump" in entry:
        reader.tell(None, "a bump and a displacement as bump: the first is taken")
        moved.pop("bump")
    entry.update(moved)
    if found.emits and has_surface:
        entry["emission"] = {"light": "area", "radiance": v.scene(v.as_colour(found.emission)), "two_sided": True}
    if found.opacity != 1.0:
        entry["alpha"] = v.scene(found.opacity)
    if inside is not None:
        entry["interior"] = volumes.entry(inside)
    return entry


def depends_on_object(tree) -> bool:
    """True if a tree looks at coordinates or numbers of the object that is shaded, so that objects cannot share it."""
    for node in tree.nodes if tree else ():
        if node.bl_idname == "ShaderNodeGroup" and depends_on_object(node.node_tree):
            return True
        if node.bl_idname not in OBJECT_NODES:
            continue
        outputs = OBJECT_NODES[node.bl_idname]
        if outputs == () and not node.inputs["Vector"].is_linked:
            return True
        if outputs is None and any(s.is_linked for s in node.outputs):
            return True
        if outputs and any(node.outputs[k].is_linked for k in outputs):
            return True
    return False
