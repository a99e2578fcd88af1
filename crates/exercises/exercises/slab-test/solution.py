"""The slab test; the task is in README.md."""

import math


def slab(lo, hi, o, d, t_max):
    """Hit (1 or 0), and the first and last distance inside the box."""
    # gap
    near, far = 0.0, t_max
    for k in range(3):
        if d[k] == 0:
            if not lo[k] <= o[k] <= hi[k]:
                return 0, 0, 0
            continue
        t0, t1 = (lo[k] - o[k]) / d[k], (hi[k] - o[k]) / d[k]
        if t0 > t1:
            t0, t1 = t1, t0
        near, far = max(near, t0), min(far, t1)
    if near > far:
        return 0, 0, 0
    return 1, near, far
    # end
