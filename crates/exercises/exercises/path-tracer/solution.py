"""A path tracer in a sphere that glows; the task is in README.md."""

import math


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def hit(o, d):
    """The distance along the ray to the unit sphere, from inside."""
    # gap
    b, c = dot(o, d), dot(o, o) - 1
    return -b + math.sqrt(max(0, b * b - c))
    # end


def direction(n, u1, u2):
    """A direction on the side of n, drawn in proportion to its cosine."""
    # gap
    x = cross((1, 0, 0) if abs(n[0]) < 0.5 else (0, 1, 0), n)
    length = math.sqrt(dot(x, x))
    x = [c / length for c in x]
    y = cross(n, x)
    r, phi = math.sqrt(u1), 2 * math.pi * u2
    z = math.sqrt(1 - u1)
    return tuple(r * math.cos(phi) * x[i] + r * math.sin(phi) * y[i] + z * n[i] for i in range(3))
    # end


def radiance(albedo, o, d, u):
    """The radiance at o from the direction d, estimated by one path of four bounces."""
    # gap
    t = hit(o, d)
    p = [o[i] + t * d[i] for i in range(3)]
    light, beta = 1 + p[2], 1.0
    for k in range(4):
        d = direction([-c for c in p], u[2 * k], u[2 * k + 1])
        beta *= albedo
        t = hit(p, d)
        p = [p[i] + t * d[i] for i in range(3)]
        light += beta * (1 + p[2])
    return light
    # end
