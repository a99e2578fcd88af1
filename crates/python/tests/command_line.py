"""The command line, which has the bits that this package is to have."""

import glob
import os
import shutil
import subprocess

import pytest

import steradian as st

ROOT = os.path.join(os.path.dirname(__file__), "..", "..", "..")


def program():
    """The program that was built last, or an installed one; `STERADIAN` names another."""
    # `cargo doc` leaves a folder of this name.
    files = filter(os.path.isfile, glob.glob(os.path.join(ROOT, "target", "*", "steradian")))
    built = sorted(files, key=os.path.getmtime)
    found = os.environ.get("STERADIAN") or (built[-1] if built else shutil.which("steradian"))
    if not found:
        pytest.skip("the program is not built")
    return found


def run(*arguments):
    """Standard output of a command that succeeds."""
    done = subprocess.run([program(), *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def rendered(path, *arguments):
    """The picture of a render."""
    run("render", *arguments, "-o", path)
    return st.read_image(path)
