"""Progress of renders for those who watch: a line in terminals and notebooks, and the growing picture in notebooks."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any

from ._steradian import Progress

INTERVAL = 1.0
"""Least seconds between pictures that a notebook shows."""


@contextlib.contextmanager
def shown(progress: bool | Callable[[Progress], Any]) -> Iterator[Callable[[Progress], Any] | None]:
    """Function that a render tells its progress to, or None: the one that is given, or, for True, one that shows it."""
    if callable(progress):
        yield progress
    elif progress is True and is_watched():
        line, picture = _Line(), _Picture(_display())

        def show(p: Progress) -> None:
            line(p)
            picture(p)

        try:
            yield show
        finally:
            line.close()
    else:
        yield None


def is_watched() -> bool:
    """True if somebody sees lines that are written over: in a terminal or a notebook."""
    return sys.stderr.isatty() or is_notebook()


def is_notebook() -> bool:
    """True in Jupyter."""
    return "ipykernel" in sys.modules


def _display() -> Callable[..., Any] | None:
    """IPython's function that shows pictures, in notebooks."""
    if not is_notebook():
        return None
    try:
        from IPython.display import display
    except ImportError:
        return None
    return display


class _Line:
    """Progress line of a render."""

    def __init__(self) -> None:
        self._told = False

    def __call__(self, p: Progress) -> None:
        done = int(30 * min(p.fraction, 1.0))
        print(f"\r[{'#' * done}{' ' * (30 - done)}] {100 * p.fraction:5.1f} %  {p.spp:.1f} spp  {p.seconds:.1f} s", end="",
              file=sys.stderr, flush=True)
        self._told = True

    def close(self) -> None:
        if self._told:
            print(file=sys.stderr)


class _Picture:
    """Picture of a render as it grows, in a notebook."""

    def __init__(self, display: Callable[..., Any] | None) -> None:
        self._display, self._handle, self._shown_at = display, None, float("-inf")

    def __call__(self, p: Progress) -> None:
        is_due = time.monotonic() - self._shown_at >= INTERVAL or p.fraction >= 1
        image = p.image if self._display and is_due else None
        if image is None:
            return
        if self._handle is None:
            self._handle = self._display(image, display_id=True)
        else:
            self._handle.update(image)
        self._shown_at = time.monotonic()
