//! RGB colour spaces: primaries and white, and the matrices to and from CIE XYZ that follow from them.
//!
//! The matrices are derived in `f64` from the primaries' chromaticities and the XYZ of the white illuminant, integrated
//! from its tabulated spectrum; four-digit matrices found in print deviate from being each other's inverse by 4e-5.
//! That the white is the illuminant itself, not its rounded chromaticity, makes the spectrum of D65 exactly RGB (1, 1,
//! 1).

use crate::spectra::named::{Illuminant, white_xyz};
use crate::{Mat3, Vec3};
use glam::{DMat3, DVec3};

/// An RGB colour space: linear components of three primaries, with RGB (1, 1, 1) the white at luminance 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RgbSpace {
    name: &'static str,
    primaries: [[f64; 2]; 3],
    white: DVec3,
    xyz_from_rgb: DMat3,
    rgb_from_xyz: DMat3,
    rgb_from_xyz_f32: Mat3,
}

/// sRGB and Rec.709 (ITU-R BT.709): the space of this renderer. White D65.
pub static REC709: RgbSpace =
    RgbSpace::derive("srgb", [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06]], white_xyz(Illuminant::D65));
/// P3 primaries with a D65 white (Display P3 without its transfer function), pbrt's `dci-p3`.
pub static DCI_P3: RgbSpace =
    RgbSpace::derive("dci-p3", [[0.68, 0.32], [0.265, 0.69], [0.15, 0.06]], white_xyz(Illuminant::D65));
/// ITU-R BT.2020, white D65.
pub static REC2020: RgbSpace =
    RgbSpace::derive("rec2020", [[0.708, 0.292], [0.17, 0.797], [0.131, 0.046]], white_xyz(Illuminant::D65));
/// ACES 2065-1 (AP0 primaries, SMPTE ST 2065-1), white ACES D60.
pub static ACES2065_1: RgbSpace =
    RgbSpace::derive("aces2065-1", [[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.077]], white_xyz(Illuminant::AcesD60));

impl RgbSpace {
    /// The spaces that have a name in scene files.
    pub fn all() -> [&'static Self; 4] {
        [&REC709, &DCI_P3, &REC2020, &ACES2065_1]
    }

    /// The space called `name` (`srgb`, `dci-p3`, `rec2020`, `aces2065-1`; case does not matter).
    pub fn named(name: &str) -> Option<&'static Self> {
        Self::all().into_iter().find(|s| s.name.eq_ignore_ascii_case(name))
    }

    /// Solves for the luminances of the primaries that add up to the white, and inverts.
    const fn derive(name: &'static str, primaries: [[f64; 2]; 3], white: [f64; 3]) -> Self {
        // Columns: the XYZ of each primary, at x + y + z = 1 (its scale is solved for).
        let [r, g, b] = primaries;
        let chroma =
            [[r[0], g[0], b[0]], [r[1], g[1], b[1]], [1.0 - r[0] - r[1], 1.0 - g[0] - g[1], 1.0 - b[0] - b[1]]];
        let inv = inverse(chroma);
        let mut m = [[0.0; 3]; 3];
        let mut j = 0;
        while j < 3 {
            let scale = inv[j][0] * white[0] + inv[j][1] * white[1] + inv[j][2] * white[2];
            let mut i = 0;
            while i < 3 {
                m[i][j] = chroma[i][j] * scale;
                i += 1;
            }
            j += 1;
        }
        let back = inverse(m);
        Self {
            name,
            primaries,
            white: DVec3::new(white[0], white[1], white[2]),
            xyz_from_rgb: matrix(m),
            rgb_from_xyz: matrix(back),
            rgb_from_xyz_f32: matrix_f32(back),
        }
    }

    /// The name in scene files.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Chromaticities `(x, y)` of red, green and blue.
    pub fn primaries(&self) -> [[f64; 2]; 3] {
        self.primaries
    }

    /// XYZ of RGB (1, 1, 1); Y = 1.
    pub fn white(&self) -> DVec3 {
        self.white
    }

    /// The matrix from RGB to XYZ.
    pub fn xyz_from_rgb(&self) -> DMat3 {
        self.xyz_from_rgb
    }

    /// The matrix from XYZ to RGB.
    pub fn rgb_from_xyz(&self) -> DMat3 {
        self.rgb_from_xyz
    }

    /// [`rgb_from_xyz`](Self::rgb_from_xyz) rounded to `f32`.
    #[inline]
    pub fn rgb_from_xyz_f32(&self) -> Mat3 {
        self.rgb_from_xyz_f32
    }

    /// The luminance of each primary: `Y = weights · RGB`.
    pub fn luminance_weights(&self) -> DVec3 {
        self.xyz_from_rgb.row(1)
    }

    /// [`luminance_weights`](Self::luminance_weights) rounded to `f32`.
    #[inline]
    pub fn luminance_weights_f32(&self) -> Vec3 {
        self.luminance_weights().as_vec3()
    }

    /// The matrix from RGB of this space to RGB of `to` (no chromatic adaptation: equal XYZ, as in pbrt-v4).
    pub fn to_space(&self, to: &Self) -> DMat3 {
        if self == to { DMat3::IDENTITY } else { to.rgb_from_xyz * self.xyz_from_rgb }
    }

    /// RGB of this space as linear Rec.709. Colours outside that gamut have negative components.
    pub fn to_rec709(&self, rgb: Vec3) -> Vec3 {
        if *self == REC709 { rgb } else { (self.to_space(&REC709) * rgb.as_dvec3()).as_vec3() }
    }
}

/// Inverse of a 3×3 matrix given by rows, by cofactors.
const fn inverse(m: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let mut cofactor = [[0.0; 3]; 3];
    let mut i = 0;
    while i < 3 {
        let (i1, i2) = ((i + 1) % 3, (i + 2) % 3);
        let mut j = 0;
        while j < 3 {
            let (j1, j2) = ((j + 1) % 3, (j + 2) % 3);
            cofactor[j][i] = m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
            j += 1;
        }
        i += 1;
    }
    let det = m[0][0] * cofactor[0][0] + m[0][1] * cofactor[1][0] + m[0][2] * cofactor[2][0];
    let mut i = 0;
    while i < 9 {
        cofactor[i / 3][i % 3] /= det;
        i += 1;
    }
    cofactor
}

const fn matrix(rows: [[f64; 3]; 3]) -> DMat3 {
    let [a, b, c] = rows;
    DMat3::from_cols(DVec3::new(a[0], b[0], c[0]), DVec3::new(a[1], b[1], c[1]), DVec3::new(a[2], b[2], c[2]))
}

const fn matrix_f32(rows: [[f64; 3]; 3]) -> Mat3 {
    let [a, b, c] = rows;
    Mat3::from_cols(
        Vec3::new(a[0] as f32, b[0] as f32, c[0] as f32),
        Vec3::new(a[1] as f32, b[1] as f32, c[1] as f32),
        Vec3::new(a[2] as f32, b[2] as f32, c[2] as f32),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::xyz::xyy_from_xyz;

    #[test]
    fn matrices_are_inverse_and_map_white_and_primaries_where_they_belong() {
        for s in RgbSpace::all() {
            assert!((s.xyz_from_rgb() * s.rgb_from_xyz()).abs_diff_eq(DMat3::IDENTITY, 1e-12), "{}", s.name());
            assert!((s.xyz_from_rgb() * DVec3::ONE - s.white()).length() < 1e-12);
            assert!((s.white().y - 1.0).abs() < 1e-12);
            for (axis, p) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().zip(s.primaries()) {
                let [x, y, _] = xyy_from_xyz(s.xyz_from_rgb() * axis);
                assert!((x - p[0]).abs() < 1e-12 && (y - p[1]).abs() < 1e-12, "{} {x} {y}", s.name());
            }
        }
    }

    #[test]
    fn whites_are_the_published_chromaticities() {
        let [x, y, _] = xyy_from_xyz(REC709.white());
        assert!((x - 0.3127).abs() < 1e-4 && (y - 0.3290).abs() < 1e-4, "{x} {y}");
        let [x, y, _] = xyy_from_xyz(ACES2065_1.white());
        assert!((x - 0.32168).abs() < 2e-4 && (y - 0.33767).abs() < 2e-4, "{x} {y}");
    }

    #[test]
    fn rec709_matches_the_matrix_in_print_to_its_digits() {
        let print = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]];
        let print = DMat3::from_cols_array_2d(&print).transpose();
        assert!(REC709.xyz_from_rgb().abs_diff_eq(print, 2e-4), "{}", REC709.xyz_from_rgb());
    }

    #[test]
    fn conversion_keeps_xyz_and_white_of_the_same_illuminant() {
        let rgb = Vec3::new(0.2, 0.7, 0.4);
        for s in RgbSpace::all() {
            let there = s.to_rec709(rgb).as_dvec3();
            let xyz = s.xyz_from_rgb() * rgb.as_dvec3();
            assert!((REC709.xyz_from_rgb() * there - xyz).length() < 1e-6);
        }
        assert!((REC2020.to_rec709(Vec3::ONE) - Vec3::ONE).length() < 1e-6);
        assert_eq!(REC709.to_rec709(rgb), rgb);
        // The green of Rec.2020 is outside Rec.709.
        assert!(REC2020.to_rec709(Vec3::Y).x < -0.5);
    }

    #[test]
    fn spaces_go_by_their_names() {
        assert_eq!(RgbSpace::named("DCI-P3").unwrap(), &DCI_P3);
        assert!(RgbSpace::named("adobe").is_none());
    }
}
