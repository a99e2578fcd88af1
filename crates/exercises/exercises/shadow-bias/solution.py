"""Shadow maps; the task is in README.md."""

import math


def bias(texel, cosine, most):
    """The depth that a surface may change over half a texel."""
    # gap
    tangent = math.sqrt(1 - cosine * cosine) / cosine
    return texel / 2 * min(tangent, most)
    # end


def lit(depth, bias, map):
    """The part of nine texels for which the point is lit."""
    # gap
    return sum(depth - bias <= kept for kept in map) / 9
    # end


def penumbra(lamp, blocker, receiver):
    """The width of the half-shadow."""
    # gap
    return lamp * (receiver - blocker) / blocker
    # end
