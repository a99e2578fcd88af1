//! Space on paper: an isometric view with z up.

use crate::laboratory::{Axis, Chart, Series};
use glam::DVec3;

/// Isometric projection of a point, to scale: seen from the direction (1, 1, 1), z up.
fn project(p: DVec3) -> (f64, f64) {
    let (x, y) = (DVec3::new(-1.0, 1.0, 0.0) / 2f64.sqrt(), DVec3::new(-1.0, -1.0, 2.0) / 6f64.sqrt());
    (p.dot(x), p.dot(y))
}

/// A line through points of space.
pub fn curve(name: impl Into<String>, points: impl IntoIterator<Item = DVec3>) -> Series {
    Series::line(name, points.into_iter().map(project).collect())
}

/// An empty view with the axes, of the given length.
pub fn view(title: impl Into<String>, length: f64) -> Chart {
    let mut chart = Chart::new(title, Axis::linear("isometric view from (1, 1, 1)"), Axis::linear(""));
    chart.is_isometric = true;
    let axes = [("x", DVec3::X, [190, 60, 50]), ("y", DVec3::Y, [50, 140, 60]), ("z", DVec3::Z, [40, 80, 190])];
    for (name, axis, color) in axes {
        chart = chart.with(curve(name, [DVec3::ZERO, axis * length]).colored(color));
    }
    chart
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The axes are drawn 120° apart and equally long, √(2/3) of their length; z points up.
    #[test]
    fn the_view_is_isometric() {
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(project);
        for (a, b) in [(x, y), (y, z), (z, x)] {
            assert!((a.0 * b.0 + a.1 * b.1 + 1.0 / 3.0).abs() < 1e-12);
            assert!((a.0.hypot(a.1) - 0.816_496_580_927_726).abs() < 1e-12);
        }
        assert!(z.0.abs() < 1e-12 && z.1 > 0.0 && y.0 > 0.0 && x.0 < 0.0);
    }
}
