"""Tests of the add-on, by Blender as a Python module (`pip install bpy`); they are skipped, and say so, where it is not there.

PYTHONPATH=… python -m pytest blender/tests
"""

import importlib.util
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:] = [path for path in sys.path if os.path.abspath(path) != os.path.dirname(HERE)]
sys.path += [os.path.dirname(HERE), os.path.join(os.path.dirname(HERE), "scenes")]

ABSENT = [name for name in ("bpy", "steradian") if importlib.util.find_spec(name) is None]
collect_ignore_glob = ["test_*.py"] if ABSENT else []


def pytest_terminal_summary(terminalreporter):
    """Tells loudly what is not tested."""
    if ABSENT:
        terminalreporter.write_sep("#", "WARNING", yellow=True)
        terminalreporter.write_line(
            f"NO TEST OF THE ADD-ON FOR BLENDER HAS RUN: no module {' and no module '.join(ABSENT)}"
        )
        terminalreporter.write_sep("#", yellow=True)
