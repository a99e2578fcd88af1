"""Differences of two descriptions as edits of the compiled scene of the first, so that only what changed is compiled."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from .names import FAMILIES, resolved


def same(a: Any, b: Any) -> bool:
    """True if two values of descriptions are equal, arrays number by number."""
    if a is b:
        return True
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return np.shape(a) == np.shape(b) and bool(np.array_equal(a, b))
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)):
        return len(a) == len(b) and all(same(x, y) for x, y in zip(a, b))
    return type(a) is type(b) and bool(a == b)


def edits(old: Mapping[str, Any], new: Mapping[str, Any]) -> list[tuple[str, str, str, Any]] | None:
    """What leads from one description to another: (section, name, parameter, value), value None for a default.

    None where nodes come, go or change their kind, and the scene is to be made anew.
    """
    found: list[tuple[str, str, str, Any]] = []
    if not same(old.get("instances"), new.get("instances")) or not same(old.get("groups"), new.get("groups")):
        return None
    for section, family in FAMILIES.items():
        before, after = old.get(section, {}), new.get(section, {})
        if list(before) != list(after):
            return None
        for name in before:
            a, b = before[name], after[name]
            if a is b:
                continue
            kind = family or next(iter(b))
            if kind not in a or a.get(kind) != b.get(kind):
                return None
            for parameter in dict.fromkeys([*a, *b]):
                if not same(a.get(parameter), b.get(parameter)):
                    found.append((section, name, parameter, b.get(parameter)))
    is_own = {"mesh", "to_world"}
    if any(section == "shapes" and parameter not in is_own for section, _, parameter, _ in found):
        return None
    return found if same(old.get("filter"), new.get("filter")) and same(old.get("film"), new.get("film")) else None


def apply(scene: Any, description: Mapping[str, Any], changes: list[tuple[str, str, str, Any]]) -> bool:
    """Makes edits on a compiled scene; False where one has no place in it."""
    nodes = resolved(description, scene.nodes)
    for section, name, parameter, value in changes:
        node = nodes.get((section, name))
        if node is None:
            return False
        if section == "shapes" and parameter == "mesh":
            arrays = dict(description["meshes"][value])
            empty = {part: None for part in ("normals", "uvs", "tangents", "patches") if part not in arrays}
            scene[node].set_mesh(**arrays, **empty)
        elif section == "shapes" and parameter == "to_world":
            scene[node].to_world = value
        elif value is None:
            del scene[node][parameter]
        else:
            scene[node][parameter] = value
    return True
