"""The surface area heuristic; the task is in README.md."""


def area(lo, hi):
    """The surface area of a box."""
    # gap
    x, y, z = (hi[k] - lo[k] for k in range(3))
    return 2 * (x * y + y * z + z * x)
    # end


def cost(area, left_area, left_count, right_area, right_count, step, test):
    """The expected cost of a ray that meets the node."""
    # gap
    tests = left_area * left_count + right_area * right_count
    return step + test * tests / area
    # end


def best(left_areas, right_areas):
    """The number of primitives on the left in the cheapest split of six."""
    # gap
    costs = [left_areas[i] * (i + 1) + right_areas[i] * (5 - i) for i in range(5)]
    return costs.index(min(costs)) + 1
    # end
