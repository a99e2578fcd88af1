"""Edge functions; the task is in README.md."""


def edge(a, b, p):
    """Twice the signed area of the triangle a, b, p."""
    # gap
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
    # end


def weights(a, b, c, p):
    """The barycentric weights of the corners at p."""
    # gap
    e = (edge(b, c, p), edge(c, a, p), edge(a, b, p))
    total = sum(e)
    return tuple(x / total for x in e)
    # end


def covers(a, b, c, p):
    """1 if the triangle covers p, otherwise 0."""
    # gap
    e = (edge(b, c, p), edge(c, a, p), edge(a, b, p))
    left, right = all(x >= 0 for x in e), all(x <= 0 for x in e)
    return 1 if left or right else 0
    # end
