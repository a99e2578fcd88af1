//! Pictures of differences.

use super::{DEFAULT_PIXELS_PER_DEGREE, colours, flip_map};
use crate::encoding::srgb_decode;
use crate::{Image, Result};

/// Nine evenly spaced colours of the map "magma" (S. van der Walt, N. Smith 2015), sRGB codes.
const MAGMA: [[u8; 3]; 9] = [
    [0, 0, 4],
    [28, 16, 68],
    [79, 18, 123],
    [129, 37, 129],
    [181, 54, 122],
    [229, 89, 100],
    [251, 135, 97],
    [254, 194, 135],
    [252, 253, 191],
];

/// The colour of a number in [0, 1] in the map "magma", linear Rec.709: from black by purple and orange to light
/// yellow.
pub fn magma(x: f32) -> [f32; 3] {
    let place = x.clamp(0.0, 1.0) * (MAGMA.len() - 1) as f32;
    let k = (place as usize).min(MAGMA.len() - 2);
    let t = place - k as f32;
    std::array::from_fn(|c| {
        let [a, b] = [MAGMA[k][c], MAGMA[k + 1][c]].map(f32::from);
        srgb_decode((a + (b - a) * t) / 255.0)
    })
}

/// |image − reference| of each component.
///
/// # Errors
/// [`Error::SizeMismatch`](crate::Error::SizeMismatch), [`Error::MissingChannels`](crate::Error::MissingChannels).
pub fn absolute_difference(image: &Image, reference: &Image) -> Result<Image> {
    let (a, b) = colours(image, reference)?;
    let difference = |i: usize| {
        let (a, b) = (a.at(i), b.at(i));
        std::array::from_fn(|c| (a[c] - b[c]).abs())
    };
    let pixels: Vec<[f32; 3]> = (0..image.pixel_count()).map(difference).collect();
    Image::from_rgb(image.width(), image.height(), &pixels)
}

/// The FLIP error of each pixel as a colour, from black (no difference) by purple and orange to light yellow (1).
///
/// # Errors
/// As [`flip`](super::flip).
pub fn flip_picture(image: &Image, reference: &Image) -> Result<Image> {
    let map = flip_map(image, reference, DEFAULT_PIXELS_PER_DEGREE)?;
    let pixels: Vec<[f32; 3]> = map.into_iter().map(magma).collect();
    Image::from_rgb(image.width(), image.height(), &pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_differs_is_bright() {
        let mut pixels = vec![[0.5; 3]; 256];
        let a = Image::from_rgb(16, 16, &pixels).unwrap();
        pixels[8 * 16 + 8] = [0.5, 0.75, 0.25];
        let b = Image::from_rgb(16, 16, &pixels).unwrap();
        let difference = absolute_difference(&a, &b).unwrap();
        assert_eq!(difference.rgb().unwrap().at(8 * 16 + 8), [0.0, 0.25, 0.25]);
        assert_eq!(difference.rgb().unwrap().at(0), [0.0; 3]);
        let seen = flip_picture(&a, &b).unwrap();
        let seen = seen.rgb().unwrap();
        assert!(
            seen.at(8 * 16 + 8)[0] > 0.02 && seen.at(0)[0] < 0.25 * seen.at(8 * 16 + 8)[0],
            "{:?}",
            seen.at(8 * 16 + 8)
        );
        let mean = super::super::flip(&a, &b, DEFAULT_PIXELS_PER_DEGREE).unwrap();
        let map = flip_map(&a, &b, DEFAULT_PIXELS_PER_DEGREE).unwrap();
        assert!((map.iter().map(|e| f64::from(*e)).sum::<f64>() / 256.0 - mean).abs() < 1e-12);
    }
}
