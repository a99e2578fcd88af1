//! Directions that a bent shading normal sends to the wrong side of the surface, folded back about its plane.
//!
//! A model that transmits light tells reflection from transmission by its own frame. Where the shading normal leans
//! away from the geometric one, a wedge of directions lies above one plane and below the other: light refracted into
//! the wedge would leave a body without having entered it, and with its radiance scaled by 1/η² for nothing. The model's
//! distribution over the wedge is mirrored about the geometric plane instead. Mirroring keeps solid angles, so that
//! the albedo is the model's own, whatever the normal.

use steradian_bsdf::{Bsdf, BsdfEval, BsdfSample, Lobe, TransportMode};
use steradian_math::Vec3;

/// The geometric plane, seen in the shading frame.
#[derive(Clone, Copy, Debug)]
pub struct Fold {
    /// Its unit normal.
    pub n: Vec3,
}

impl Fold {
    /// Both planes agree on the side of a direction.
    #[inline]
    fn agree(self, w: Vec3) -> bool {
        w.z * self.n.dot(w) > 0.0
    }

    /// The mirror image of a direction about the geometric plane.
    #[inline]
    fn mirrored(self, w: Vec3) -> Vec3 {
        w - self.n * (2.0 * self.n.dot(w))
    }

    /// The directions of the model that are folded into `wi`, for a viewer in `wo`. A viewer in the wedge sees the
    /// model as it is.
    #[inline]
    pub fn sources(self, wo: Vec3, wi: Vec3) -> [Option<Vec3>; 2] {
        if !self.agree(wo) {
            return [Some(wi), None];
        }
        let mirrored = self.mirrored(wi);
        if self.agree(wi) { [Some(wi), (!self.agree(mirrored)).then_some(mirrored)] } else { [None, None] }
    }

    /// [`Bsdf::eval`] for a viewer in `wo`, summed over sources.
    pub fn eval(self, bsdf: &Bsdf<'_>, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfEval {
        self.sources(wo, wi).into_iter().flatten().fold(BsdfEval::ZERO, |sum, w| {
            let e = bsdf.eval(wo, w, mode);
            BsdfEval { value: sum.value + e.value, pdf: sum.pdf + e.pdf }
        })
    }

    /// [`Bsdf::pdf`] for a viewer in `wo`, summed over sources.
    pub fn pdf(self, bsdf: &Bsdf<'_>, wo: Vec3, wi: Vec3, mode: TransportMode) -> f32 {
        self.sources(wo, wi).into_iter().flatten().map(|w| bsdf.pdf(wo, w, mode)).sum()
    }

    /// A direction that the model drew for a viewer in `wo`, folded; its weight stays that of its source.
    pub fn drawn(self, bsdf: &Bsdf<'_>, wo: Vec3, s: BsdfSample, mode: TransportMode) -> BsdfSample {
        if s.lobe.contains(Lobe::SUBSURFACE) || !self.agree(wo) {
            return s;
        }
        let (wi, lobe) =
            if self.agree(s.wi) { (s.wi, s.lobe) } else { (self.mirrored(s.wi), s.lobe.with(Lobe::FOLDED)) };
        let pdf = if s.lobe.is_specular() { s.pdf } else { self.pdf(bsdf, wo, wi, mode) };
        BsdfSample { wi, lobe, pdf, ..s }
    }
}
