"""The notebook of a first session runs as it is written, with small pictures."""

import contextlib
import io
import json
import os

import numpy as np
import pytest

import steradian as st

DOCS = os.path.join(os.path.dirname(__file__), "..", "..", "..", "docs")


def cells():
    with open(os.path.join(DOCS, "python-session.ipynb"), encoding="utf-8") as file:
        return [(cell["cell_type"], "".join(cell["source"]), cell) for cell in json.load(file)["cells"]]


def test_the_session_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")
    render = st.Scene.render
    monkeypatch.setattr(st.Scene, "render", lambda scene, **asked: render(scene, **{**asked, "spp": 2, "size": (32, 24)}))
    names, said = {}, io.StringIO()
    for number, source in enumerate(source for kind, source, _ in cells() if kind == "code"):
        with contextlib.redirect_stdout(said):
            exec(compile(source, f"cell {number} of python-session.ipynb", "exec"), names)
    assert "is a file that is read here" in said.getvalue()
    # What the cells say agrees with each other.
    assert np.allclose(names["integral"], names["drawn"].weight.mean(axis=1), atol=0.02)
    assert np.allclose(names["integral"], names["rough"].albedo(names["wo"]), atol=0.01)
    assert 0.02 < names["shadow"].mean() < 0.5 and names["difference"]["rel_mse"] > 0
    written = {path.name for path in (tmp_path / "images").iterdir()}
    shown = {name for kind, source, _ in cells() if kind == "markdown" for name in
             (part.split(")")[0] for part in source.split("](images/")[1:])}
    with contextlib.suppress(ImportError):
        import matplotlib  # noqa: F401

        assert written == shown
    assert written >= shown - {"python-session-lobes.png"}


def test_pictures_of_the_session_are_there_and_small():
    names = [part.split(")")[0] for _, source, _ in cells() for part in source.split("](images/")[1:]]
    assert len(names) == 5
    for name in names:
        assert 500 < os.path.getsize(os.path.join(DOCS, "images", name)) < 200_000, name
    assert os.path.getsize(os.path.join(DOCS, "python-session.ipynb")) < 200_000


@pytest.mark.parametrize("cell", [cell for kind, _, cell in cells() if kind == "code"])
def test_the_notebook_keeps_no_outputs(cell):
    assert cell["outputs"] == [] and cell["execution_count"] is None
