"""Loads the add-on from this folder, beside the Python module `steradian` of the same name."""

from __future__ import annotations

import importlib.util
import os
import sys
from types import ModuleType

NAME = "steradian_blender"


def load(part: str = "") -> ModuleType:
    """The add-on as the package `steradian_blender`, or a module of it, such as `export.scene`."""
    if NAME not in sys.modules:
        here = os.path.dirname(os.path.abspath(__file__))
        sys.path[:] = [*(path for path in sys.path if os.path.abspath(path) != here), here]
        folder = os.path.join(here, "steradian")
        spec = importlib.util.spec_from_file_location(
            NAME, os.path.join(folder, "__init__.py"), submodule_search_locations=[folder]
        )
        if spec is None or spec.loader is None:
            raise ImportError(f"{folder}: no add-on there")
        module = importlib.util.module_from_spec(spec)
        sys.modules[NAME] = module
        spec.loader.exec_module(module)
    return importlib.import_module(f"{NAME}.{part}") if part else sys.modules[NAME]
