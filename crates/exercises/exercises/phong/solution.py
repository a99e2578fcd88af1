"""Phong's lobe as a BRDF; the task is in README.md."""

import math


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def mirror(w):
    """The mirror direction of w."""
    # gap
    return (-w[0], -w[1], w[2])
    # end


def eval(ks, n, wo, wi):
    """The BRDF (1/sr), without the cosine; 0 if a direction is below the surface."""
    # gap
    if wo[2] <= 0 or wi[2] <= 0:
        return 0.0
    cosine = max(0, dot(mirror(wo), wi))
    return ks * (n + 2) / (2 * math.pi) * cosine**n
    # end


def sample(n, wo, u1, u2):
    """A direction around the mirror direction of wo."""
    # gap
    z = mirror(wo)
    # Two directions at right angles to z and to each other.
    a = (1, 0, 0) if abs(z[0]) < 0.5 else (0, 1, 0)
    x = (a[1] * z[2] - a[2] * z[1], a[2] * z[0] - a[0] * z[2], a[0] * z[1] - a[1] * z[0])
    length = math.sqrt(dot(x, x))
    x = tuple(c / length for c in x)
    y = (z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0])
    cosine, phi = u1 ** (1 / (n + 1)), 2 * math.pi * u2
    sine = math.sqrt(max(0, 1 - cosine * cosine))
    return tuple(sine * math.cos(phi) * x[i] + sine * math.sin(phi) * y[i] + cosine * z[i] for i in range(3))
    # end


def pdf(n, wo, wi):
    """The density of `sample` (1/sr)."""
    # gap
    cosine = max(0, dot(mirror(wo), wi))
    return (n + 1) / (2 * math.pi) * cosine**n
    # end
