"""A rough mirror by GGX; the task is in README.md."""

import math


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def distribution(alpha, cos_m):
    """The density D of facets' normals (1/sr)."""
    # gap
    a2 = alpha * alpha
    bracket = cos_m * cos_m * (a2 - 1) + 1
    return a2 / (math.pi * bracket**2)
    # end


def shadowing(alpha, cos_o, cos_i):
    """The part of the facets that are lit and seen."""
    # gap
    def hidden(cosine):
        tan2 = (1 - cosine * cosine) / (cosine * cosine)
        return (-1 + math.sqrt(1 + alpha * alpha * tan2)) / 2

    return 1 / (1 + hidden(cos_o) + hidden(cos_i))
    # end


def eval(f0, alpha, wo, wi):
    """The BRDF (1/sr), without the cosine; 0 if a direction is below the surface."""
    # gap
    if wo[2] <= 0 or wi[2] <= 0:
        return 0.0
    m = [a + b for a, b in zip(wo, wi)]
    length = math.sqrt(dot(m, m))
    m = [x / length for x in m]
    cosine = dot(wo, m)
    fresnel = f0 + (1 - f0) * (1 - cosine) ** 5
    lit = distribution(alpha, m[2]) * shadowing(alpha, wo[2], wi[2])
    return fresnel * lit / (4 * wo[2] * wi[2])
    # end
