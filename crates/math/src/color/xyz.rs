//! CIE XYZ and its relatives: chromaticity with luminance (xyY), and the CIE 1931 RGB primaries.

use glam::{DMat3, DVec3};

/// XYZ of chromaticity `(x, y)` and luminance `Y`; black where `y` is zero.
pub fn xyz_from_xyy(x: f64, y: f64, luminance: f64) -> DVec3 {
    if y == 0.0 { DVec3::ZERO } else { DVec3::new(x, y, 1.0 - x - y) * (luminance / y) }
}

/// `(x, y, Y)` of XYZ; black has no chromaticity and gives `(0, 0, 0)`.
pub fn xyy_from_xyz(xyz: DVec3) -> [f64; 3] {
    let sum = xyz.element_sum();
    if sum == 0.0 { [0.0; 3] } else { [xyz.x / sum, xyz.y / sum, xyz.y] }
}

/// XYZ from CIE 1931 RGB (primaries 700 nm, 546.1 nm and 435.8 nm, white E): the integers of the 1931 resolutions over
/// 0.17697. Each row sums to 1/0.17697, so that equal RGB is equal XYZ.
fn xyz_from_cie_rgb() -> DMat3 {
    let rows = [[0.49, 0.31, 0.20], [0.17697, 0.81240, 0.01063], [0.0, 0.01, 0.99]];
    DMat3::from_cols_array_2d(&rows).transpose() * (1.0 / 0.17697)
}

/// CIE 1931 RGB (primaries 700 nm, 546.1 nm and 435.8 nm, white E) from XYZ: the inverse of the matrix of the 1931
/// resolutions, times 0.17697 of which equal RGB of 1 is equal XYZ of 5.65.
pub fn cie_rgb_from_xyz() -> DMat3 {
    xyz_from_cie_rgb().inverse()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chromaticity_round_trip() {
        let xyz = DVec3::new(0.3, 0.4, 0.5);
        let [x, y, l] = xyy_from_xyz(xyz);
        assert!((xyz_from_xyy(x, y, l) - xyz).length() < 1e-15);
        assert_eq!(xyz_from_xyy(0.3, 0.0, 1.0), DVec3::ZERO);
        assert_eq!(xyy_from_xyz(DVec3::ZERO), [0.0; 3]);
    }

    #[test]
    fn cie_rgb_white_is_equal_energy_and_the_matrices_are_inverse() {
        let white = xyz_from_cie_rgb() * DVec3::ONE * 0.17697;
        assert!((white - DVec3::ONE).length() < 1e-12, "{white}");
        let i = xyz_from_cie_rgb() * cie_rgb_from_xyz();
        assert!(i.abs_diff_eq(DMat3::IDENTITY, 1e-12));
    }

    /// The red primary is monochromatic light of 700 nm: it has that light's chromaticity.
    #[test]
    fn cie_primaries_are_where_the_observer_sees_them() {
        let m = xyz_from_cie_rgb();
        for (col, lambda) in [(0, 700.0), (1, 546.1), (2, 435.8)] {
            let [x, y, _] = xyy_from_xyz(m.col(col));
            let [u, v, _] = xyy_from_xyz(crate::spectra::cie::matching_linear(lambda).into());
            assert!((x - u).abs() < 2e-3 && (y - v).abs() < 2e-3, "{lambda} nm: ({x}, {y}) and ({u}, {v})");
        }
    }
}
