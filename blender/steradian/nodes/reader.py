"""One reading of a tree: values of sockets, each evaluated once, and reports by the node's name."""

from __future__ import annotations

import math

from . import values as v
from .registry import SURFACES, VALUES, VOLUMES
from .surface import Surface
from .tree import Here

UNKNOWN = 0.5


class Reader:
    """Evaluates the nodes of one material, world or light."""

    def __init__(self, owner: str, context, material=None):
        self.owner, self.context, self.material = owner, context, material
        self._known: dict = {}
        self._told: set = set()

    def tell(self, node, text: str):
        """Reports once for each node and text."""
        name = f"{self.owner}: {node.label or node.name}" if node is not None else self.owner
        if (name, text) not in self._told:
            self._told.add((name, text))
            self.context.report(name, text)

    def evaluate(self, found, kind: str):
        """The value of a source."""
        if found is None:
            return None
        if not found.is_linked:
            own = getattr(found.socket, "default_value", None)
            if own is None or isinstance(own, str):
                return None
            return tuple(float(c) for c in own)[:3] if hasattr(own, "__len__") else float(own)
        key = (found.node.as_pointer(), tuple(g.as_pointer() for g in found.groups), found.socket.identifier)
        if key not in self._known:
            self._known[key] = self._evaluated(found)
        return self._known[key]

    def _evaluated(self, found):
        here = Here(self, found.node, found.groups)
        function = VALUES.get(found.node.bl_idname)
        if function is None:
            self.tell(found.node, f"nodes of kind {found.node.bl_idname} are not known: 0.5 is taken")
            return UNKNOWN
        return function(here, found.socket.identifier)

    def number(self, here, key, default=0.0):
        found = here.source(key)
        value = self.evaluate(found, "number")
        if value is None:
            return default
        return v.as_number(value, found.socket.type != "VECTOR")

    def colour(self, here, key, default=(0.0, 0.0, 0.0)):
        value = self.evaluate(here.source(key), "colour")
        return default if value is None else v.as_colour(value)

    def constant(self, here, key, default=0.0) -> float:
        value = self.number(here, key, default)
        if isinstance(value, v.Field):
            here.tell(f"'{key}' does not vary here: the middle of its range, {value.middle:.3g}, is taken")
            value = value.middle
        return value if math.isfinite(value) else default

    def context_object(self, base: str = "object"):
        """The object that a space belongs to: the one that is named, or shaded, or the first that has the material."""
        import bpy

        if base.startswith("object:"):
            return bpy.data.objects.get(base[len("object:"):])
        shaded = getattr(self.context, "object", None)
        if shaded is not None or self.material is None:
            return shaded
        users = [o for o in bpy.data.objects if any(s.material == self.material for s in o.material_slots)]
        if len(users) > 1:
            self.tell(None, f"{len(users)} objects share coordinates or numbers of their own: those of '{users[0].name}' count")
        return users[0] if users else None

    def surface(self, here, key):
        """The closure that feeds a shader input."""
        found = here.source(key)
        if found is None or not found.is_linked:
            return Surface()
        inner = Here(self, found.node, found.groups)
        function = SURFACES.get(found.node.bl_idname)
        if function is None:
            self.tell(found.node, f"shaders of kind {found.node.bl_idname} are not known: grey diffuse reflection is taken")
            return Surface({"material": "diffuse", "reflectance": 0.5})
        return function(inner)

    def volume(self, here, key):
        """The coefficients of the medium that feeds a volume input; `None` without one."""
        found = here.source(key)
        if found is None or not found.is_linked:
            return None
        function = VOLUMES.get(found.node.bl_idname)
        if function is None:
            self.tell(found.node, f"volumes of kind {found.node.bl_idname} are not known: there is none")
            return None
        return function(Here(self, found.node, found.groups))
