//! MacAdam's 25 ellipses: standard deviations of matches of one observer (MacAdam, *J. Opt. Soc. Am.* 32, 1942, table
//! III; as in Wyszecki, Stiles, *Color Science*, table I(5.4.1)).

/// Centre `x`, `y`, semi-axes `10³ a`, `10³ b`, and the angle of `a` from the x axis in degrees.
pub const ELLIPSES: [[f64; 5]; 25] = [
    [0.160, 0.057, 0.85, 0.35, 62.5],
    [0.187, 0.118, 2.2, 0.55, 77.0],
    [0.253, 0.125, 2.5, 0.50, 55.5],
    [0.150, 0.680, 9.6, 2.3, 105.0],
    [0.131, 0.521, 4.7, 2.0, 112.5],
    [0.212, 0.550, 5.8, 2.3, 100.0],
    [0.258, 0.450, 5.0, 2.0, 92.0],
    [0.152, 0.365, 3.8, 1.9, 110.0],
    [0.280, 0.385, 4.0, 1.5, 75.5],
    [0.380, 0.498, 4.4, 1.2, 70.0],
    [0.160, 0.200, 2.1, 0.95, 104.0],
    [0.228, 0.250, 3.1, 0.90, 72.0],
    [0.305, 0.323, 2.3, 0.90, 58.0],
    [0.385, 0.393, 3.8, 1.6, 65.5],
    [0.472, 0.399, 3.2, 1.4, 51.0],
    [0.527, 0.350, 2.6, 1.3, 20.0],
    [0.475, 0.300, 2.9, 1.1, 28.5],
    [0.510, 0.236, 2.4, 1.2, 29.5],
    [0.596, 0.283, 2.6, 1.3, 13.0],
    [0.344, 0.284, 2.3, 0.90, 60.0],
    [0.390, 0.237, 2.5, 1.0, 47.0],
    [0.441, 0.198, 2.8, 0.95, 34.5],
    [0.278, 0.223, 2.4, 0.55, 57.5],
    [0.300, 0.163, 2.9, 0.60, 54.0],
    [0.365, 0.153, 3.6, 0.95, 40.0],
];

/// Points of an ellipse, enlarged.
pub fn outline([x, y, a, b, degrees]: [f64; 5], scale: f64) -> Vec<(f64, f64)> {
    let (sin, cos) = degrees.to_radians().sin_cos();
    (0..=48)
        .map(|k| (f64::from(k) * std::f64::consts::TAU / 48.0).sin_cos())
        .map(|(s, c)| (a * 1e-3 * scale * c, b * 1e-3 * scale * s))
        .map(|(u, v)| (x + u * cos - v * sin, y + u * sin + v * cos))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M118: an ellipse has the area π a b, and lies in the diagram.
    #[test]
    fn ellipses_have_their_axes() {
        for e in ELLIPSES {
            let points = outline(e, 1.0);
            let twice: f64 = points.windows(2).map(|w| w[0].0 * w[1].1 - w[1].0 * w[0].1).sum();
            let exact = std::f64::consts::PI * e[2] * e[3] * 1e-6;
            assert!((0.5 * twice / exact - 1.0).abs() < 5e-3);
            assert!(e[0] + e[1] < 1.0 && e[2] > e[3]);
        }
    }
}
