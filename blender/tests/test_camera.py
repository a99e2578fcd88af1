"""Cameras, by where marks are in pictures of Cycles."""

import common
import numpy as np
import pytest
from blend import both

CAMERAS = {
    "plain": {},
    "shift": {"shift_x": 0.1, "shift_y": -0.15},
    "vertical fit": {"sensor_fit": "VERTICAL", "sensor_height": 20.0, "shift_x": 0.1},
    "horizontal fit": {"sensor_fit": "HORIZONTAL", "sensor_width": 30.0, "shift_y": 0.1},
    "orthographic": {"type": "ORTHO", "ortho_scale": 5.0, "shift_x": 0.1, "shift_y": 0.05},
    "clipped": {"clip_start": 5.5, "clip_end": 7.0},
    "panorama": {"type": "PANO", "panorama_type": "EQUIRECTANGULAR"},
}
MARKS = {(0, 0, 0): (1, 1, 1), (1.5, 0, 0): (1, 0, 0), (0, 0, 1): (0, 1, 0), (-1, 2, -0.5): (0, 0, 1)}


def marked(size=(64, 36)):
    """Four balls in plain light."""
    current = common.empty(size)
    common.world((1, 1, 1), 0.2)
    for place, colour in MARKS.items():
        common.shape(
            "ico_sphere", common.matte(str(colour), colour), smooth=True, subdivisions=4, radius=0.35, location=place
        )
    eye = common.camera((0.5, -6, 1), (0.2, 0, 0.3))
    eye.rotation_euler.rotate_axis("Z", 0.1)
    return current


def alike():
    """True if the pictures of both have the same colours at the same places."""
    a, b = both(16, 16)
    centres = []
    for picture in (a, b):
        weights = np.abs(picture - np.median(picture, axis=(0, 1)))
        weights = np.maximum(weights - 0.3 * weights.max(axis=(0, 1)), 0)
        y, x = np.mgrid[: picture.shape[0], : picture.shape[1]]
        centres.append(
            [[(weights[..., k] * at).sum() / max(weights[..., k].sum(), 1e-6) for at in (x, y)] for k in range(3)]
        )
    assert np.abs(np.subtract(*centres)).max() < 0.6, centres
    assert np.abs(a - b).mean() < 0.015 * b.mean()


@pytest.mark.parametrize("name", CAMERAS)
def test_a_camera_frames_as_in_cycles(name):
    current = marked((96, 48) if name == "panorama" else (64, 36))
    if name == "panorama":
        current.camera.location = (0.5, -1.5, 1)
    for key, value in CAMERAS[name].items():
        setattr(current.camera.data, key, value)
    alike()


def test_tall_frames_and_oblong_pixels():
    current = marked((36, 64))
    current.camera.data.shift_x = 0.1
    current.render.pixel_aspect_x = 1.5
    alike()


def test_depth_of_field_by_an_object_in_focus():
    current = marked()
    dof = current.camera.data.dof
    dof.use_dof, dof.aperture_fstop = True, 0.1
    dof.focus_object = common.put("Focus", None, (1.5, 0, 0))
    alike()


def test_a_border_is_rendered_alone_and_in_its_place():
    current = marked()
    render = current.render
    render.use_border, render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = (
        True,
        0.25,
        0.8,
        0.3,
        0.9,
    )
    alike()
    render.use_crop_to_border = True
    a, b = both(4)
    assert a.shape == b.shape and a.shape[1] < 64
    assert np.abs(a - b).mean() < 0.03 * b.mean()


def test_percentage_of_the_size():
    current = marked()
    current.render.resolution_percentage = 50
    a, b = both(4)
    assert a.shape == b.shape == (18, 32, 3)
