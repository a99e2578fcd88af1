"""Levels of a mip-map; the task is in README.md."""

import math


def level(dx, dy, width, height, count):
    """The level for a footprint, with its fraction."""
    # gap
    right = math.hypot(dx[0] * width, dx[1] * height)
    below = math.hypot(dy[0] * width, dy[1] * height)
    longest = max(right, below)
    value = math.log2(longest)
    return min(max(value, 0), count - 1)
    # end


def blend(level, values):
    """The value between the two levels around a level."""
    # gap
    first = int(level)
    t = level - first
    second = min(first + 1, 3)
    return (1 - t) * values[first] + t * values[second]
    # end
