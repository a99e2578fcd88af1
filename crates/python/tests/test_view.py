"""Live views: a server with a page for a scene."""

import json
import time
import urllib.error
import urllib.request

import numpy as np
import pytest
import steradian


def get(url):
    with urllib.request.urlopen(url, timeout=60) as answer:
        return answer.read()


@pytest.mark.parametrize(("view_denoise", "denoise"), [(None, "nlm"), ("off", None)])
def test_views_show_the_scene_as_it_is(tmp_path, view_denoise, denoise):
    scene = steradian.load("builtin:cornell-box")
    scene["white"]["reflectance"] = 0.25
    with scene.view(spp=2, size=(12, 8), denoise=view_denoise, open=False) as view:
        assert view.url.startswith("http://127.0.0.1:") and view.url in view._repr_html_()
        assert b"<html" in get(view.url).lower()
        path, since = tmp_path / "a.exr", time.monotonic()
        while True:
            try:
                path.write_bytes(get(view.url + "api/picture.exr?layers=samples"))
                picture = steradian.read_image(path)
                if picture.shape == (8, 12, 3) and (picture["samples.Y"] == 2).all():
                    break
            except urllib.error.HTTPError as error:
                assert error.code == 409, "there is no picture yet"
            assert time.monotonic() - since < 120
            time.sleep(0.05)
        assert json.loads(get(view.url + "api/state"))["film"] == {"width": 12, "height": 8}
        rendered = scene.render(spp=2, size=(12, 8), denoise=denoise)
        assert all(np.array_equal(picture[c], rendered[c]) for c in "RGB")
        with pytest.raises(urllib.error.HTTPError):
            get(view.url.replace(view.url.split("/")[3], "0" * 48))
    with pytest.raises(urllib.error.URLError):
        get(view.url)
    view.close()


def test_what_cannot_be_shown_is_told():
    with pytest.raises(ValueError, match="camera"):
        steradian.scene({"shapes": [{"shape": "sphere"}]}).view(open=False)
    with pytest.raises(ValueError, match="nlm, atrous, oidn"):
        steradian.load("builtin:cornell-box").view(denoise="blur", open=False)
    with pytest.raises(OSError, match="cannot listen"):
        steradian.load("builtin:cornell-box").view(bind="203.0.113.1", open=False)
