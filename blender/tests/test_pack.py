"""The packed extension."""

import importlib.util
import os
import tomllib
import zipfile

SPEC = importlib.util.spec_from_file_location(
    "pack", os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "pack.py")
)
pack = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(pack)


def wheel(folder):
    path = folder / "steradian-0.1.0-cp310-abi3-manylinux_2_34_x86_64.whl"
    path.write_bytes(b"stands for a wheel")
    return path


def test_the_same_inputs_give_the_same_bytes(tmp_path):
    wheel(tmp_path)
    first = pack.pack(str(tmp_path), str(tmp_path / "a"))
    second = pack.pack(str(tmp_path), str(tmp_path / "b"))
    assert os.path.basename(first) == "steradian-0.1.0.zip"
    with open(first, "rb") as a, open(second, "rb") as b:
        assert a.read() == b.read()


def test_the_archive_has_manifest_modules_licences_and_wheel(tmp_path):
    name = wheel(tmp_path).name
    with zipfile.ZipFile(pack.pack(str(tmp_path), str(tmp_path))) as archive:
        names = archive.namelist()
        manifest = tomllib.loads(archive.read("blender_manifest.toml").decode())
        assert archive.read(f"wheels/{name}") == b"stands for a wheel"
    assert manifest["wheels"] == [f"./wheels/{name}"] and manifest["schema_version"] == "1.0.0"
    assert manifest["license"] == ["SPDX:MIT", "SPDX:Apache-2.0"] and "network" not in manifest["permissions"]
    assert {"__init__.py", "engine.py", "export/mesh.py", "nodes/__init__.py", "LICENSE-MIT", "LICENSE-APACHE"} <= set(
        names
    )
    assert not [each for each in names if "__pycache__" in each]
