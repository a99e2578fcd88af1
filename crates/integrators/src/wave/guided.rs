//! Lambertian vertices about which a guide may know something: directions are drawn there one by one, between the
//! kernels for light samples and for the rays that leave.

use super::{Walk, Walker, block::Block};
use crate::guiding::Guides;
use steradian_accel::columns::{Column, WIDTH, get3, get4, set3, set4};
use steradian_bsdf::{Bsdf, Diffuse};
use steradian_core::{
    material::Scattering,
    scene::{Hit, Interaction},
    shape::SurfacePoint,
};
use steradian_math::{Frame, Spectrum, Vec2};
use steradian_transport::{Guide, GuidedDirection, Vertex};

impl<const MEDIA: bool> Walk<'_, '_, MEDIA> {
    /// Marks the vertices of a block, the first of which are in use, that a guide may know.
    pub fn are_guided(&self, b: &Block, count: usize) -> [bool; WIDTH] {
        let guide = self.precomputed.guide();
        std::array::from_fn(|k| k < count && guide.is_some_and(|guide| guide.may_know(get3(&b.p, k), b.events[k])))
    }

    /// Draws directions at marked vertices of a block by the mixture with the guide, where paths arrive with some
    /// throughput. Others keep what the kernel has drawn.
    pub fn draw_guided(
        &self,
        b: &mut Block,
        (vertices, are_guided): (&[(u32, Hit)], &[bool; WIDTH]),
        arriving: &[Column; 4],
        walkers: &[Walker],
    ) {
        let Some(guide) = self.precomputed.guide() else { return };
        for (k, (number, hit)) in vertices.iter().enumerate().filter(|(k, _)| are_guided[*k]) {
            let state = &walkers[*number as usize].state;
            let vertex = lambertian(b, k, hit, state.ray.time);
            let Some(drawn) = guided(&vertex, guide, b, k) else { continue };
            b.is_drawn[k] = drawn.is_some().into();
            let Some(GuidedDirection { sample: s, ratio }) = drawn else { continue };
            // β ← β f |cosθ| / p, with p of the mixture; light samples are held against the density of scattering.
            set3(&mut b.wi, k, vertex.world(s.wi));
            (b.pdf[k], b.roulette_scale[k]) = (s.pdf, state.roulette_scale * (s.eta * s.eta / ratio));
            set4(&mut b.beta, k, (Spectrum::new(get4(arriving, k)) * s.weight).to_array());
        }
    }
}

/// The Lambertian vertex at a place of a block.
#[inline]
fn lambertian(b: &Block, k: usize, hit: &Hit, time: f32) -> Vertex<'static> {
    let bare = SurfacePoint::bare(get3(&b.p, k), get3(&b.error, k), get3(&b.n, k));
    let surface = SurfacePoint { ns: get3(&b.ns, k), ..bare };
    let coordinates = Vec2::new(hit.u, hit.v);
    let wo = -get3(&b.direction, k);
    let i = Interaction { surface, wo, t: hit.t, time, geometry: hit.id.geom, id: hit.id, coordinates };
    let bsdf = Bsdf::Diffuse(Diffuse { reflectance: Spectrum::new(get4(&b.reflectance, k)) });
    let frame = Frame::from_z(get3(&b.light_n, k));
    Vertex::Surface { i, scattering: Scattering { bsdf, ..Scattering::NONE }, frame, medium: None }
}

/// A direction by the mixture of scattering and what a guide knows at a vertex, drawn with the numbers of a place in a
/// block; an inner `None` where the path is absorbed, an outer one where the guide knows nothing.
#[inline]
pub fn guided(vertex: &Vertex<'_>, guide: &Guides, b: &Block, k: usize) -> Option<Option<GuidedDirection>> {
    let directions = guide.at(vertex, b.events[k])?;
    let u2 = Vec2::new(b.bsdf_u[0][k], b.bsdf_u[1][k]);
    Some(GuidedDirection::by_mixture(vertex, &directions, b.lobe_u[k], u2))
}
