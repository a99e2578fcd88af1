"""Renders on the workers of a Dask cluster, which compute parts of the picture that are joined here.

The scheduler hands the scene to every worker once, also to those that come later, or begin anew after they died. A task has no more
than the numbers of its pieces, and its result is the state of these. Dask computes those of a worker that is lost again.
"""

from __future__ import annotations

import contextlib
import itertools
import os
import threading
import uuid
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from distributed import Client, Future, Reschedule, Worker, as_completed, get_worker
from distributed.diagnostics.plugin import WorkerPlugin

from . import _steradian
from ._steradian import Image, Progress

if TYPE_CHECKING:
    from ._scene import Scene

RETRIES = 5
CHUNKS_PER_WORKER = 8
AHEAD = 2
"""Parts that are under way for each worker: one that it computes, and one that is next."""


def render(
    scene: Scene, settings: dict[str, Any], client: Client, chunks: int | None, progress: Callable[[Progress], Any] | None
) -> Image:
    """Renders a scene on the workers of a client, in a number of parts; the arguments are those of `Scene.render`."""
    if not isinstance(client, Client) or client.asynchronous:
        raise TypeError(f"client is a distributed.Client that is not asynchronous, not {client!r}")
    asked = _steradian.Settings(**settings)
    kept = _KeptScene(scene, settings)
    parts = scene._inner.parts(asked, kept.fingerprint)
    bounds = _bounds(parts.pieces, chunks, len(client.nthreads()))
    _refuse_other_versions(client)
    waiting, under_way, results = iter(range(len(bounds) - 1)), set(), as_completed(loop=client.loop)

    def submit() -> None:
        room = AHEAD * max(1, len(client.nthreads())) - len(under_way)
        for k in itertools.islice(waiting, max(0, room)):
            pieces = bounds[k], bounds[k + 1]
            future = client.submit(_part, kept.name, *pieces, key=f"{kept.name}-{k}", pure=False, retries=RETRIES)
            under_way.add(future)
            results.add(future)

    stopped = None
    try:
        client.register_plugin(kept, name=kept.name)
        submit()
        for future in results:
            _join(parts, future)
            under_way.discard(future)
            if progress and progress(Progress.of(parts)) is False and not parts.is_done:
                stopped = "progress"
                break
            submit()
    except KeyboardInterrupt:
        if Progress.of(parts).fraction == 0:
            raise
        stopped = None if parts.is_done else "interrupt"
    finally:
        # A cluster that is gone has nothing left to be tidied up.
        with contextlib.suppress(Exception):
            client.cancel(list(under_way))
            client.unregister_worker_plugin(kept.name)
    image = parts.image(stopped)
    assert image is not None
    return image


def _bounds(pieces: int, chunks: int | None, workers: int) -> list[int]:
    """First piece of each part, and the end of the last."""
    if chunks is None:
        chunks = min(pieces, CHUNKS_PER_WORKER * max(1, workers))
    if not 1 <= chunks <= pieces:
        raise ValueError(f"chunks={chunks}: the render falls into 1 to {pieces} of them")
    return [pieces * k // chunks for k in range(chunks + 1)]


def _refuse_other_versions(client: Client) -> None:
    # Within a function, so that it travels to workers by value: these need not have this module.
    def version() -> str:
        try:
            import steradian
        except ImportError as e:
            return f"none ({e})"
        return steradian.__version__

    # A worker that dies meanwhile has no answer.
    for address, theirs in sorted(client.run(version, on_error="ignore").items()):
        if theirs != _steradian.__version__:
            ours = _steradian.__version__
            raise ValueError(f"the worker {address} has steradian {theirs}; this is {ours}, whose bits may differ")


def _join(parts: _steradian.Parts, future: Future) -> None:
    worker, part = future.result()
    if isinstance(part, bytes):
        try:
            return parts.join(part)
        except ValueError as e:
            part = e
    raise ValueError(f"the worker {worker}: {part}")


def _part(name: str, first: int, end: int) -> tuple[str, bytes | Exception]:
    """On a worker: its address, with the part of the picture, or why no try gives one."""
    worker = get_worker()
    try:
        part = worker.plugins[name].compute(first, end)
    except (ValueError, OSError) as e:
        return worker.address, e
    if part is None:
        # The render has ended, or this worker closes and others compute the part.
        raise Reschedule
    return worker.address, part


class _KeptScene(WorkerPlugin):
    """Scene that workers keep while it is rendered."""

    def __init__(self, scene: Scene, settings: dict[str, Any]) -> None:
        self.name = f"steradian-{uuid.uuid4().hex}"
        self._settings, self.fingerprint = settings, scene._inner.fingerprint()
        self._packed, files = scene._inner.packed()
        self._files = [file for file in map(os.fspath, files) if os.path.exists(file)]

    def setup(self, worker: Worker) -> None:
        self._threads = worker.state.nthreads
        self._lock, self._parts, self._is_stopped = threading.Lock(), None, False

    def teardown(self, worker: Worker) -> None:
        self._is_stopped = True
        if self._parts:
            self._parts.stop()

    def compute(self, first: int, end: int) -> bytes | None:
        """Part of the picture, or None if this was ended. All threads of the worker compute one part after the other."""
        with self._lock:
            if self._parts is None:
                self._parts = self._opened()
            if self._is_stopped:
                return None
            return self._parts.compute(first, end)

    def _opened(self) -> _steradian.Parts:
        missing = [file for file in self._files if not os.path.exists(file)]
        if missing:
            raise FileNotFoundError(f"the scene names the file '{missing[0]}', which is not there on this machine")
        scene = _steradian.Scene.unpacked(self._packed)
        fingerprint = scene.fingerprint()
        if fingerprint != self.fingerprint:
            raise ValueError(f"the files that the scene names have other contents on this machine: {_listed(self._files)}")
        threads = min(filter(None, (self._settings["threads"], self._threads)))
        return scene.parts(_steradian.Settings(**{**self._settings, "threads": threads}), fingerprint)


def _listed(files: Sequence[str]) -> str:
    return ", ".join(f"'{file}'" for file in files[:3]) + (", …" if len(files) > 3 else "")
