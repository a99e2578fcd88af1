"""Pictures of files, packed, painted and generated, as the renderer reads them."""

import bpy
import common
import numpy as np
import steradian
from blend import addon

image = addon.load("export.image")
report = addon.load("export.report")


def painted(name, is_float=False):
    """A picture of 4 × 2 pixels whose values are all different."""
    made = bpy.data.images.new(name, 4, 2, float_buffer=is_float, alpha=True)
    values = np.linspace(0, 1, 32).astype(np.float32).reshape(2, 4, 4)
    values[..., 3] = 1
    made.pixels.foreach_set(values.ravel())
    return made, np.flipud(values)


def decoded(values):
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def test_painted_pictures_have_their_values():
    common.empty()
    images, tell = image.Images(), report.Report(lambda line: None)
    for is_float in (False, True):
        made, values = painted(f"Painted {is_float}", is_float)
        read = steradian.read_image(images.path(made, tell))
        found = np.stack([read[c] for c in "RGB"], axis=-1)
        assert np.allclose(found, values[..., :3] if is_float else decoded(values[..., :3]), atol=0.004)
    assert tell.lines == []


def test_packed_pictures_are_their_own_bytes_and_files_their_paths(tmp_path):
    common.empty()
    images, tell = image.Images(), report.Report(lambda line: None)
    path = tmp_path / "picture.png"
    path.write_bytes(image.png(np.full((2, 2, 3), 128, np.uint8)))
    loaded = bpy.data.images.load(str(path))
    assert images.path(loaded, tell) == str(path)
    loaded.pack()
    with open(images.path(loaded, tell), "rb") as file:
        assert file.read() == path.read_bytes()
    assert bpy.data.images.keys() == ["picture.png"]


def test_a_picture_that_is_not_there_is_told(tmp_path):
    common.empty()
    images, tell = image.Images(), report.Report(lambda line: None)
    lost = bpy.data.images.new("Lost", 1, 1)
    lost.source, lost.filepath = "FILE", str(tmp_path / "nowhere.png")
    assert images.path(lost, tell) is None and "nowhere.png" in tell.lines[0]
