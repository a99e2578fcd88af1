//! Laying charts into the plane.
//!
//! A chart that is flat already is projected along its normal, which keeps all lengths. Others get a least-squares
//! conformal map, that begins at the projection and holds two far vertices of the border; where that fails, the
//! projection is taken. A map fails if it is not one-to-one ([`proof`](crate::proof)), if it stretches too much, or if
//! its box is too long to be packed well.

use crate::{chart::Chart, hull, lscm, measure::Sums, proof};
use steradian_math::DVec2;

/// Largest L² stretch of a chart.
const MOST_STRETCH: f64 = 1.5;

/// Longest side of a chart's box, relative to the root of the area of all charts.
const LONGEST: f64 = 2.0;

/// Share of the area that a projection may lose where a chart counts as flat.
const FLAT: f64 = 1e-6;

/// A chart in the plane, as large as on the surface.
pub struct Flat {
    /// The chart.
    pub chart: Chart,
    /// Its vertices, in a box whose lower left corner is the origin and whose longer sides are horizontal.
    pub uvs: Vec<DVec2>,
    /// Sides of the box.
    pub size: DVec2,
}

/// Lays a chart into the plane where the area of all charts is `total` and `unit` is the step of the coordinates, both
/// in the units of the mesh; `None` where no map that is tried is one-to-one with little stretch.
pub fn flatten(chart: Chart, total: f64, unit: f64) -> Option<Flat> {
    if let [[a, b, c]] = chart.corners[..] {
        let [a, b, c] = [a, b, c].map(|i| chart.positions[i as usize]);
        let (ab, ac) = (b - a, c - a);
        let third = DVec2::new(ab.dot(ac), ab.cross(ac).length()) / ab.length();
        let uvs = vec![DVec2::ZERO, DVec2::new(ab.length(), 0.0), third];
        return Some(boxed(chart, uvs));
    }
    let projected = projection(&chart);
    let is_flat = chart.vector.length() > (1.0 - FLAT) * chart.area;
    let map = if is_flat {
        projected.clone()
    } else {
        lscm::solve(&chart, far_vertices(&chart, &projected), projected.clone())
    };
    match accepted(chart, map, total, unit) {
        Ok(flat) => Some(flat),
        Err(_) if is_flat => None,
        Err(chart) => accepted(*chart, projected, total, unit).ok(),
    }
}

/// The vertices along the mean normal.
fn projection(chart: &Chart) -> Vec<DVec2> {
    let normal = chart.vector.normalize_or(steradian_math::DVec3::Z);
    let (x, y) = normal.any_orthonormal_pair();
    let origin = chart.positions[0];
    chart.positions.iter().map(|p| DVec2::new(x.dot(*p - origin), y.dot(*p - origin))).collect()
}

/// Two vertices of the border that are far from each other.
fn far_vertices(chart: &Chart, uvs: &[DVec2]) -> [u32; 2] {
    let farthest = |from: DVec2| {
        let mut best = (f64::NEG_INFINITY, chart.border[0]);
        for &i in &chart.border {
            let d = uvs[i as usize].distance_squared(from);
            if d > best.0 {
                best = (d, i);
            }
        }
        best.1
    };
    let first = farthest(uvs.iter().sum::<DVec2>() / uvs.len() as f64);
    [first, farthest(uvs[first as usize])]
}

/// Scales a map to the chart's area and holds it against all demands; the chart again where it does not meet them.
fn accepted(chart: Chart, mut uvs: Vec<DVec2>, total: f64, unit: f64) -> Result<Flat, Box<Chart>> {
    let area: f64 =
        chart.corners.iter().map(|t| t.map(|i| uvs[i as usize])).map(|[a, b, c]| 0.5 * (b - a).perp_dot(c - a)).sum();
    if !(area > 0.0 && area.is_finite()) {
        return Err(chart.into());
    }
    let scale = (chart.area / area).sqrt();
    uvs.iter_mut().for_each(|p| *p *= scale);
    let flat = boxed(chart, uvs);
    let points: Vec<proof::Point> = flat.uvs.iter().map(|p| [p.x, p.y].map(|x| (x / unit).round() as i64)).collect();
    let is_good = flat.size.max_element() <= LONGEST * total.sqrt()
        && stretch(&flat) <= MOST_STRETCH
        && proof::is_injective(&points, &flat.chart.corners, &flat.chart.border);
    if is_good { Ok(flat) } else { Err(flat.chart.into()) }
}

fn stretch(flat: &Flat) -> f64 {
    let mut sums = Sums::default();
    for corners in &flat.chart.corners {
        let at = corners.map(|i| i as usize);
        sums.add(at.map(|i| flat.chart.positions[i]), at.map(|i| flat.uvs[i]));
    }
    sums.stretch()[0]
}

/// Turns a map into its smallest box.
fn boxed(chart: Chart, mut uvs: Vec<DVec2>) -> Flat {
    let border: Vec<DVec2> = chart.border.iter().map(|i| uvs[*i as usize]).collect();
    let axis = hull::axis(&border);
    uvs.iter_mut().for_each(|p| *p = DVec2::new(axis.dot(*p), axis.perp_dot(*p)));
    let low = uvs.iter().fold(DVec2::INFINITY, |low, p| low.min(*p));
    uvs.iter_mut().for_each(|p| *p -= low);
    let size = uvs.iter().fold(DVec2::ZERO, |high, p| high.max(*p));
    Flat { chart, uvs, size }
}
