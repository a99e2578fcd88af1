//! Primitives that may be seen at a pixel, and the choice among their hits by opacity.

use super::meet::{Border, local, meet};
use crate::{draw_list::Item, projection::Projected};
use steradian_core::{Scene, scene::Hit};
use steradian_math::Ray;

/// Class of opacity of the surfaces in a picture.
#[derive(Clone, Debug)]
pub enum Cover {
    /// Hits that pass the stochastic alpha test.
    Tested,
    /// Opaque surfaces.
    Opaque,
    /// Opacities between 0 and 1.
    Transparent,
    /// Opacities between 0 and 1 behind a depth of each pixel (reversed, by rows): a step of depth peeling (Everitt
    /// 2001).
    Behind(Vec<f32>),
}

impl Cover {
    /// True if a hit counts; hit and ray are in the space of the item.
    fn counts(&self, scene: &Scene, hit: &Hit, ray: &Ray) -> bool {
        match self {
            Self::Tested => scene.counts(hit, ray),
            Self::Opaque => scene.coverage(hit, ray) >= 1.0,
            Self::Transparent | Self::Behind(_) => {
                let opacity = scene.coverage(hit, ray);
                opacity > 0.0 && opacity < 1.0
            }
        }
    }

    /// True unless a depth at a pixel was peeled away already.
    fn is_left(&self, pixel: usize, depth: impl FnOnce() -> f32) -> bool {
        match self {
            // Helpers of quads may lie beyond the border.
            Self::Behind(peeled) => peeled.get(pixel).is_some_and(|peeled| depth() < *peeled),
            _ => true,
        }
    }
}

/// A primitive that may be seen at a pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate<'a> {
    /// Index of the pixel, by rows.
    pub pixel: usize,
    pub item: &'a Item,
    /// Index of the item in the draw list.
    pub index: u32,
    pub part: u32,
    /// Number of the primitive among all of the draw list.
    pub number: u32,
    /// Ray of the pixel.
    pub ray: Ray,
    pub border: Border,
    /// Depth that the pipeline interpolated; `None` for shapes that are no triangles.
    pub depth: Option<f32>,
}

/// The hit of a candidate that is drawn.
pub(crate) type Take<'t> = dyn Fn(&Candidate<'_>) -> Option<Hit> + Sync + 't;

impl Candidate<'_> {
    /// The nearest hit that a cover shows.
    pub fn meet(&self, scene: &Scene, projected: &Projected, cover: &Cover) -> Option<Hit> {
        self.meet_after(scene, projected, cover, f32::NEG_INFINITY)
    }

    /// The nearest hit that a cover shows beyond a distance along the ray.
    pub fn meet_after(&self, scene: &Scene, projected: &Projected, cover: &Cover, after: f32) -> Option<Hit> {
        let Self { pixel, item, part, ray, border, depth, .. } = self;
        meet(scene, item, *part, ray, *border, |hit, local| {
            hit.t > after
                && cover.counts(scene, hit, local)
                && cover.is_left(*pixel, || depth.unwrap_or_else(|| projected.depth(ray.at(hit.t))))
        })
    }

    /// The ray in the space of the item.
    pub fn local_ray(&self, scene: &Scene) -> Ray {
        local(scene, self.item, &self.ray)
    }
}
