"""Layers arrive from every integrator, or are refused by name."""

import numpy as np
import pytest

import steradian as st
from scenes import SQUARE, of_mesh

# Those that change how paths are made, and one that takes a frame before.
ASK_MORE = ["light_groups", "bounces", "halves", "motion"]
LAYERS = [name for name in st.registry()["layers"] if name not in ASK_MORE]


@pytest.mark.parametrize("integrator", [*st.registry()["integrators"], "raster:frame=hybrid", "raster:frame=forward"])
def test_no_layer_is_ignored(integrator):
    scene = st.scene(of_mesh(SQUARE))
    image = scene.render(spp=1, size=(4, 3), integrator=integrator, layers=LAYERS)
    for layer in LAYERS:
        assert np.isfinite(image.layer(layer)).any(), layer
    try:
        image = scene.render(spp=1, size=(4, 3), integrator=integrator, layers=["light_groups"])
        assert any(name.startswith("RGBA_") for name in image.channels), image.channels
    except ValueError as e:
        assert "groups of lights" in str(e) and integrator.split(":")[0] in str(e)
    try:
        image = scene.render(spp=1, size=(4, 3), integrator=integrator, layers=["bounces"])
        bounces = [name for name in image.channels if name.startswith("bounce.") and name.endswith(".R")]
        picture = sum(image[name] for name in sorted(bounces))
        np.testing.assert_allclose(picture, image["R"], rtol=1e-5)
    except ValueError as e:
        assert "bounces" in str(e) and integrator.split(":")[0] in str(e)
    try:
        image = scene.render(spp=2, size=(4, 3), integrator=integrator, layers=["halves"])
        halves = [np.stack([image[f"{half}.{c}"] for c in "RGB"]) for half in ("half_a", "half_b")]
        picture = np.stack([image[c] for c in "RGB"])
        np.testing.assert_allclose(sum(halves) / 2, picture, rtol=1e-5)
    except ValueError as e:
        assert "halves" in str(e) and integrator.split(":")[0] in str(e)
    with pytest.raises(ValueError, match="'motion' tells what has moved since the frame before"):
        scene.render(spp=1, size=(4, 3), integrator=integrator, layers=["motion"])


def test_a_preview_by_the_pipeline_has_layers_too():
    scene = st.load("builtin:cornell-box")
    names = ["albedo", "normal", "position", "uv", "ids"]
    preview = scene.render(size=(80, 60), integrator="raster", layers=names)
    path = scene.render(size=(80, 60), integrator="path", spp=16, layers=names)
    for name in names:
        a, b = preview.layer(name), path.layer(name)
        # Most pixels show one surface, whichever ray looks at it.
        inside = np.abs(a - b).max(axis=-1) <= 0.02 * max(1.0, np.abs(b).max())
        assert inside.mean() > 0.8, f"{name}: {inside.mean()}"
        assert np.abs(a).max() > 0
    with pytest.raises(ValueError, match="there is no layer 'albdo'; known are albedo"):
        scene.render(size=(8, 8), integrator="raster", layers=["albdo"])
