//! AgX (T. Sobotka, 2022), the default view of Blender: compress towards white in a rotated RGB space, log encode,
//! sigmoid, rotate back.
//!
//! Matrices and the sixth-order sigmoid are B. Wrensch's fit ("Minimal AgX Implementation", 2023) of the base look's
//! tables. Its result is for a display with exponent 2.2; that is decoded and encoded again as sRGB.

use super::Curve;
use crate::encoding::srgb_encode;

const INSET: [[f32; 3]; 3] = [
    [0.842_479_06, 0.078_433_6, 0.079_223_745],
    [0.042_328_242, 0.878_468_64, 0.079_166_13],
    [0.042_375_655, 0.078_433_6, 0.879_143],
];
const OUTSET: [[f32; 3]; 3] = [
    [1.196_879, -0.098_020_88, -0.099_029_74],
    [-0.052_896_85, 1.151_903_1, -0.098_961_18],
    [-0.052_971_635, -0.098_043_45, 1.151_073_7],
];
/// Range of the logarithm, in EV.
const EV: [f32; 2] = [-12.47393, 4.026_069];

pub(super) const AGX: Curve = Curve {
    name: "agx",
    doc: "AgX base look (Sobotka 2022; fit by Wrensch 2023)",
    encoding: "sRGB",
    parameters: &[],
    map: |rgb, _| {
        let log = multiply(&INSET, rgb).map(|v| (v.max(1e-10).log2().clamp(EV[0], EV[1]) - EV[0]) / (EV[1] - EV[0]));
        multiply(&OUTSET, log.map(sigmoid)).map(|v| srgb_encode(v.clamp(0.0, 1.0).powf(2.2)))
    },
};

fn sigmoid(x: f32) -> f32 {
    let x2 = x * x;
    let x4 = x2 * x2;
    15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232
}

fn multiply(matrix: &[[f32; 3]; 3], [x, y, z]: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| row[0] * x + row[1] * y + row[2] * z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encoding::srgb_decode;
    use crate::tone::Tone;

    #[test]
    fn middle_grey_is_the_pivot_and_bright_red_bleaches() {
        let tone = Tone::parse("agx").unwrap();
        let map = tone.mapper(1.0);
        // AgX puts middle grey at half of the display's (exponent 2.2) range.
        let grey = srgb_decode(map([0.18; 3])[1]);
        assert!((grey.powf(1.0 / 2.2) - 0.5).abs() < 0.01, "{grey}");
        let saturation = |[r, g, b]: [f32; 3]| (r - g.min(b)) / r;
        assert!(saturation(map([50.0, 0.0, 0.0])) < 0.5 * saturation(map([0.2, 0.0, 0.0])));
    }

    #[test]
    fn matrices_are_inverse_and_keep_grey() {
        for v in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.3, 0.4, 0.5]] {
            let back = multiply(&OUTSET, multiply(&INSET, v));
            assert!(back.iter().zip(v).all(|(a, b)| (a - b).abs() < 1e-3), "{v:?} {back:?}");
        }
        assert!(multiply(&INSET, [1.0; 3]).iter().all(|v| (v - 1.0).abs() < 2e-4));
    }
}
