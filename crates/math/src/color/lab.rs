//! CIELAB (CIE 15) relative to a given white, and the colour difference ΔE*ab (CIE 1976).

use glam::DVec3;

/// `(L*, a*, b*)` of XYZ relative to the white `white` (all components positive).
pub fn lab_from_xyz(xyz: DVec3, white: DVec3) -> DVec3 {
    let f = |t: f64| if t > DELTA3 { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 };
    lab((xyz / white).map(f))
}

/// The derivative of each component of `f(t)` in [`lab_from_xyz`] with respect to XYZ, for optimisers.
pub(crate) fn lab_slope(xyz: DVec3, white: DVec3) -> DVec3 {
    let df = |t: f64| if t > DELTA3 { 1.0 / (3.0 * t.cbrt().powi(2)) } else { 1.0 / (3.0 * DELTA * DELTA) };
    (xyz / white).map(df) / white
}

/// `(L* + 16, a*, b*)` is linear in the compressed components: this is that map, which also carries derivatives.
pub(crate) fn lab_linear(f: DVec3) -> DVec3 {
    DVec3::new(116.0 * f.y, 500.0 * (f.x - f.y), 200.0 * (f.y - f.z))
}

fn lab(f: DVec3) -> DVec3 {
    lab_linear(f) - DVec3::new(16.0, 0.0, 0.0)
}

const DELTA: f64 = 6.0 / 29.0;
const DELTA3: f64 = DELTA * DELTA * DELTA;

/// ΔE*ab of two XYZ colours under the white `white`: 1 is about the smallest difference that an observer notices.
pub fn delta_e(a: DVec3, b: DVec3, white: DVec3) -> f64 {
    (lab_from_xyz(a, white) - lab_from_xyz(b, white)).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHITE: DVec3 = DVec3::new(0.95, 1.0, 1.09);

    #[test]
    fn white_black_and_grey() {
        assert!((lab_from_xyz(WHITE, WHITE) - DVec3::new(100.0, 0.0, 0.0)).length() < 1e-12);
        assert!(lab_from_xyz(DVec3::ZERO, WHITE).length() < 1e-12);
        // 18.42 % reflectance is L* = 50.
        assert!((lab_from_xyz(WHITE * 0.184187, WHITE).x - 50.0).abs() < 1e-3);
        assert!((delta_e(WHITE, DVec3::ZERO, WHITE) - 100.0).abs() < 1e-12);
    }

    #[test]
    fn the_slope_is_the_derivative_on_both_segments() {
        for xyz in [DVec3::new(0.2, 0.3, 0.1), DVec3::new(0.002, 0.003, 0.001)] {
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                let h = 1e-7;
                let numeric = (lab_from_xyz(xyz + axis * h, WHITE) - lab_from_xyz(xyz - axis * h, WHITE)) / (2.0 * h);
                let exact = lab_linear(lab_slope(xyz, WHITE) * axis);
                assert!((numeric - exact).length() < 1e-4 * exact.length(), "{numeric} {exact}");
            }
        }
    }
}
