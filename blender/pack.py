"""Makes `steradian-<version>.zip`, the extension for Blender with the renderer's wheels in it.

    python blender/pack.py --wheel wheels/ -o .

The same inputs give the same bytes.
"""

from __future__ import annotations

import argparse
import os
import re
import sys
import zipfile

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE = os.path.join(HERE, "steradian")
LICENCES = ("LICENSE-MIT", "LICENSE-APACHE")


def wheels(folder: str) -> list[str]:
    """Wheels of the renderer in a folder, or the wheel that is named itself."""
    if os.path.isfile(folder):
        return [folder]
    found = sorted(name for name in os.listdir(folder) if re.fullmatch(r"steradian-.*\.whl", name))
    if not found:
        raise SystemExit(f"{folder}: no wheel of steradian there; maturin build makes one")
    return [os.path.join(folder, name) for name in found]


def sources() -> list[tuple[str, str]]:
    """Files of the add-on: the names in the archive, and the paths."""
    found = []
    for folder, folders, names in os.walk(SOURCE):
        folders[:] = sorted(each for each in folders if each != "__pycache__")
        for name in sorted(names):
            if name.endswith((".py", ".toml")):
                path = os.path.join(folder, name)
                found.append((os.path.relpath(path, SOURCE).replace(os.sep, "/"), path))
    return found


def manifest(text: str, names: list[str]) -> str:
    """The manifest with its wheels."""
    listed = ", ".join(f'"./wheels/{name}"' for name in names)
    return re.sub(r"(?m)^wheels = \[.*\]$", f"wheels = [{listed}]", text)


def pack(wheel: str, out: str) -> str:
    """Writes the archive into a folder; its path."""
    chosen = wheels(wheel)
    with open(os.path.join(SOURCE, "blender_manifest.toml"), encoding="utf-8") as file:
        text = file.read()
    version = re.search(r'(?m)^version = "(.+)"$', text)
    if version is None:
        raise SystemExit("blender_manifest.toml: no version there")
    path = os.path.join(out, f"steradian-{version[1]}.zip")
    os.makedirs(out, exist_ok=True)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:

        def write(name: str, data: bytes, how: int = zipfile.ZIP_DEFLATED) -> None:
            info = zipfile.ZipInfo(name, (2020, 1, 1, 0, 0, 0))
            info.compress_type, info.external_attr = how, 0o644 << 16
            archive.writestr(info, data)

        for name, source in sources():
            with open(source, "rb") as file:
                data = file.read()
            if name == "blender_manifest.toml":
                data = manifest(text, [os.path.basename(each) for each in chosen]).encode()
            write(name, data)
        for name in LICENCES:
            with open(os.path.join(os.path.dirname(HERE), name), "rb") as file:
                write(name, file.read())
        for each in chosen:
            with open(each, "rb") as file:
                write(f"wheels/{os.path.basename(each)}", file.read(), zipfile.ZIP_STORED)
    return path


def main() -> None:
    """Reads the command line."""
    parser = argparse.ArgumentParser(description="Makes the extension for Blender.")
    parser.add_argument(
        "--wheel", required=True, help="a wheel of the renderer, or a folder of wheels, one for each platform"
    )
    parser.add_argument("-o", "--out", default=".", help="folder of the archive")
    given = parser.parse_args()
    print(pack(given.wheel, given.out), file=sys.stdout)


if __name__ == "__main__":
    main()
