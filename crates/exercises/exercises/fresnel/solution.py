"""Reflectance of glass; the task is in README.md."""

import math


def reflectance(cos_i, eta):
    """The part of unpolarised light that is reflected; eta is n_t/n_i."""
    # gap
    sin2_t = (1 - cos_i * cos_i) / (eta * eta)
    if sin2_t >= 1:
        return 1.0
    cos_t = math.sqrt(1 - sin2_t)
    r_s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t)
    r_p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t)
    return (r_s * r_s + r_p * r_p) / 2
    # end
