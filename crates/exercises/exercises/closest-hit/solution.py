"""A closest-hit shader; the task is in README.md."""

import math


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def columns_of_inverse(m):
    """The columns of the inverse: cross products of rows over the determinant."""
    r0, r1, r2 = m[0:3], m[3:6], m[6:9]
    determinant = dot(r0, cross(r1, r2))
    return [[x / determinant for x in c] for c in (cross(r1, r2), cross(r2, r0), cross(r0, r1))]


def attribute(beta, gamma, a):
    """The attribute at the hit."""
    # gap
    alpha = 1 - beta - gamma
    return alpha * a[0] + beta * a[1] + gamma * a[2]
    # end


def to_object(m, b, o, d):
    """Origin and direction of the ray in the object."""
    # gap
    c = columns_of_inverse(m)
    p = [o[i] - b[i] for i in range(3)]
    origin = [sum(c[j][i] * p[j] for j in range(3)) for i in range(3)]
    direction = [sum(c[j][i] * d[j] for j in range(3)) for i in range(3)]
    return origin + direction
    # end


def normal(m, n):
    """The normal in the world."""
    # gap
    # The rows of the inverse transpose are the columns of the inverse.
    turned = [dot(c, n) for c in columns_of_inverse(m)]
    length = math.sqrt(dot(turned, turned))
    return [x / length for x in turned]
    # end
