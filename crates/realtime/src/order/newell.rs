//! Newell's sort (Newell, Newell, Sancha 1972, "A Solution to the Hidden Surface Problem"): by depth, then each polygon
//! is tested against those whose depths overlap with its own; where two cannot be ordered, one is cut by the other's
//! plane.

use std::collections::VecDeque;

use steradian_raster::glam::{DVec2, DVec3, DVec4};

use super::Polygon;
use crate::Error;

/// Distances from planes that count as none, in a picture from −1 to 1: corners are rounded to 24 bits.
const WITHIN: f64 = 3e-7;

/// Edges whose direction is known so well that lines along them are right within [`WITHIN`].
const SHORTEST: f64 = 1e-9;

struct Entry {
    polygon: Polygon,
    /// With the normal towards the eye.
    plane: DVec4,
    /// Range of z.
    range: [f64; 2],
    low: DVec2,
    high: DVec2,
    moved: bool,
}

impl Entry {
    /// `None` for what is seen edge on.
    fn new(polygon: Polygon) -> Option<Self> {
        let plane = polygon.plane()?;
        (plane.z.abs() > 1e-12).then(|| Self::in_plane(polygon, if plane.z < 0.0 { -plane } else { plane }))
    }

    /// A polygon in a plane; parts keep that of the whole, which is known better.
    fn in_plane(polygon: Polygon, plane: DVec4) -> Self {
        // Extents in depth and in the picture for the cheap first tests.
        let z = polygon.corners.iter().fold([f64::MAX, f64::MIN], |[l, h], c| [l.min(c.z), h.max(c.z)]);
        let corners = || polygon.corners.iter().map(|c| c.truncate());
        let (low, high) = corners().fold((DVec2::MAX, DVec2::MIN), |(l, h), c| (l.min(c), h.max(c)));
        Self { plane, range: z, low, high, polygon, moved: false }
    }

    fn distances(&self, of: &Self) -> impl Iterator<Item = f64> {
        of.polygon.corners.iter().map(|c| self.plane.dot(c.extend(1.0)))
    }

    /// True if all of this lies behind the plane of another, or all of the other before the plane of this.
    fn is_behind(&self, other: &Self) -> bool {
        // Newell's tests 3 and 4.
        other.distances(self).all(|d| d <= WITHIN) || self.distances(other).all(|d| d >= -WITHIN)
    }

    /// True if the projections of both have nothing in common but borders.
    fn is_apart(&self, other: &Self) -> bool {
        // An edge of one polygon that has the other wholly outside separates the projections.
        let clear = |a: &Self, b: &Self| {
            let corners = &a.polygon.corners;
            (0..corners.len()).any(|i| {
                let (p, q) = (corners[i].truncate(), corners[(i + 1) % corners.len()].truncate());
                let across = (q - p).perp() * a.polygon.normal().z.signum();
                // The direction of shorter edges is not known.
                across.length() > SHORTEST
                    && b.polygon.corners.iter().all(|c| across.dot(c.truncate() - p) <= WITHIN * across.length())
            })
        };
        // Newell's tests 1 and 2 (boxes in x and y), then test 5 exactly: two convex polygons are disjoint if an edge
        // of one of them separates them.
        let boxes = (self.low.cmpge(other.high) | other.low.cmpge(self.high)).any();
        boxes || clear(self, other) || clear(other, self)
    }
}

/// The polygons, some cut, from the back to the front.
pub fn ordered(polygons: Vec<Polygon>) -> Result<Vec<Polygon>, Error> {
    let most = 50 * polygons.len() + 10_000;
    let mut list: Vec<Entry> = polygons.into_iter().filter_map(Entry::new).collect();
    // The farthest last; of equals the first is drawn last.
    list.sort_by(|a, b| b.range[0].total_cmp(&a.range[0]).then(a.polygon.number.cmp(&b.polygon.number)));
    // Those that were moved before others; the next is at the front.
    let mut first: VecDeque<Entry> = VecDeque::new();
    let mut ordered = Vec::new();
    let mut steps = 0;
    // Take the farthest polygon; it may be drawn if nothing overlaps it in depth, picture and half-spaces.
    while let Some(next) = first.pop_front().or_else(|| list.pop()) {
        steps += 1;
        if steps > most {
            return Err(Error::Scene(format!("visibility=newell did not end within {most} moves and cuts")));
        }
        // A conflict is a polygon whose depths overlap and that none of the five tests puts in front of the next one.
        let conflicts =
            |other: &Entry| other.range[0] < next.range[1] && !next.is_apart(other) && !next.is_behind(other);
        // Among those that were moved there is no order of depths.
        let in_first = first.iter().position(conflicts);
        let in_list = || {
            let mut near = list.iter().enumerate().rev().take_while(|(_, other)| other.range[0] < next.range[1]);
            near.find(|(_, other)| conflicts(other)).map(|(i, _)| i)
        };
        let (from_first, place) = match in_first {
            Some(place) => (true, place),
            None => match in_list() {
                Some(place) => (false, place),
                None => {
                    ordered.push(next.polygon);
                    // What was moved before it may be moved again.
                    first.iter_mut().for_each(|entry| entry.moved = false);
                    continue;
                }
            },
        };
        let taken = if from_first { first.remove(place) } else { Some(list.remove(place)) };
        let Some(mut other) = taken else { continue };
        // The other one lies behind: it goes first. A polygon that was moved before is not moved again, since that
        // would be a cycle.
        if !other.moved && other.is_behind(&next) {
            other.moved = true;
            first.push_front(next);
            first.push_front(other);
            continue;
        }
        // Each before the other, or across it: cut. In a circle of which no two cross each other's planes, along the
        // outlines.
        let outlines = |of: &Entry| -> Vec<DVec4> {
            let corners = &of.polygon.corners;
            let edge = |i: usize| {
                let (p, q) = (corners[i].truncate(), corners[(i + 1) % corners.len()].truncate());
                let across = (q - p).perp().normalize_or_zero();
                DVec4::new(across.x, across.y, 0.0, -across.dot(p))
            };
            (0..corners.len()).map(edge).collect()
        };
        let of =
            |one: &Entry, planes: &[DVec4]| planes.iter().find_map(|plane| one.polygon.cut(*plane, WITHIN, DVec3::Z));
        // Cut by the plane of the other polygon, failing that by its outline in the picture.
        let parts = of(&next, &[other.plane]).map(|parts| (parts, true));
        let parts = parts.or_else(|| of(&other, &[next.plane]).map(|parts| (parts, false)));
        let parts = parts.or_else(|| of(&next, &outlines(&other)).map(|parts| (parts, true)));
        let parts = parts.or_else(|| of(&other, &outlines(&next)).map(|parts| (parts, false)));
        let cut: Vec<Entry> = match parts {
            Some((parts, is_next)) => {
                let (whole, other) = if is_next { (next.plane, other) } else { (other.plane, next) };
                let parts = parts.into_iter().map(|part| Entry::in_plane(part, whole));
                parts.chain([Entry { moved: false, ..other }]).collect()
            }
            None => {
                // Outlines that are equal but for rounding.
                let (far, near) = if other.is_behind(&next) { (other, next) } else { (next, other) };
                ordered.push(far.polygon);
                first.push_front(near);
                continue;
            }
        };
        // The parts return to their places in the order of depths.
        for entry in cut {
            let place = list.partition_point(|e| e.range[0] >= entry.range[0]);
            list.insert(place, entry);
        }
    }
    Ok(ordered)
}
