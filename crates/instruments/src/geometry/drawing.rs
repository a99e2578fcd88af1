//! Space on paper: an isometric view with z up.

use crate::laboratory::{Axis, Chart, Marker, Series};
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

/// The unit cube, dashed, and its image.
pub fn cube_and_image(image: impl Fn(DVec3) -> DVec3) -> Chart {
    let cube = |k: u32| DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2 & 1));
    let size = (0..8).map(|k| image(cube(k)).length()).fold(1.8, f64::max);
    let mut chart = view("the unit cube and its image", size);
    for from in 0..8 {
        for bit in [1, 2, 4].into_iter().filter(|bit| from & bit == 0) {
            let edge = [cube(from), cube(from | bit)];
            chart = chart.with(curve("", edge).drawn(Marker::Dashed).colored([0x88, 0x88, 0x88]));
            chart = chart.with(curve("", edge.map(&image)).colored([0xd0, 0x5a, 0x1e]));
        }
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
