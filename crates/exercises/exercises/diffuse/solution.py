"""A matt surface; the task is in README.md."""

import math


def eval(albedo, wo, wi):
    """The BRDF (1/sr), without the cosine; 0 if a direction is below the surface."""
    # gap
    if wo[2] <= 0 or wi[2] <= 0:
        return 0.0
    return albedo / math.pi
    # end


def sample(u1, u2):
    """A direction above the surface, drawn in proportion to its cosine."""
    # gap
    r, phi = math.sqrt(u1), 2 * math.pi * u2
    return (r * math.cos(phi), r * math.sin(phi), math.sqrt(1 - u1))
    # end


def pdf(wi):
    """The density of `sample` (1/sr)."""
    # gap
    return max(0, wi[2]) / math.pi
    # end
