//! Colour differences beyond CIELAB's distance: CIE94 and CIEDE2000.

use glam::DVec3;

/// ΔE*94 (CIE 116-1995) of two CIELAB colours, the first being the standard; graphic-arts constants,
/// `k_L = k_C = k_H = 1`.
pub fn delta_e_94(standard: DVec3, sample: DVec3) -> f64 {
    let chroma = |c: DVec3| c.y.hypot(c.z);
    let (c1, c2) = (chroma(standard), chroma(sample));
    let (dl, dc) = (standard.x - sample.x, c1 - c2);
    let dh2 = ((standard.y - sample.y).powi(2) + (standard.z - sample.z).powi(2) - dc * dc).max(0.0);
    let (sc, sh) = (1.0 + 0.045 * c1, 1.0 + 0.015 * c1);
    (dl * dl + (dc / sc).powi(2) + dh2 / (sh * sh)).sqrt()
}

/// ΔE00 (CIE 142-2001) of two CIELAB colours, `k_L = k_C = k_H = 1`, in the form of Sharma, Wu and Dalal 2005.
pub fn delta_e_2000(a: DVec3, b: DVec3) -> f64 {
    let pow7 = |c: f64| (c.powi(7) / (c.powi(7) + 25f64.powi(7))).sqrt();
    let mean_chroma = 0.5 * (a.y.hypot(a.z) + b.y.hypot(b.z));
    let g = 0.5 * (1.0 - pow7(mean_chroma));
    let polar = |c: DVec3| {
        let x = (1.0 + g) * c.y;
        let hue = if x == 0.0 && c.z == 0.0 { 0.0 } else { c.z.atan2(x).to_degrees().rem_euclid(360.0) };
        (x.hypot(c.z), hue)
    };
    let ((c1, h1), (c2, h2)) = (polar(a), polar(b));
    let dl = b.x - a.x;
    let dc = c2 - c1;
    let is_grey = c1 * c2 == 0.0;
    let turn = match h2 - h1 {
        _ if is_grey => 0.0,
        d if d > 180.0 => d - 360.0,
        d if d < -180.0 => d + 360.0,
        d => d,
    };
    let dh = 2.0 * (c1 * c2).sqrt() * (turn.to_radians() / 2.0).sin();
    let (l, c) = (0.5 * (a.x + b.x), 0.5 * (c1 + c2));
    let h = match h1 + h2 {
        sum if is_grey => sum,
        sum if (h1 - h2).abs() <= 180.0 => 0.5 * sum,
        sum if sum < 360.0 => 0.5 * (sum + 360.0),
        sum => 0.5 * (sum - 360.0),
    };
    let cos = |degrees: f64| degrees.to_radians().cos();
    let t = 1.0 - 0.17 * cos(h - 30.0) + 0.24 * cos(2.0 * h) + 0.32 * cos(3.0 * h + 6.0) - 0.20 * cos(4.0 * h - 63.0);
    let sl = 1.0 + 0.015 * (l - 50.0).powi(2) / (20.0 + (l - 50.0).powi(2)).sqrt();
    let (sc, sh) = (1.0 + 0.045 * c, 1.0 + 0.015 * c * t);
    let rotation = -2.0 * pow7(c) * (60.0 * (-((h - 275.0) / 25.0).powi(2)).exp()).to_radians().sin();
    let (x, y, z) = (dl / sl, dc / sc, dh / sh);
    (x * x + y * y + z * z + rotation * y * z).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pairs of Sharma, Wu and Dalal 2005, table 1, that meet every branch of the formula.
    #[test]
    fn ciede2000_has_its_published_test_values() {
        let pairs: [([f64; 3], [f64; 3], f64); 12] = [
            ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
            ([50.0, -1.3802, -84.2814], [50.0, 0.0, -82.7485], 1.0000),
            ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.3669),
            ([50.0, 2.49, -0.001], [50.0, -2.49, 0.0009], 7.1792),
            ([50.0, 2.49, -0.001], [50.0, -2.49, 0.0011], 7.2195),
            ([50.0, 2.5, 0.0], [50.0, 0.0, -2.5], 4.3065),
            ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
            ([50.0, 2.5, 0.0], [58.0, 24.0, 15.0], 19.4535),
            ([60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644),
            ([63.0109, -31.0961, -5.8663], [62.8187, -29.7946, -4.0864], 1.2630),
            ([22.7233, 20.0904, -46.6940], [23.0331, 14.9730, -42.5619], 2.0373),
            ([2.0776, 0.0795, -1.1350], [0.9033, -0.0636, -0.5514], 0.9082),
        ];
        for (a, b, exact) in pairs {
            let (a, b) = (DVec3::from(a), DVec3::from(b));
            assert!((delta_e_2000(a, b) - exact).abs() < 5e-5, "{a} {b}: {}", delta_e_2000(a, b));
            assert!((delta_e_2000(b, a) - exact).abs() < 5e-5);
        }
        assert_eq!(delta_e_2000(DVec3::ZERO, DVec3::ZERO), 0.0);
    }

    /// By hand: greys differ by their lightness; a pure difference in chroma is divided by 1 + 0.045 C, in hue by 1 +
    /// 0.015 C.
    #[test]
    fn cie94_weighs_chroma_and_hue() {
        assert_eq!(delta_e_94(DVec3::new(50.0, 0.0, 0.0), DVec3::new(57.0, 0.0, 0.0)), 7.0);
        let red = DVec3::new(50.0, 40.0, 0.0);
        assert!((delta_e_94(red, DVec3::new(50.0, 50.0, 0.0)) - 10.0 / 2.8).abs() < 1e-12);
        let turned = DVec3::new(50.0, 0.0, 40.0);
        assert!((delta_e_94(red, turned) - 40.0 * 2f64.sqrt() / 1.6).abs() < 1e-12);
    }
}
