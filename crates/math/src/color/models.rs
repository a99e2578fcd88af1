//! Other coordinates of RGB: HSV, HSL, YCoCg, lossless YCoCg-R, Oklab and XYB.

use glam::{DMat3, DVec3};

/// Hue in degrees, [0, 360), of an RGB colour, and its largest and smallest component. Greys have hue 0.
fn hue(rgb: DVec3) -> (f64, f64, f64) {
    let (most, least) = (rgb.max_element(), rgb.min_element());
    let chroma = most - least;
    if chroma <= 0.0 {
        return (0.0, most, least);
    }
    let sextant = if most == rgb.x {
        (rgb.y - rgb.z) / chroma
    } else if most == rgb.y {
        (rgb.z - rgb.x) / chroma + 2.0
    } else {
        (rgb.x - rgb.y) / chroma + 4.0
    };
    ((sextant * 60.0).rem_euclid(360.0), most, least)
}

/// A component of the colour with a hue: `n` is 5, 3 and 1 for red, green and blue. 1 within 60° of the component, 0
/// opposite to it.
fn trapezium(hue: f64, n: f64) -> f64 {
    let k = (n + hue / 60.0).rem_euclid(6.0);
    1.0 - k.min(4.0 - k).clamp(0.0, 1.0)
}

/// Hue (degrees), saturation and value of RGB in [0, 1] (Smith 1978). RGB is usually encoded sRGB.
pub fn hsv_from_rgb(rgb: DVec3) -> DVec3 {
    let (h, most, least) = hue(rgb);
    DVec3::new(h, if most > 0.0 { (most - least) / most } else { 0.0 }, most)
}

/// The inverse of [`hsv_from_rgb`].
pub fn rgb_from_hsv(hsv: DVec3) -> DVec3 {
    let [h, s, v] = hsv.to_array();
    DVec3::new(trapezium(h, 5.0), trapezium(h, 3.0), trapezium(h, 1.0)) * (v * s) + v * (1.0 - s)
}

/// Hue (degrees), saturation and lightness of RGB in [0, 1] (Joblove, Greenberg 1978). RGB is usually encoded sRGB.
pub fn hsl_from_rgb(rgb: DVec3) -> DVec3 {
    let (h, most, least) = hue(rgb);
    let lightness = 0.5 * (most + least);
    let room = 1.0 - (2.0 * lightness - 1.0).abs();
    DVec3::new(h, if room > 0.0 { (most - least) / room } else { 0.0 }, lightness)
}

/// The inverse of [`hsl_from_rgb`].
pub fn rgb_from_hsl(hsl: DVec3) -> DVec3 {
    let [h, s, l] = hsl.to_array();
    let chroma = s * (1.0 - (2.0 * l - 1.0).abs());
    DVec3::new(trapezium(h, 5.0), trapezium(h, 3.0), trapezium(h, 1.0)) * chroma + (l - 0.5 * chroma)
}

/// Luma, orange chroma and green chroma (Malvar, Sullivan 2003): `Y = (R + 2G + B)/4`, `Co = (R − B)/2`,
/// `Cg = (−R + 2G − B)/4`.
pub fn ycocg_from_rgb(rgb: DVec3) -> DVec3 {
    let [r, g, b] = rgb.to_array();
    DVec3::new(0.25 * r + 0.5 * g + 0.25 * b, 0.5 * (r - b), -0.25 * r + 0.5 * g - 0.25 * b)
}

/// The inverse of [`ycocg_from_rgb`].
pub fn rgb_from_ycocg(ycocg: DVec3) -> DVec3 {
    let [y, co, cg] = ycocg.to_array();
    DVec3::new(y + co - cg, y + cg, y - co - cg)
}

/// YCoCg-R: whole numbers of `n` bits become luma of `n` bits and chroma of `n + 1`, without loss (Malvar, Sullivan
/// 2003).
pub fn ycocg_r_from_rgb([r, g, b]: [i32; 3]) -> [i32; 3] {
    let co = r - b;
    let t = b + (co >> 1);
    let cg = g - t;
    [t + (cg >> 1), co, cg]
}

/// The inverse of [`ycocg_r_from_rgb`].
pub fn rgb_from_ycocg_r([y, co, cg]: [i32; 3]) -> [i32; 3] {
    let t = y - (cg >> 1);
    let g = cg + t;
    let b = t - (co >> 1);
    [b + co, g, b]
}

/// Cone-like responses from linear Rec.709, and Oklab from their cube roots (Ottosson 2020).
fn oklab_matrices() -> (DMat3, DMat3) {
    let rows = |m: [[f64; 3]; 3]| DMat3::from_cols_array_2d(&m).transpose();
    (
        rows([
            [0.412_221_470_8, 0.536_332_536_3, 0.051_445_992_9],
            [0.211_903_498_2, 0.680_699_545_1, 0.107_396_956_6],
            [0.088_302_461_9, 0.281_718_837_6, 0.629_978_700_5],
        ]),
        rows([
            [0.210_454_255_3, 0.793_617_785_0, -0.004_072_046_8],
            [1.977_998_495_1, -2.428_592_205_0, 0.450_593_709_9],
            [0.025_904_037_1, 0.782_771_766_2, -0.808_675_766_0],
        ]),
    )
}

/// Oklab `(L, a, b)` of linear Rec.709.
pub fn oklab_from_rgb(rgb: DVec3) -> DVec3 {
    let (cones, lab) = oklab_matrices();
    lab * (cones * rgb).map(f64::cbrt)
}

/// The bias that XYB adds before the cube root.
const XYB_BIAS: f64 = 0.003_793_073_255_275_449_3;

fn xyb_matrix() -> DMat3 {
    DMat3::from_cols_array_2d(&[
        [0.3, 0.622, 0.078],
        [0.23, 0.692, 0.078],
        [0.243_422_689_245_478_2, 0.204_767_444_244_968_2, 0.551_809_866_509_553_5],
    ])
    .transpose()
}

/// XYB of linear Rec.709 (JPEG XL, ISO/IEC 18181-1): cone responses, biased cube roots, then `X = (L − M)/2`,
/// `Y = (L + M)/2`, `B = S`.
pub fn xyb_from_rgb(rgb: DVec3) -> DVec3 {
    let [l, m, s] = ((xyb_matrix() * rgb + XYB_BIAS).map(f64::cbrt) - XYB_BIAS.cbrt()).to_array();
    DVec3::new(0.5 * (l - m), 0.5 * (l + m), s)
}

/// The inverse of [`xyb_from_rgb`].
pub fn rgb_from_xyb(xyb: DVec3) -> DVec3 {
    let lms = DVec3::new(xyb.y + xyb.x, xyb.y - xyb.x, xyb.z) + XYB_BIAS.cbrt();
    xyb_matrix().inverse() * (lms.map(|v| v * v * v) - XYB_BIAS)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M123: there and back, over a grid of colours with all its greys and primaries.
    #[test]
    fn round_trips_keep_the_color() {
        type Map = fn(DVec3) -> DVec3;
        let pairs: [(Map, Map); 4] = [
            (hsv_from_rgb, rgb_from_hsv),
            (hsl_from_rgb, rgb_from_hsl),
            (ycocg_from_rgb, rgb_from_ycocg),
            (xyb_from_rgb, rgb_from_xyb),
        ];
        for i in 0..9 * 9 * 9 {
            let rgb = DVec3::new((i % 9) as f64, (i / 9 % 9) as f64, (i / 81) as f64) / 8.0;
            for (k, (there, back)) in pairs.iter().enumerate() {
                assert!((back(there(rgb)) - rgb).length() < 1e-12, "{k}: {rgb}");
            }
        }
    }

    #[test]
    fn ycocg_r_loses_nothing() {
        for i in 0..1 << 12 {
            let rgb = [i & 15, i >> 4 & 15, i >> 8].map(|v| v * 17);
            assert_eq!(rgb_from_ycocg_r(ycocg_r_from_rgb(rgb)), rgb);
            assert!((0..=255).contains(&ycocg_r_from_rgb(rgb)[0]));
        }
    }

    /// Values in print: hues of the primaries, Ottosson's Oklab of white and of the sRGB primaries, XYB of white.
    #[test]
    fn known_colors() {
        for (rgb, h) in [(DVec3::X, 0.0), (DVec3::new(1.0, 1.0, 0.0), 60.0), (DVec3::Y, 120.0), (DVec3::Z, 240.0)] {
            assert_eq!(hsv_from_rgb(rgb), DVec3::new(h, 1.0, 1.0));
            assert_eq!(hsl_from_rgb(rgb), DVec3::new(h, 1.0, 0.5));
        }
        assert!((oklab_from_rgb(DVec3::ONE) - DVec3::X).length() < 1e-6);
        assert!((oklab_from_rgb(DVec3::X) - DVec3::new(0.627_955, 0.224_863, 0.125_846)).length() < 1e-5);
        let white = xyb_from_rgb(DVec3::ONE);
        assert!(white.x.abs() < 1e-12 && (white.y - white.z).abs() < 1e-6, "{white}");
        assert_eq!(xyb_from_rgb(DVec3::ZERO), DVec3::ZERO);
    }
}
