"""The sections of a description while it is made, and the interface that node trees are translated through."""

from __future__ import annotations

from typing import Any

import bpy

from .image import Images
from .lamps import Lamp
from .names import Names
from .report import Report


class Context:
    """A description in the making: `sections` is a dictionary for `steradian.scene`."""

    def __init__(self, depsgraph: bpy.types.Depsgraph, report: Report, images: Images):
        self.depsgraph, self.report, self.images = depsgraph, report, images
        self.sections: dict[str, dict[str, Any]] = {
            name: {}
            for name in ("nodes", "textures", "materials", "media", "cameras", "lights", "meshes", "groups", "shapes")
        }
        self.instances: list[dict[str, Any]] = []
        self.name = Names()
        self.uv_map: str | None = None
        self.object: bpy.types.Object | None = None
        self.attributes: set[str] = set()
        self.sun_distance = 1e4
        self.clear: str | None = None
        self.surfaces: dict[Any, dict[str, Any]] = {}
        self.lamps: list[Lamp] = []
        self.emitters: list[str] = []

    def add(self, section: str, name: str, entry: dict[str, Any]) -> str:
        """Puts an entry into a section under a name like `name`, which is returned."""
        name = self.name(name)
        self.sections[section][name] = entry
        return name

    def texture(self, name: str, entry: dict[str, Any]) -> str:
        """Adds a texture; its name."""
        return self.add("textures", name, entry)

    def material(self, name: str, entry: dict[str, Any]) -> str:
        """Adds a material; its name."""
        return self.add("materials", name, entry)

    def medium(self, name: str, entry: dict[str, Any]) -> str:
        """Adds a medium; its name."""
        return self.add("media", name, entry)

    def image(self, image: bpy.types.Image) -> str | None:
        """File of a picture, or None where there is none."""
        return self.images.path(image, self.report)

    def description(self) -> dict[str, Any]:
        """The dictionary for `steradian.scene`: sections that have entries."""
        whole: dict[str, Any] = {name: entries for name, entries in self.sections.items() if entries}
        if self.instances:
            whole["instances"] = self.instances
        return whole
