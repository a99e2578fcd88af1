"""A context of the least that reading node trees needs: for tests, and for translating one material."""

from __future__ import annotations

from export.image import Images
from export.report import Report


class Context:
    """Keeps reports, and the names of attributes that meshes have to have. Pictures that are in no file are written into
    a folder which lives as long as this object. `object` is the one whose coordinates count."""

    def __init__(self, uv_map=None, thing=None):
        self.reports: list[tuple[str, str]] = []
        self.uv_map, self.object = uv_map, thing
        self.attributes: set[str] = set()
        self.textures: dict[str, dict] = {}
        self.materials: dict[str, dict] = {}
        self._images = Images()

    def report(self, name: str, text: str):
        self.reports.append((name, text))

    def texture(self, name: str, entry: dict) -> str:
        return self._named(self.textures, name, entry)

    def material(self, name: str, entry: dict) -> str:
        return self._named(self.materials, name, entry)

    def _named(self, table, name, entry):
        free = name
        while free in table and table[free] != entry:
            free += "'"
        table[free] = entry
        return free

    def image(self, image):
        """The file of a picture."""
        return self._images.path(image, Report(lambda line: None))
