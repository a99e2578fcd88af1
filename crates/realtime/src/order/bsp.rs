//! Binary space partitioning (Fuchs, Kedem, Naylor 1980, "On Visible Surface Generation by A Priori Tree Structures"):
//! planes of polygons divide space, polygons that cross them are cut, and from any eye one side of each plane is behind
//! the other.

use steradian_raster::glam::{DVec3, DVec4};

use super::Polygon;
use crate::Error;

/// Viewpoint.
#[derive(Clone, Copy, Debug)]
pub enum From {
    Point(DVec3),
    /// Along this direction.
    Direction(DVec3),
}

/// Planes that are tried for each node, and polygons that each is tried on.
const CANDIDATES: usize = 6;
const TRIED: usize = 128;

struct Node {
    plane: DVec4,
    /// Polygons in the plane.
    inside: Vec<Polygon>,
    /// Above and below.
    children: [Option<usize>; 2],
}

/// The polygons, cut, from the back to the front.
pub fn ordered(polygons: Vec<Polygon>, from: From) -> Result<Vec<Polygon>, Error> {
    let size = polygons.iter().flat_map(|p| &p.corners).fold(0f64, |size, c| size.max(c.abs().max_element()));
    // Corners are rounded to 24 bits.
    let within = 2e-7 * size;
    let most = 20 * polygons.len() + 10_000;
    let mut nodes: Vec<Node> = Vec::new();
    let mut count = 0;
    let mut work = vec![(polygons, None)];
    // Build top-down: choose a plane, distribute and cut polygons, and continue on both sides.
    while let Some((polygons, parent)) = work.pop() {
        let Some(plane) = best(&polygons, within) else { continue };
        let mut node = Node { plane, inside: Vec::new(), children: [None; 2] };
        let mut sides = [Vec::new(), Vec::new()];
        // Each polygon goes to its side of the plane; one across it is cut, and its parts go to both.
        for polygon in polygons {
            match side(&polygon, plane, within) {
                Side::In => node.inside.push(polygon),
                Side::Above => sides[0].push(polygon),
                Side::Below => sides[1].push(polygon),
                Side::Across => {
                    let [above, below] =
                        polygon.cut(plane, within, polygon.normal()).unwrap_or_else(|| [polygon.clone(), polygon]);
                    sides[0].push(above);
                    sides[1].push(below);
                }
            }
        }
        count += node.inside.len();
        if count + sides[0].len() + sides[1].len() > most {
            return Err(Error::Scene(format!("visibility=bsp needs more than {most} pieces here")));
        }
        // Of equals the first is drawn last.
        node.inside.sort_by_key(|p| std::cmp::Reverse(p.number));
        let number = nodes.len();
        nodes.push(node);
        if let Some((parent, side)) = parent {
            let parent: &mut Node = &mut nodes[parent];
            parent.children[side] = Some(number);
        }
        for (side, polygons) in sides.into_iter().enumerate() {
            if !polygons.is_empty() {
                work.push((polygons, Some((number, side))));
            }
        }
    }
    Ok(traversed(&mut nodes, from))
}

/// Far sides first.
fn traversed(nodes: &mut [Node], from: From) -> Vec<Polygon> {
    let mut ordered = Vec::new();
    // Nodes to enter, and nodes whose own polygons are next.
    let mut stack = if nodes.is_empty() { Vec::new() } else { vec![(0, false)] };
    while let Some((number, entered)) = stack.pop() {
        let node = &mut nodes[number];
        if entered {
            ordered.append(&mut node.inside);
            continue;
        }
        // The side of the eye is drawn after the plane's own polygons, and these after the far side. The walk has a
        // stack of its own, as trees may be deep.
        let eye_above = match from {
            From::Point(eye) => node.plane.dot(eye.extend(1.0)) > 0.0,
            From::Direction(d) => node.plane.truncate().dot(d) < 0.0,
        };
        let [above, below] = node.children;
        let (near, far) = if eye_above { (above, below) } else { (below, above) };
        // The stack reverses the order: what is pushed last is drawn first.
        stack.extend(near.map(|n| (n, false)));
        stack.push((number, true));
        stack.extend(far.map(|n| (n, false)));
    }
    ordered
}

#[derive(PartialEq, Eq)]
enum Side {
    In,
    Above,
    Below,
    Across,
}

fn side(polygon: &Polygon, plane: DVec4, within: f64) -> Side {
    // Signed distances of the corners; those within rounding of the plane count as none.
    let distances = polygon.corners.iter().map(|c| plane.dot(c.extend(1.0)));
    let (low, high) = distances.fold((0f64, 0f64), |(l, h), d| (l.min(d), h.max(d)));
    match (low < -within, high > within) {
        (false, false) => Side::In,
        (false, true) => Side::Above,
        (true, false) => Side::Below,
        (true, true) => Side::Across,
    }
}

/// The plane, of some polygons, that cuts the fewest and divides best; that of none where all are without area.
fn best(polygons: &[Polygon], within: f64) -> Option<DVec4> {
    let step = (polygons.len() / CANDIDATES).max(1);
    let planes = polygons.iter().step_by(step).filter_map(Polygon::plane);
    let cost = |plane: &DVec4| {
        // Estimate the cost from a sample of polygons: imbalance, and four for each cut.
        let mut counts = [0i64; 3];
        for polygon in polygons.iter().step_by((polygons.len() / TRIED).max(1)) {
            match side(polygon, *plane, within) {
                Side::In => {}
                Side::Above => counts[0] += 1,
                Side::Below => counts[1] += 1,
                Side::Across => counts[2] += 1,
            }
        }
        // A cut costs as much as four polygons out of balance: cuts make the tree larger, imbalance makes it deeper.
        (counts[0] - counts[1]).abs() + 4 * counts[2]
    };
    planes.map(|plane| (cost(&plane), plane)).min_by_key(|(cost, _)| *cost).map(|(_, plane)| plane).or_else(|| {
        // All candidates were needles: any other will do.
        polygons.iter().find_map(Polygon::plane)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;
    use steradian_math::hash::HashRng;

    fn in_cube(rng: &mut HashRng) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| f64::from(rng.next_f32()) * 2.0 - 1.0))
    }

    fn polygon(number: u32, corners: [DVec3; 3]) -> Polygon {
        Polygon { number, corners: corners.to_vec(), cuts: Vec::new() }
    }

    /// Distance along a line to its intersection with a polygon; an error where that is not sure, near the rim or
    /// nearly along the plane.
    fn distance(polygon: &Polygon, origin: DVec3, d: DVec3) -> Result<Option<f64>, ()> {
        let corners = &polygon.corners;
        let (mut left, mut right) = (false, false);
        for (i, a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            let side = (b - *a).normalize_or_zero().cross(d).dot(origin - *a);
            if side.abs() < 1e-6 {
                return Err(());
            }
            (left, right) = (left || side > 0.0, right || side < 0.0);
        }
        if left && right {
            return Ok(None);
        }
        let n = polygon.normal().normalize();
        if n.dot(d).abs() < 0.01 { Err(()) } else { Ok(Some(n.dot(corners[0] - origin) / n.dot(d))) }
    }

    /// M242: what a line of sight passes through comes from the back to the front, and so, turned round, from the front
    /// to the back; parts have the area of the whole.
    #[test]
    fn polygons_come_in_order_both_ways() {
        let mut rng = HashRng::new(93);
        // Triangles that pierce each other, and two that share a plane.
        let mut triangles: Vec<Polygon> = (0..40)
            .map(|number| {
                let middle = in_cube(&mut rng);
                polygon(number, std::array::from_fn(|_| middle + in_cube(&mut rng) * 0.8))
            })
            .collect();
        triangles.push(polygon(40, [DVec3::NEG_X, DVec3::X, DVec3::Z]));
        triangles.push(polygon(41, [DVec3::NEG_X, DVec3::NEG_Z, DVec3::X]));
        let mut compared = 0;
        for i in 0..8 {
            let eye = in_cube(&mut rng).normalize() * 1.7;
            let from = if i % 2 == 0 { From::Point(eye) } else { From::Direction(-eye.normalize()) };
            let parts = ordered(triangles.clone(), from).expect("few triangles");
            assert!(parts.len() > triangles.len(), "nothing was cut");
            let mut areas = BTreeMap::new();
            for part in &parts {
                *areas.entry(part.number).or_insert(0.0) += part.normal().length();
            }
            for triangle in &triangles {
                assert!((areas[&triangle.number] - triangle.normal().length()).abs() < 1e-5);
            }
            for _ in 0..400 {
                let target = in_cube(&mut rng) * 0.8;
                let (origin, d) = match from {
                    From::Point(eye) => (eye, (target - eye).normalize()),
                    From::Direction(d) => (target - d * 5.0, d),
                };
                let met: Result<Vec<Option<f64>>, ()> = parts.iter().map(|p| distance(p, origin, d)).collect();
                let Ok(met) = met else { continue };
                // What is behind the eye is not seen.
                let met: Vec<f64> = met.into_iter().flatten().filter(|t| *t > 0.0).collect();
                assert!(met.windows(2).all(|pair| pair[0] > pair[1] - 1e-4), "{met:?}");
                compared += usize::from(met.len() > 1);
            }
        }
        assert!(compared > 1000, "{compared}");
    }
}
