//! Light of an environment in two sums (Karis 2013, "Real Shading in Unreal Engine 4"): the environment blurred by the
//! lobe of the facets, times the albedo of the facets, and its irradiance times that of the diffuse part.

use super::{Bsdf, Conductor, albedo_table};
use steradian_math::{Spectrum, Vec3};

/// The factors of the two sums for one direction of view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplitSum {
    /// GGX roughness α of the facets.
    pub alpha: f32,
    /// Albedo of the facets, `f0 A(μ, α) + f90 B(μ, α)`; black for facets of a mirror.
    pub facets: Spectrum,
    /// Albedo of the diffuse part.
    pub diffuse: Spectrum,
}

impl Bsdf<'_> {
    /// The split of a surface that is seen from `wo`, in its frame; `None` for models other than diffuse reflection,
    /// metals and glTF's surface without layers and transmission, and from below.
    pub fn split_sum(&self, wo: Vec3) -> Option<SplitSum> {
        match self {
            _ if wo.z <= 0.0 => None,
            Bsdf::Diffuse(b) => Some(SplitSum { alpha: 1.0, facets: Spectrum::ZERO, diffuse: b.reflectance }),
            Bsdf::Conductor(b) => Some(b.split_sum(wo.z)),
            Bsdf::Pbr(b) => b.split_sum(wo),
            _ => None,
        }
    }
}

impl Conductor {
    fn split_sum(&self, cos: f32) -> SplitSum {
        let alpha = self.microfacet.mean_alpha();
        // Schlick's reflectance between that at normal incidence and all of it.
        let [a, b] = albedo_table::ggx(albedo_table::row(alpha), cos);
        let facets =
            if self.microfacet.is_smooth() { Spectrum::ZERO } else { self.reflectance(1.0) * a + self.tint * b };
        SplitSum { alpha, facets, diffuse: Spectrum::ZERO }
    }
}
