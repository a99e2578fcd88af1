"""Direct light of a lamp; the task is in README.md."""

import math


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def direct(albedo, radiance, corner, a, b, visible, u):
    """The reflected radiance at the origin, estimated by one point on the lamp."""
    # gap
    if not visible:
        return 0.0
    y = [corner[i] + u[0] * a[i] + u[1] * b[i] for i in range(3)]
    r = math.sqrt(dot(y, y))
    lamp = cross(a, b)
    area = math.sqrt(dot(lamp, lamp))
    cos_x = max(0, y[2] / r)
    cos_y = max(0, -dot(lamp, y) / (area * r))
    return albedo / math.pi * radiance * cos_x * cos_y / r**2 * area
    # end
