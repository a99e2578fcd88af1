"""Renders on the workers of a Dask cluster have the bits of renders here, whatever happens to workers."""

import hashlib
import os
import signal
import sys
import types

import numpy as np
import pytest

import steradian as st
from scenes import BALL, SQUARE, of_mesh

distributed = pytest.importorskip("distributed")
dask = pytest.importorskip("dask")

ROOT = os.path.join(os.path.dirname(__file__), "..", "..", "..")
LAYERS = ["albedo", "normal", "depth", "ids", "cryptomatte", "halves"]
PATH = {"integrator": "path", "spp": 4, "size": (64, 64), "layers": LAYERS}
LIGHT = {"integrator": "light", "spp": 16, "size": (64, 64)}
# No step of Dask's may fail for want of time on a machine that is busy.
PATIENCE = {
    "distributed.comm.timeouts.connect": "1h",
    "distributed.comm.timeouts.tcp": "1h",
    "distributed.scheduler.worker-ttl": None,
    "distributed.deploy.lost-worker-timeout": "1h",
}


@pytest.fixture(scope="module")
def client(tmp_path_factory):
    folder = tmp_path_factory.mktemp("dask")
    with dask.config.set(PATIENCE), distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, host="127.0.0.1", dashboard_address=None, memory_limit=0,
        local_directory=folder,
    ) as cluster, distributed.Client(cluster, timeout="1h") as client:
        yield client


def digest(image):
    of = hashlib.sha256()
    for name in image.channels:
        of.update(name.encode() + b"\0" + image[name].tobytes())
    return of.hexdigest()


def kept_scenes(client):
    """Scenes that workers still keep."""
    names = client.run(lambda dask_worker: [name for name in dask_worker.plugins if name.startswith("steradian-")])
    return [name for kept in names.values() for name in kept]


class DieOnce(distributed.WorkerPlugin):
    """Kills the first worker that begins a part of a picture, at that moment."""

    def __init__(self, marker):
        self.marker = marker

    def transition(self, key, start, finish, **_):
        if finish == "executing" and str(key).startswith("steradian-"):
            try:
                marker = os.open(self.marker, os.O_CREAT | os.O_EXCL | os.O_WRONLY)
            except FileExistsError:
                return
            os.write(marker, str(os.getpid()).encode())
            os.kill(os.getpid(), signal.SIGKILL)


@pytest.mark.parametrize("settings", [PATH, LIGHT, {**LIGHT, "integrator": "sppm"}], ids=lambda s: s["integrator"])
def test_a_worker_that_is_killed_costs_no_bit(client, settings, tmp_path):
    scene = st.load("builtin:cornell-box")
    workers = set(client.run(os.getpid).values())
    assert len(workers) == 2
    # It stays: one that is taken away while a worker begins anew may be missing there.
    client.register_plugin(DieOnce(str(tmp_path / "marker")), name=f"die once of {settings['integrator']}")
    image = scene.render(**settings, client=client)
    assert int((tmp_path / "marker").read_text()) in workers
    expected = scene.render(**settings)
    assert image.channels == expected.channels and digest(image) == digest(expected)
    assert (image.spp, image.stopped, image.metadata) == (expected.spp, None, expected.metadata)
    client.wait_for_workers(2)


@pytest.mark.parametrize("chunks", [1, 7, None])
def test_the_number_of_parts_changes_no_bit(client, chunks):
    scene = st.scene(of_mesh(SQUARE))
    scene["clay"]["reflectance"] = 0.75
    settings = {"spp": 3, "size": (40, 56), "crop": [3, 5, 40, 50], "layers": LAYERS, "seed": 5}
    assert digest(scene.render(**settings, client=client, chunks=chunks)) == digest(scene.render(**settings))


@pytest.mark.parametrize("name", ["ball", "showcase.pbrt", "spectral"])
def test_scenes_come_to_workers_as_they_are(client, name):
    scene = st.load(os.path.join(ROOT, "scenes", name)) if "." in name else st.scene(BALL)
    settings = {"spp": 2, "size": (48, 36), "layers": LAYERS, "color": "spectral" if name == "spectral" else "auto"}
    assert digest(scene.render(**settings, client=client)) == digest(scene.render(**settings))


def test_progress_comes_with_the_picture_so_far(client):
    seen = []
    scene = st.load("builtin:cornell-box")
    image = scene.render(spp=2, size=(64, 48), client=client, chunks=6, progress=lambda p: seen.append((p.fraction, p.image)))
    fractions = [fraction for fraction, _ in seen]
    assert fractions == [k / 6 for k in range(1, 7)]
    covered = [np.count_nonzero(np.asarray(so_far).any(axis=2)) for _, so_far in seen]
    assert sorted(covered) == covered and covered[0] < covered[-1] and seen[0][1].stopped is None
    assert digest(seen[-1][1]) == digest(image)


@pytest.mark.parametrize("end", ["progress", "interrupt"])
def test_a_render_that_is_ended_keeps_its_parts(client, end):
    def progress(p):
        if p.fraction >= 0.25:
            if end == "interrupt":
                raise KeyboardInterrupt
            return False

    scene, before = st.load("builtin:cornell-box"), kept_scenes(client)
    image = scene.render(spp=2, size=(64, 64), client=client, chunks=16, progress=progress)
    assert image.stopped == end and image.spp == 0.5
    assert kept_scenes(client) == before

    def fail(p):
        raise RuntimeError("nothing more")

    with pytest.raises(RuntimeError, match="nothing more"):
        scene.render(spp=1, size=(32, 32), client=client, progress=fail)
    assert kept_scenes(client) == before


def test_a_notebook_shows_the_picture_as_it_grows(client, monkeypatch):
    shown = []

    class Handle:
        update = shown.append

    def display(image, *, display_id):
        assert display_id is True
        shown.append(image)
        return Handle

    monkeypatch.setitem(sys.modules, "IPython", types.ModuleType("IPython"))
    monkeypatch.setitem(sys.modules, "IPython.display", types.SimpleNamespace(display=display))
    monkeypatch.setitem(sys.modules, "ipykernel", types.ModuleType("ipykernel"))
    monkeypatch.setattr(st._progress, "INTERVAL", 0)
    image = st.load("builtin:cornell-box").render(spp=1, size=(32, 32), client=client, chunks=4, progress=True)
    assert len(shown) == 4 and digest(shown[-1]) == digest(image)
    shown.clear()
    monkeypatch.setattr(st._progress, "INTERVAL", 1e9)
    st.load("builtin:cornell-box").render(spp=1, size=(32, 32), client=client, chunks=4, progress=True)
    assert len(shown) == 2


@pytest.mark.parametrize(("settings", "said"), [
    ({"adaptive": True, "spp": 64}, "cannot be computed in parts by 'path': adaptive sampling decides over the whole picture"),
    ({"error": 0.1}, "a stop at an error looks at the whole picture"),
    ({"time": 1.0}, "a render up to a time cannot be computed in parts"),
    ({"integrator": "path:reuse=4"}, "paths of neighbouring pixels share what they find"),
    ({"integrator": "raster:frame=hybrid"}, "the method goes on from its own picture"),
    ({"chunks": 0}, "chunks=0: the render falls into 1 to 4 of them"),
    ({"chunks": 5}, "chunks=5: the render falls into 1 to 4 of them"),
], ids=str)
def test_what_is_one_is_refused_with_the_reason(client, settings, said):
    with pytest.raises(ValueError, match=said):
        st.load("builtin:cornell-box").render(**{"spp": 1, "size": (32, 32), "integrator": "path", **settings, "client": client})


def test_only_a_client_takes_parts():
    scene = st.load("builtin:cornell-box")
    with pytest.raises(ValueError, match="give a client"):
        scene.render(spp=1, size=(8, 8), chunks=2)
    with pytest.raises(TypeError, match="client is a distributed.Client .*, not 'tcp://somewhere'"):
        scene.render(spp=1, size=(8, 8), client="tcp://somewhere")


def test_a_worker_of_another_version_is_refused_by_name(client):
    def call(version):
        import steradian

        steradian.__version__, before = version, steradian.__version__
        return before

    worker = sorted(client.nthreads())[1]
    (before,) = client.run(call, "0.0.7", workers=[worker]).values()
    try:
        with pytest.raises(ValueError, match=f"the worker {worker} has steradian 0.0.7; this is {before}, whose bits may differ"):
            st.load("builtin:cornell-box").render(spp=1, size=(8, 8), client=client)
    finally:
        client.run(call, before, workers=[worker])


def test_a_worker_without_the_package_is_refused_by_name(client):
    def hide():
        import sys

        sys.modules["hidden"], sys.modules["steradian"] = sys.modules.get("steradian"), None

    def show():
        import sys

        del sys.modules["steradian"]
        if sys.modules["hidden"]:
            sys.modules["steradian"] = sys.modules["hidden"]

    worker = sorted(client.nthreads())[0]
    client.run(hide, workers=[worker])
    try:
        with pytest.raises(ValueError, match=f"the worker {worker} has steradian none .*; this is "):
            st.load("builtin:cornell-box").render(spp=1, size=(8, 8), client=client)
    finally:
        client.run(show, workers=[worker])


@pytest.mark.parametrize("fault", ["gone", "changed"])
def test_files_that_a_worker_does_not_have_are_named(client, tmp_path, monkeypatch, fault):
    file = tmp_path / "t.exr"
    st.Image({c: np.full((2, 2), v) for c, v in zip("RGB", (0.25, 0.5, 1.0))}).save(file)
    clay = {"material": "diffuse", "reflectance": {"texture": "image", "file": {"file": "t.exr"}}}
    scene = st.scene({**BALL, "materials": {"clay": clay}}, search=[tmp_path])
    assert digest(scene.render(spp=1, client=client)) == digest(scene.render(spp=1))
    register = client.register_plugin

    def lose(plugin, name):
        file.unlink()
        if fault == "changed":
            st.Image({c: np.full((2, 2), 0.5) for c in "RGB"}).save(file)
        return register(plugin, name=name)

    monkeypatch.setattr(client, "register_plugin", lose)
    said = "which is not there" if fault == "gone" else "have other contents on this machine: "
    with pytest.raises(ValueError, match=rf"the worker tcp://127.0.0.1:\d+: .*{said}") as caught:
        scene.render(spp=1, client=client)
    assert str(file) in str(caught.value)


def test_without_a_client_dask_is_not_imported():
    code = "import sys, steradian as st; st.load('builtin:cornell-box').render(spp=1, size=(8, 8)); assert 'distributed' not in sys.modules"
    assert os.spawnv(os.P_WAIT, sys.executable, [sys.executable, "-c", code]) == 0
