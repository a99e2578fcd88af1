"""Frames of animations."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

from . import _steradian
from ._steradian import Image, Progress

if TYPE_CHECKING:
    from ._scene import Scene

MOST_FRAMED = 17
"""Most moments by which automatic cameras are framed, as those of the command line."""


def rendered(
    scene: Scene, settings: dict[str, Any], frames: range | tuple[int, int], fps: float, progress: bool | Callable[[Progress], Any]
) -> Iterator[Image]:
    """Pictures of frames, one after the other; what is wrong with the settings is told at once."""
    numbers = list(frames if isinstance(frames, range) else range(frames[0], frames[1] + 1))
    if not numbers or min(numbers) < 0 or max(numbers) >= 1 << 32:
        raise ValueError(f"frames are a range, or first and last of them, of whole numbers from 0, not {frames}")
    if not 0.001 <= fps <= 100_000.0:
        raise ValueError(f"fps is a number from 0.001 to 100000, not {fps}")
    _steradian.Settings(**settings, frame=numbers[0])
    # Of some frames, first and last among them, so that automatic cameras stand still.
    first, last = min(numbers), max(numbers)
    steps = min(last - first, MOST_FRAMED - 1)
    framing = scene._inner.framing([(first + k / max(steps, 1) * (last - first)) / fps for k in range(steps + 1)])

    def pictures() -> Iterator[Image]:
        before = _steradian.Frames()
        for number in numbers:
            frame = scene._like(scene._inner.moment(number / fps, framing))
            image = frame._rendered({**settings, "frame": number}, progress, before=before)
            scene._warn(frame._inner.messages, 4)
            yield image

    return pictures()
