"""Names of nodes: those of data-blocks, made unique by what follows a `#`, which the scene language does not count."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

# Sections of a description by the family of their nodes, in the order in which the language numbers them.
FAMILIES = {
    "nodes": None,
    "textures": "texture",
    "materials": "material",
    "media": "medium",
    "cameras": "camera",
    "lights": "light",
    "shapes": "shape",
}


class Names:
    """Hands out names that no other node of the description has."""

    def __init__(self) -> None:
        self._used: dict[str, int] = {}

    def __call__(self, name: str) -> str:
        base = name.replace("#", "♯") or "unnamed"
        count = self._used[base] = self._used.get(base, 0) + 1
        return base if count == 1 else f"{base}#{count}"


def resolved(description: Mapping[str, Any], nodes: Mapping[str, tuple[str, str]]) -> dict[tuple[str, str], str]:
    """Names of the nodes of a compiled scene by section and name of its description: what follows a `#` is counted anew there."""
    lists: dict[tuple[str, str], list[str]] = {}
    for name, (family, _) in nodes.items():
        lists.setdefault((family, name.partition("#")[0]), []).append(name)
    free = {key: iter(names) for key, names in lists.items()}

    def match(family: str, name: str) -> str | None:
        return next(free.get((family, name.partition("#")[0]), iter(())), None)

    found = {}
    for section, family in FAMILIES.items():
        if section == "shapes":
            for group in description.get("groups", {}).values():
                for name in group:
                    match("shape", name)
        for name, entry in description.get(section, {}).items():
            if (node := match(family or next(iter(entry)), name)) is not None:
                found[section, name] = node
    return found
