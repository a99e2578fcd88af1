"""Interpolation in perspective; the task is in README.md."""


def interpolate(b, a, w):
    """The attribute on the surface, by weights on the screen."""
    # gap
    above = sum(b[i] * a[i] / w[i] for i in range(3))
    below = sum(b[i] / w[i] for i in range(3))
    return above / below
    # end


def depth(distance, near, far):
    """Depth after the division, from 0 to 1."""
    # gap
    return far * (distance - near) / (distance * (far - near))
    # end
