"""Russian roulette; the task is in README.md."""


def survive(beta, u):
    """The throughput with which a path goes on, or 0 if it ends."""
    # gap
    s = min(1, beta)
    return beta / s if u < s else 0.0
    # end


def radiance(emission, albedo, u):
    """The radiance in a closed room, estimated by one path."""
    # gap
    light, beta = emission, 1.0
    for number in u:
        if number >= albedo:
            break
        beta *= albedo / albedo
        light += beta * emission
    return light
    # end
