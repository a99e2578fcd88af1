//! Primaries that a file names (`chromaticities`), and the matrix from its colours to Rec.709.
//!
//! The columns of the matrix to XYZ are the primaries, scaled so that they add up to the white (SMPTE RP 177). A white
//! other than D65 is adapted by Bradford's cone responses (ICC.1:2022, annex E), as colour management does: white stays
//! white. Where the primaries are X, Y and Z themselves, the values are XYZ as they stand, whatever white is named.

use exr::meta::attribute::Chromaticities;
use steradian_math::{DMat3, DVec3, color::space::REC709};

/// Largest difference of a coordinate at which primaries count as those of Rec.709.
const SAME: f32 = 1e-3;

/// Rec.709 primaries and D65 as files write them.
const REC709_XY: [[f32; 2]; 4] = [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], [0.3127, 0.329]];

/// X, Y and Z as primaries.
const XYZ_XY: [[f32; 2]; 3] = [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]];

/// Cone responses of Bradford's transform, by columns.
const BRADFORD: DMat3 =
    DMat3::from_cols_array(&[0.8951, -0.7502, 0.0389, 0.2664, 1.7135, -0.0685, -0.1614, 0.0367, 1.0296]);

fn coordinates(c: Chromaticities) -> [[f32; 2]; 4] {
    [c.red, c.green, c.blue, c.white].map(|v| [v.x(), v.y()])
}

fn are_close(a: &[[f32; 2]], b: &[[f32; 2]]) -> bool {
    a.as_flattened().iter().zip(b.as_flattened()).all(|(a, b)| (a - b).abs() <= SAME)
}

/// The coordinates as one text, `x y` of red, green, blue and white.
pub(super) fn text(c: Chromaticities) -> String {
    coordinates(c).as_flattened().iter().map(f32::to_string).collect::<Vec<_>>().join(" ")
}

/// True if the primaries and the white are those of Rec.709.
pub(super) fn are_rec709(c: Chromaticities) -> bool {
    are_close(&coordinates(c), &REC709_XY)
}

/// The matrix from these primaries to XYZ, for white of luminance 1; `None` for primaries that span no gamut.
pub(super) fn to_xyz(c: Chromaticities) -> Option<DMat3> {
    let xy = coordinates(c);
    if are_close(&xy[..3], &XYZ_XY) {
        return Some(DMat3::IDENTITY);
    }
    let [r, g, b, w] = xy.map(|[x, y]| [x, y].map(f64::from)).map(|[x, y]| DVec3::new(x, y, 1.0 - x - y));
    let primaries = DMat3::from_cols(r, g, b);
    let white = w / w.y;
    let scale = primaries.inverse() * white;
    let matrix = primaries * DMat3::from_diagonal(scale);
    let weights = matrix.row(1);
    (primaries.determinant().abs() > 1e-6 && matrix.is_finite() && weights.y.abs() > 1e-6).then_some(matrix)
}

/// The matrix from colours of these primaries to Rec.709; `None` for primaries or a white that allow none.
pub(super) fn to_rec709(c: Chromaticities) -> Option<DMat3> {
    let xyz = to_xyz(c)?;
    // XYZ are absolute, also where the file names a white.
    let adapted = if xyz == DMat3::IDENTITY { xyz } else { adaptation(xyz * DVec3::ONE, REC709.white())? * xyz };
    let matrix = REC709.rgb_from_xyz() * adapted;
    matrix.is_finite().then_some(matrix)
}

/// The matrix of XYZ that turns one white into another; `None` for a white without cone responses.
fn adaptation(from: DVec3, to: DVec3) -> Option<DMat3> {
    let [from, to] = [from, to].map(|white| BRADFORD * white);
    let gain = to / from;
    (from.min_element() > 0.0 && gain.is_finite()).then(|| BRADFORD.inverse() * DMat3::from_diagonal(gain) * BRADFORD)
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::math::Vec2;

    fn of([r, g, b, w]: [[f32; 2]; 4]) -> Chromaticities {
        let [red, green, blue, white] = [r, g, b, w].map(|[x, y]| Vec2(x, y));
        Chromaticities { red, green, blue, white }
    }

    const ACESCG: [[f32; 2]; 4] = [[0.713, 0.293], [0.165, 0.83], [0.128, 0.044], [0.32168, 0.33767]];
    const AP0: [[f32; 2]; 4] = [[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.077], [0.32168, 0.33767]];

    /// One colour as files in ACEScg, Rec.2020, P3 and XYZ have it.
    #[test]
    fn a_colour_is_the_same_in_all_primaries() {
        let rec2020 = [[0.708, 0.292], [0.17, 0.797], [0.131, 0.046], [0.3127, 0.329]];
        let p3 = [[0.68, 0.32], [0.265, 0.69], [0.15, 0.06], [0.3127, 0.329]];
        let xyz = [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [0.3127, 0.329]];
        let equal_energy = [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [1.0 / 3.0; 2]];
        for (primaries, red) in [
            (ACESCG, [0.5405, 0.1062, 0.0665]),
            (rec2020, [0.5519, 0.1053, 0.0631]),
            (p3, [0.7080, 0.0766, 0.0637]),
            (xyz, [0.3775, 0.2201, 0.0699]),
            (equal_energy, [0.3775, 0.2201, 0.0699]),
        ] {
            let back = to_rec709(of(primaries)).unwrap() * DVec3::from(red);
            assert!((back - DVec3::new(0.85, 0.05, 0.05)).abs().max_element() < 1e-3, "{primaries:?} {back}");
        }
    }

    #[test]
    fn white_stays_white() {
        for primaries in [ACESCG, AP0, REC709_XY] {
            let white = to_rec709(of(primaries)).unwrap() * DVec3::ONE;
            assert!((white - 1.0).abs().max_element() < 1e-9, "{white}");
        }
    }

    #[test]
    fn primaries_without_a_gamut_have_no_matrix() {
        let mut flat = REC709_XY;
        flat[1] = flat[0];
        assert!(to_rec709(of(flat)).is_none());
        for broken in [f32::NAN, f32::INFINITY, 0.0] {
            let mut white = REC709_XY;
            white[3] = [0.3, broken];
            assert!(to_rec709(of(white)).is_none(), "{broken}");
        }
    }
}
