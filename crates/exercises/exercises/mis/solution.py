"""Multiple importance sampling; the task is in README.md."""


def weight(p, other):
    """The weight of the power heuristic for a point that was drawn with density p."""
    # gap
    below = p * p + other * other
    return p * p / below if below > 0 else 0.0
    # end


def estimate(fa, pa_a, pb_a, fb, pa_b, pb_b):
    """The estimate of the integral from one point of each strategy."""
    # gap
    return weight(pa_a, pb_a) * fa / pa_a + weight(pb_b, pa_b) * fb / pb_b
    # end
