//! The painter's algorithm: polygons sorted by their farthest corner. Where they cross, or lie before one another in a
//! circle, or are long, no such order is right.

use super::Polygon;

/// From the farthest to the nearest.
pub fn sorted(mut polygons: Vec<Polygon>) -> Vec<Polygon> {
    let farthest = |p: &Polygon| p.corners.iter().fold(f64::MAX, |z, c| z.min(c.z));
    // Of equals the first is drawn last, so that it is seen as with a depth test.
    polygons.sort_by(|a, b| farthest(a).total_cmp(&farthest(b)).then(b.number.cmp(&a.number)));
    polygons
}
