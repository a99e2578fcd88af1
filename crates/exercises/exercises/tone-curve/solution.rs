//! From radiance to the display; the task is in README.md.
#![allow(unused_variables)]

/// The relative luminance of linear Rec.709 values.
pub fn luminance(rgb: [f64; 3]) -> f64 {
    // gap
    0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
    // end
}

/// The luminance on the display, by Reinhard's curve with a white point.
pub fn reinhard(luminance: f64, white: f64) -> f64 {
    // gap
    luminance * (1.0 + luminance / (white * white)) / (1.0 + luminance)
    // end
}

/// The encoded value of sRGB.
pub fn encode(linear: f64) -> f64 {
    // gap
    if linear <= 0.0031308 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
    // end
}

/// The linear value of sRGB.
pub fn decode(encoded: f64) -> f64 {
    // gap
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
    // end
}
