"""Form factors; the task is in README.md."""

import math


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def kernel(x, nx, y, ny):
    """The kernel of the form factor at two points (1/m²)."""
    # gap
    d = [y[i] - x[i] for i in range(3)]
    r = math.sqrt(dot(d, d))
    cos_x = max(0, dot(nx, d) / r)
    cos_y = max(0, -dot(ny, d) / r)
    return cos_x * cos_y / (math.pi * r**2)
    # end


def reverse(f_ij, area_i, area_j):
    """The form factor the other way."""
    # gap
    return f_ij * area_i / area_j
    # end


def step(emission, albedo, f, b):
    """The radiosity of a patch after one step of Jacobi's iteration (W/m²)."""
    # gap
    return emission + albedo * sum(f[j] * b[j] for j in range(4))
    # end
