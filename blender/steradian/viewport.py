"""Progressive pictures of a scene that is edited: everything of the viewport but the drawing."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from . import engine, passes, settings
from .export import camera as cameras
from .export import edit, matrix
from .export.report import Report
from .export.scene import Exporter

# The first picture after a change has a fourth of the width and height.
COARSE = 4


class Session:
    """A scene with a thread that renders it: first a coarse picture, then one of more and more samples.

    `count` grows with each new picture, and error. `edited` counts updates that were edits of the compiled scene, `made`
    those that made it anew.
    """

    def __init__(self, report: Report | None = None):
        self._exporter = Exporter(report)
        self._exported: Any = None
        self._scene: Any = None
        self._view: dict[str, Any] | None = None
        self._size = (0, 0)
        self._choices: dict[bool, dict[str, Any]] = {}
        self._denoise = False
        self._transparent = False
        self._lock = threading.Condition()
        self._rendering = threading.Lock()
        self._epoch, self._finished, self._held, self._ends = 0, -1, 0, False
        self._picture: tuple[NDArray[np.float32], int, int] | None = None
        self.error: str | None = None
        self.made = self.edited = self.count = 0
        self._thread = threading.Thread(target=self._run, name="Steradian viewport", daemon=True)
        self._thread.start()

    def update(self, depsgraph: bpy.types.Depsgraph) -> None:
        """Takes over what changed in the scene; geometry is read again where the graph says that it changed."""
        self._forget(depsgraph)
        with self._stopped():
            view = self._view or {"camera": "perspective"}
            exported = self._exporter.export(depsgraph, self._size if all(self._size) else None, view=view)
            self._take(exported)
            scene = depsgraph.scene
            self._choices = {
                hides: settings.options(scene, is_preview=True, **exported.how | {"hides_lamps": hides})
                for hides in (True, False)
            }
            self._denoise = scene.steradian.preview_denoise
            self._transparent = scene.render.film_transparent

    def camera(self, view_matrix: Any, window_matrix: Any, size: tuple[int, int]) -> None:
        """Looks through a view matrix (from the world to the camera) and a projection of OpenGL, into pictures of a size."""
        window = matrix.array(window_matrix)
        near, far = clips(window)
        entry = cameras.projection(window, near, far)
        entry["to_world"] = np.linalg.inv(matrix.array(view_matrix)) @ matrix.FLIP
        if edit.same(entry, self._view) and size == self._size:
            return
        with self._stopped():
            self._view, self._size = entry, size
            if self._exported is not None:
                description = {**self._exported.description, "cameras": {"view": entry}}
                description["film"] = {**description["film"], "width": size[0], "height": size[1]}
                self._take(replace(self._exported, description=description))

    def picture(self) -> tuple[NDArray[np.float32], int] | None:
        """The picture that there is, rows from the bottom, height × width × 4, and its samples per pixel (0: a coarse one).

        None as long as there is none of the scene as it is now.
        """
        with self._lock:
            if self._picture is None or self._picture[2] != self._epoch:
                return None
            return self._picture[:2]

    def last(self) -> tuple[NDArray[np.float32], int] | None:
        """The newest picture, of whichever state of the scene."""
        with self._lock:
            return self._picture and self._picture[:2]

    def wait(self, spp: int = 0, timeout: float = 60.0) -> tuple[NDArray[np.float32], int] | None:
        """Waits for a picture of so many samples; None where there is none in time, or an error."""

        def is_there() -> bool:
            return self.error is not None or (
                self._picture is not None and self._picture[2] == self._epoch and self._picture[1] >= spp
            )

        with self._lock:
            self._lock.wait_for(is_there, timeout)
        return self.picture() if self.error is None else None

    def close(self) -> None:
        """Ends the thread."""
        with self._lock:
            self._ends = True
            self._epoch += 1
            self._lock.notify_all()
        self._thread.join()

    def _forget(self, depsgraph: bpy.types.Depsgraph) -> None:
        """Drops kept meshes whose data the graph says to have changed."""
        names = {update.id.name_full for update in depsgraph.updates if update.is_updated_geometry}
        if names:
            self._exporter.meshes.forget(lambda key: not names.isdisjoint(key[:2]))

    @contextmanager
    def _stopped(self) -> Iterator[None]:
        """While it lasts the thread does not render; afterwards it begins anew."""
        with self._lock:
            self._epoch += 1
            self._held += 1
            self.error = None
        try:
            with self._rendering:
                yield
        finally:
            with self._lock:
                self._held -= 1
                self._lock.notify_all()

    def _take(self, exported: Any) -> None:
        """Makes the compiled scene that of a description, by edits where they do."""
        old, self._exported = self._exported, exported
        if self._scene is not None and old is not None:
            before = {**old.description, "film": None}
            after = {**exported.description, "film": None}
            changes = edit.edits(before, after)
            if changes is not None and edit.apply(self._scene, exported.description, changes):
                self.edited += 1
                return
        self._scene = engine.library().scene(exported.description)
        self.made += 1

    def _run(self) -> None:
        """The thread: renders until there are enough samples, and waits for changes."""
        while True:
            with self._lock:
                self._lock.wait_for(lambda: self._ends or self._is_due())
                if self._ends:
                    return
                epoch = self._epoch
            with self._rendering:
                try:
                    self._round(epoch)
                except (ValueError, RuntimeError) as error:
                    self.error = str(error)
            with self._lock:
                self._finished = epoch
                self.count += self.error is not None
                self._lock.notify_all()

    def _is_due(self) -> bool:
        return self._scene is not None and all(self._size) and not self._held and self._finished != self._epoch

    def _round(self, epoch: int) -> None:
        """Renders the scene of an epoch, in steps that double the samples."""
        size, options = self._size, dict(self._choices[self._exported.hides_lamps])
        total, seed = options.pop("spp", None), options.pop("seed")
        coarse = tuple(max(n // COARSE, 1) for n in size)
        behind = engine.background(self._exported, {"size": size})
        layers = passes.layers(
            [], alpha=self._transparent or behind is not None, denoise=self._denoise and total is not None
        )
        first = self._image(epoch, coarse, layers, options | ({"spp": 1} if total else {}) | {"seed": seed})
        if first is None:
            return
        self._show(passes.combined(first, transparent=self._transparent, background=_coarse(behind, coarse)), 0, epoch)
        sums, count, part = Sums(), 0, 1
        while total is None or count < total:
            image = self._image(
                epoch, size, layers, options | ({"spp": part} if total else {}) | {"seed": seed + count}
            )
            if image is None:
                return
            sums.add(image, part)
            count += part
            whole = sums.image()
            if self._denoise and total is not None:
                whole = whole.denoise("atrous")
            self._show(passes.combined(whole, transparent=self._transparent, background=behind), count, epoch)
            if total is None:
                return
            part = min(count, total - count)

    def _image(self, epoch: int, size: Any, layers: list[str], options: dict[str, Any]) -> Any:
        """A picture; None where the scene has changed meanwhile."""
        shown = {"size": size, "layers": layers, "transparent": self._transparent}
        try:
            image = self._scene.render(progress=lambda _: self._epoch == epoch, **shown, **options)
        except (ValueError, RuntimeError):
            if self._epoch == epoch:
                raise
            return None
        return image if self._epoch == epoch else None

    def _show(self, picture: NDArray[np.float32], spp: int, epoch: int) -> None:
        with self._lock:
            if self._epoch == epoch:
                self._picture = (picture, spp, epoch)
                self.count += 1
            self._lock.notify_all()


class Sums:
    """Pictures of one view with seeds of their own, summed by their samples."""

    def __init__(self) -> None:
        self._planes: dict[str, NDArray[np.float32]] = {}
        self._count = 0

    def add(self, image: Any, spp: int) -> None:
        """Adds a picture of so many samples."""
        self._count += spp
        for name in image.channels:
            weighted = image[name] * (spp * spp if name.startswith("variance") else spp)
            self._planes[name] = self._planes[name] + weighted if name in self._planes else weighted

    def image(self) -> Any:
        """The mean; its variance is that of a mean of independent pictures."""
        count = self._count
        mean = {
            name: plane / (count * count if name.startswith("variance") else count)
            for name, plane in self._planes.items()
        }
        return engine.library().Image(mean)


def _coarse(picture: NDArray[np.float32] | None, size: tuple[int, int]) -> NDArray[np.float32] | None:
    """A picture at a smaller size, by its nearest pixels."""
    if picture is None:
        return None
    rows, columns = (np.arange(n) * whole // n for n, whole in zip(reversed(size), picture.shape))
    return picture[rows[:, None], columns]


def clips(window: NDArray[np.float64]) -> tuple[float, float]:
    """Distances of the near and far planes of a projection of OpenGL."""
    a, b = window[2, 2], window[2, 3]
    if window[3, 3] == 0:
        near, far = b / (a - 1), b / (a + 1) if a != -1 else np.inf
    else:
        near, far = (b + 1) / a, (b - 1) / a
    return max(float(near), 0.0), float(far) if np.isfinite(far) and far > 0 else 1e10
