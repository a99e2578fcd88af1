//! Boxes of a level as translucent faces with opaque edges.

use super::colors;
use steradian_accel::{Accel, Bvh, Geometry, PrimId, UserHit, UserPrimitives, WORLD};
use steradian_engine::Refusal;
use steradian_math::{Bounds3, Ray, Vec3};

/// Opacity of the faces that a ray enters by.
const FACE: f32 = 0.12;
/// Opacity of edges, of the faces that a ray enters and leaves by.
const EDGES: [f32; 2] = [0.9, 0.35];
/// Faces so little behind a surface, relatively, are before it: those that touch it are drawn whole.
const TOUCHING: f32 = 1e-4;

/// Refusal of a BSP.
pub const NO_BOXES: &str = "the cells of a bsp are polyhedra, not boxes: show=cells shows them";

/// Boxes of a level, in a hierarchy of their own.
#[derive(Debug)]
pub struct Boxes {
    pub level: u32,
    boxes: Vec<Bounds3>,
    bvh: Bvh,
}

impl Boxes {
    /// Boxes at a level of a structure; none of a BSP.
    pub fn new(accel: &Accel, level: u32) -> Result<Self, Refusal> {
        let boxes = accel.boxes(level).ok_or(Refusal(NO_BOXES.into()))?;
        let bvh = Bvh::build(&[Geometry::boxes(&boxes)]).map_err(|e| Refusal(e.to_string()))?;
        Ok(Self { level, boxes, bvh })
    }

    pub fn len(&self) -> usize {
        self.boxes.len()
    }

    /// Colour of a surface at a distance behind the boxes that the ray meets before it. The ray of the next pixel tells
    /// how wide an edge is: a pixel and a half.
    pub fn before(&self, ray: &Ray, next: &Ray, t: f32, surface: Vec3) -> Vec3 {
        let ray = Ray { t_max: (t * (1.0 + TOUCHING)).min(ray.t_max), ..*ray };
        let mut layers = Vec::new();
        for hit in self.bvh.all_hits(&ray, self) {
            let bounds = &self.boxes[hit.id.prim as usize];
            let ends = crossed(bounds, &ray).into_iter().flatten();
            for (side, t) in ends.enumerate().filter(|(_, t)| *t > 0.0 && *t < ray.t_max) {
                let width = (next.origin - ray.origin + (next.direction - ray.direction) * t).length();
                let opacity = match (is_edge(bounds, ray.at(t), 1.5 * width), side) {
                    (true, side) => EDGES[side],
                    (false, 0) => FACE,
                    (false, _) => continue,
                };
                layers.push((t, hit.id.prim, opacity));
            }
        }
        // From behind, over one another (Porter and Duff 1984).
        layers.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.cmp(&a.1)));
        layers.into_iter().fold(surface, |below, (_, of, opacity)| below.lerp(colors::number(WORLD, of), opacity))
    }
}

impl UserPrimitives for Boxes {
    fn intersect(&self, id: PrimId, ray: &Ray) -> Option<UserHit> {
        let ends = crossed(&self.boxes[id.prim as usize], ray)?;
        let t = ends.into_iter().find(|t| *t > 0.0).filter(|t| *t < ray.t_max)?;
        Some(UserHit { t, u: 0.0, v: 0.0 })
    }
}

/// Distances at which the line of a ray enters and leaves a box.
fn crossed(bounds: &Bounds3, ray: &Ray) -> Option<[f32; 2]> {
    let inverse = ray.direction.recip();
    let (a, b) = ((bounds.min - ray.origin) * inverse, (bounds.max - ray.origin) * inverse);
    let ends = [a.min(b).max_element(), a.max(b).min_element()];
    (ends[0] <= ends[1]).then_some(ends)
}

/// True for a point of the surface of a box that is less than a distance from two of its faces.
fn is_edge(bounds: &Bounds3, p: Vec3, width: f32) -> bool {
    let gaps = (p - bounds.min).abs().min((bounds.max - p).abs());
    (0..3).filter(|&axis| gaps[axis] < width).count() > 1
}
