"""From radiance to the display; the task is in README.md."""


def luminance(rgb):
    """The relative luminance of linear Rec.709 values."""
    # gap
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
    # end


def reinhard(luminance, white):
    """The luminance on the display, by Reinhard's curve with a white point."""
    # gap
    return luminance * (1 + luminance / white**2) / (1 + luminance)
    # end


def encode(linear):
    """The encoded value of sRGB."""
    # gap
    if linear <= 0.0031308:
        return 12.92 * linear
    return 1.055 * linear ** (1 / 2.4) - 0.055
    # end


def decode(encoded):
    """The linear value of sRGB."""
    # gap
    if encoded <= 0.04045:
        return encoded / 12.92
    return ((encoded + 0.055) / 1.055) ** 2.4
    # end
