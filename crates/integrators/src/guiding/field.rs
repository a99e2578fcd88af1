//! Field of directions: what paths found by which direction, by regions of space.

use super::quadtree::{Find, Quadtree};
use crate::regions::Regions;
use rayon::prelude::*;
use steradian_bsdf::Bsdf;
use steradian_math::{Bounds3, Vec2, Vec3};
use steradian_transport::{Directions, Guide, Vertex};

/// Finds in a region.
const CAPACITY: usize = 2000;
/// Fewest finds of a region that guides.
const FEWEST: usize = 64;
/// Share of directions that the field draws.
const SHARE: f32 = 0.5;
/// Roughness α below which scattering alone draws directions.
const NARROW: f32 = 0.1;

/// Find of a path at a vertex.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    pub p: Vec3,
    pub find: Find,
}

/// Kinds of vertices, told apart so that directions below a surface are not drawn where they are above another one: the
/// axis and sign to which the normal is nearest, and points in media.
pub(super) const KINDS: usize = 7;

/// Kind of a vertex.
pub(super) fn kind(vertex: &Vertex<'_>) -> usize {
    let Vertex::Surface { frame, i, .. } = vertex else { return KINDS - 1 };
    let n = if frame.z.dot(i.wo) < 0.0 { -frame.z } else { frame.z };
    let a = n.abs();
    let axis = if a.x >= a.y && a.x >= a.z { 0 } else { 1 + usize::from(a.z > a.y) };
    2 * axis + usize::from(n[axis] < 0.0)
}

/// Densities of directions by kinds of vertices and regions of space.
#[derive(Clone, Debug)]
pub struct Field([Option<Part>; KINDS]);

/// Densities of directions by regions of space.
#[derive(Clone, Debug)]
struct Part {
    regions: Regions,
    leaves: Vec<Option<Quadtree>>,
}

impl Field {
    /// Field of what paths found at each kind of vertex.
    pub(super) fn new(found: &mut [Vec<Found>; KINDS]) -> Self {
        let mut parts = found.iter_mut().map(|found| Part::new(found));
        Self(std::array::from_fn(|_| parts.next().flatten()))
    }
}

impl Part {
    fn new(found: &mut [Found]) -> Option<Self> {
        if found.len() < FEWEST {
            return None;
        }
        let bounds = Bounds3::from_points(found.iter().map(|f| f.p));
        // 1. Regions by halving, and the finds in their order.
        let mut counts = Vec::new();
        let regions = Regions::new(
            found,
            |f| f.p,
            CAPACITY,
            |part| {
                counts.push(part.len());
                true
            },
        )?;
        // 2. A quadtree for each.
        let mut rest = &found[..];
        let parts: Vec<&[Found]> = counts
            .into_iter()
            .map(|count| {
                let (part, after) = rest.split_at(count);
                rest = after;
                part
            })
            .collect();
        let leaf = |part: &&[Found]| {
            if part.len() < FEWEST {
                return None;
            }
            Quadtree::new(&mut part.iter().map(|f| f.find).collect::<Vec<_>>())
        };
        Some(Self { regions: regions.within(bounds), leaves: parts.par_iter().map(leaf).collect() })
    }
}

impl Guide for Field {
    #[inline]
    fn at(&self, vertex: &Vertex<'_>, _: u32) -> Option<impl Directions> {
        let part = is_guided(vertex).then(|| self.0[kind(vertex)].as_ref()).flatten()?;
        part.leaves[part.regions.leaf(vertex.p())?].as_ref()
    }
}

/// True if directions at a vertex are broad enough to be drawn by others than scattering, and its model has a density
/// for them.
#[inline]
pub(super) fn is_guided(vertex: &Vertex<'_>) -> bool {
    let Vertex::Surface { scattering, .. } = vertex else { return true };
    match &scattering.bsdf {
        Bsdf::Conductor(b) => b.microfacet.mean_alpha() > NARROW,
        Bsdf::Dielectric(b) => b.microfacet.mean_alpha() > NARROW,
        Bsdf::ThinDielectric(_) | Bsdf::Hair(_) | Bsdf::Layered(_) => false,
        _ => !vertex.is_specular(),
    }
}

impl Directions for &Quadtree {
    #[inline]
    fn share(&self) -> f32 {
        SHARE
    }

    #[inline]
    fn sample(&self, u: f32, u2: Vec2) -> Vec3 {
        Quadtree::sample(self, u, u2)
    }

    #[inline]
    fn pdf(&self, w: Vec3) -> f32 {
        Quadtree::pdf(self, w)
    }
}
