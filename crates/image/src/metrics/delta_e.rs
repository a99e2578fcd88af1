//! Colour differences ΔE of two pictures, as their display values are seen.

use super::colours;
use crate::{Image, Result};
use steradian_math::{
    DVec3,
    color::{difference, lab::lab_from_xyz, space::REC709},
};

/// Colour differences in CIELAB under D65; 1 is about the smallest that an observer notices side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeltaE {
    /// Mean of ΔE*ab (CIE 1976), the distance in CIELAB.
    pub cie76: f64,
    /// Mean of ΔE*94 (CIE 116-1995), graphic-arts constants; the reference is the standard.
    pub cie94: f64,
    /// Mean of ΔE00 (CIE 142-2001).
    pub ciede2000: f64,
    /// Largest ΔE00.
    pub max_ciede2000: f64,
}

/// ΔE of the linear Rec.709 colours of two pictures, cut to [0, 1] as a display shows them. Pixels that are not finite
/// in either picture are left out; where none is left, all is NaN.
///
/// # Errors
/// [`Error::SizeMismatch`](crate::Error::SizeMismatch), [`Error::MissingChannels`](crate::Error::MissingChannels).
pub fn delta_e(image: &Image, reference: &Image) -> Result<DeltaE> {
    let (a, b) = colours(image, reference)?;
    let to_xyz = REC709.xyz_from_rgb();
    let lab = |rgb: [f32; 3]| {
        let shown = DVec3::from(rgb.map(f64::from)).clamp(DVec3::ZERO, DVec3::ONE);
        lab_from_xyz(to_xyz * shown, REC709.white())
    };
    let (mut sum, mut max, mut count) = ([0.0; 3], 0.0f64, 0usize);
    for i in 0..image.pixel_count() {
        let (x, r) = (a.at(i), b.at(i));
        if !x.iter().chain(&r).all(|v| v.is_finite()) {
            continue;
        }
        count += 1;
        if x == r {
            continue;
        }
        let (x, r) = (lab(x), lab(r));
        let seen = difference::delta_e_2000(r, x);
        for (sum, d) in sum.iter_mut().zip([(x - r).length(), difference::delta_e_94(r, x), seen]) {
            *sum += d;
        }
        max = max.max(seen);
    }
    let [cie76, cie94, ciede2000] = sum.map(|s| s / count as f64);
    let max = if count == 0 { f64::NAN } else { max };
    Ok(DeltaE { cie76, cie94, ciede2000, max_ciede2000: max })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(pixels: &[[f32; 3]], reference: &[[f32; 3]]) -> DeltaE {
        let picture = |p: &[[f32; 3]]| Image::from_rgb(p.len(), 1, p).unwrap();
        delta_e(&picture(pixels), &picture(reference)).unwrap()
    }

    /// White against black is 100 in each measure; values beyond the display's range and pixels that are equal count
    /// nothing.
    #[test]
    fn white_and_black_are_a_hundred_apart() {
        let d = of(&[[1.0; 3], [7.0; 3]], &[[0.0; 3], [1.0; 3]]);
        for mean in [d.cie76, d.cie94, d.ciede2000] {
            assert!((mean - 50.0).abs() < 1e-6, "{d:?}");
        }
        assert!((d.max_ciede2000 - 100.0).abs() < 1e-6);
    }

    /// The sRGB primaries red and green: ΔE76 170.566, ΔE94 73.429 with red as the standard, ΔE00 86.608
    /// (colour-science 0.4 with four-digit chromaticities of D65).
    #[test]
    fn red_and_green() {
        let d = of(&[[0.0, 1.0, 0.0]], &[[1.0, 0.0, 0.0]]);
        for (value, exact) in [(d.cie76, 170.566), (d.cie94, 73.429), (d.ciede2000, 86.608)] {
            assert!((value - exact).abs() < 0.02, "{d:?}");
        }
    }

    #[test]
    fn pixels_that_are_not_numbers_are_left_out() {
        let d = of(&[[f32::NAN; 3], [0.5; 3]], &[[0.1; 3], [0.5; 3]]);
        assert_eq!(d, DeltaE { cie76: 0.0, cie94: 0.0, ciede2000: 0.0, max_ciede2000: 0.0 });
        let nan = Image::from_rgb(1, 1, &[[f32::NAN; 3]]).unwrap();
        let none = delta_e(&nan, &nan).unwrap();
        assert!(none.ciede2000.is_nan() && none.max_ciede2000.is_nan());
    }
}
