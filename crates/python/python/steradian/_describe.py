"""Dictionaries with arrays, as texts in Steradian's own language and arrays of meshes."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._steradian import SceneError

# The arrays of a mesh: their columns, and whether they are indices.
PARTS = {
    "positions": (3, False), "normals": (3, False), "uvs": (2, False), "tangents": (3, False), "triangles": (3, True), "patches": (4, True),
}


class _Again(str):
    """Name of a parameter that is that of its node's family, too, as `texture` of the texture `scale`: a key beside it."""

    __eq__ = object.__eq__
    __hash__ = object.__hash__


def text(value: Any, where: str) -> str:
    """A value in Steradian's own language; messages call it `where`."""
    return json.dumps(_plain(value, where), allow_nan=False)


def document(description: Mapping[str, Any]) -> tuple[str, list[tuple[str, dict[str, Any]]]]:
    """The text of a scene, and the meshes that are taken out of it, by the names that it has for them."""
    meshes: list[tuple[str, dict[str, Any]]] = []
    entries = {"steradian": 1, **{str(key): value for key, value in description.items()}}
    named = entries.get("meshes")
    if isinstance(named, Mapping):
        given = {name: mesh for name, mesh in named.items() if _is_in_place(mesh)}
        meshes += [(str(name), mesh_arrays(mesh, f"meshes.{name}")) for name, mesh in given.items()]
        entries["meshes"] = {name: mesh for name, mesh in named.items() if name not in given}
    return json.dumps({key: _plain(value, key, meshes) for key, value in entries.items()}, allow_nan=False, indent=1), meshes


def _is_in_place(mesh: Any) -> bool:
    return isinstance(mesh, Mapping) and "file" not in mesh


def mesh_arrays(mesh: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Arrays of a mesh as the native part takes them."""
    unknown = [key for key in mesh if key not in PARTS and key != "attributes"]
    if unknown:
        raise SceneError(f"'{where}' has '{unknown[0]}'; the parts of a mesh are {', '.join(PARTS)}, attributes")
    found: dict[str, Any] = {
        name: _rows(mesh[name], f"{where}.{name}", columns, whole)
        for name, (columns, whole) in PARTS.items()
        if mesh.get(name) is not None
    }
    attributes = mesh.get("attributes") or {}
    found["attributes"] = [(str(name), *_attribute(value, f"{where}.attributes.{name}")) for name, value in attributes.items()]
    return found


def _rows(value: Any, where: str, columns: int, whole: bool) -> NDArray[Any]:
    """Numbers by rows, from an array of two dimensions or a flat list."""
    array = numbers(value, where)
    if array.size == 0:
        return np.empty((0, columns), np.uint32 if whole else np.float32)
    if array.ndim == 1 and array.size % columns == 0:
        array = array.reshape(-1, columns)
    if array.ndim != 2 or array.shape[1] != columns:
        raise SceneError(f"'{where}' has the shape {array.shape}, where (n, {columns}) is needed")
    if not whole:
        return np.ascontiguousarray(array, np.float32)
    if array.dtype.kind not in "iu":
        raise SceneError(f"'{where}' has the dtype {array.dtype}, where whole numbers are needed")
    if int(array.min()) < 0 or int(array.max()) >= 1 << 32:
        raise SceneError(f"'{where}' has the index {array.min() if int(array.min()) < 0 else array.max()}")
    return np.ascontiguousarray(array, np.uint32)


def _attribute(value: Any, where: str) -> tuple[str, NDArray[np.float32]]:
    """Domain of an attribute (vertex or face) and its values by rows: an array of one for each vertex, or `{"face": 3, "data": …}`."""
    domain, count = "vertex", None
    if isinstance(value, Mapping):
        domains = [key for key in value if key in ("vertex", "face")]
        if len(domains) != 1 or set(value) != {domains[0], "data"}:
            raise SceneError(f"'{where}' is written {{'vertex': N, 'data': …}}, or 'face', or is an array of one row for each vertex")
        domain, count, value = domains[0], value[domains[0]], value["data"]
    array = numbers(value, where)
    if array.ndim == 1:
        count = 1 if count is None else count
        if not isinstance(count, int) or count < 1 or array.size % count:
            raise SceneError(f"'{where}' has the shape {array.shape}, where {count} numbers for each {domain} are needed")
        array = array.reshape(-1, count)
    if array.ndim != 2 or not 1 <= array.shape[1] <= 4 or count not in (None, array.shape[1]):
        raise SceneError(f"'{where}' has the shape {array.shape}, where (n, {'1 to 4' if count is None else count}) is needed")
    return domain, np.ascontiguousarray(array, np.float32)


def numbers(value: Any, where: str) -> NDArray[Any]:
    """An array of numbers."""
    try:
        array = np.asarray(value)
    except ValueError as e:
        raise SceneError(f"'{where}' is no array: {e}") from None
    if array.dtype.kind not in "iuf" and array.size:
        raise SceneError(f"'{where}' has the dtype {array.dtype}, where numbers are needed")
    return array


def _plain(value: Any, where: str, meshes: list[tuple[str, dict[str, Any]]] | None = None) -> Any:
    """A value that JSON can write; transforms are matrices, and meshes of shapes are taken out."""
    if isinstance(value, Mapping):
        is_shape = "shape" in value or "node" in value
        plain = {}
        for key, part in value.items():
            at = f"{where}.{key}"
            if is_shape and key == "mesh" and meshes is not None and _is_in_place(part):
                meshes.append((at, mesh_arrays(part, at)))
                part = at
            name = str(key)
            plain[_Again(name[:-1]) if name.endswith("_") and name[:-1] in value else name] = _plain(part, at, meshes)
        return plain
    if isinstance(value, (list, tuple)):
        if len(value) == 4 and all(isinstance(row, (list, tuple, np.ndarray)) and len(row) == 4 for row in value):
            return _matrix(numbers(value, where), where)
        return [_plain(part, f"{where}[{i}]", meshes) for i, part in enumerate(value)]
    if isinstance(value, np.ndarray):
        return _matrix(numbers(value, where), where) if value.ndim > 1 else _numbers(value, where)
    if isinstance(value, np.generic):
        return _plain(value.item(), where)
    if isinstance(value, float) and not np.isfinite(value):
        raise SceneError(f"'{where}' is {value}, where a finite number is needed")
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise SceneError(f"'{where}' is a {type(value).__name__}, which has no place in a scene")


def _numbers(value: NDArray[Any], where: str) -> Any:
    if value.dtype.kind == "b":
        return value.tolist()
    array = numbers(value, where)
    if not np.isfinite(array).all():
        raise SceneError(f"'{where}' has numbers that are not finite")
    return array.tolist()


def _matrix(array: NDArray[Any], where: str) -> dict[str, Any]:
    if array.shape != (4, 4):
        raise SceneError(f"'{where}' has the shape {array.shape}, where (3,) for a colour or vector, (n,) for a list, or (4, 4) for a "
                         "transform is needed")
    return {"matrix": _numbers(array.ravel(), where)}
