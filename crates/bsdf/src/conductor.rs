//! Metals: mirror reflection tinted by the Fresnel equations of a complex index `η − ik`, from a smooth surface or
//! from microfacets, `f = F D G₂ / (4 cosθ_o cosθ_i)` (Torrance & Sparrow 1967; Walter et al. 2007, eq. 20).

use super::{
    Bsdf, BsdfEval, BsdfSample, Lobe, Microfacet, NormalDistribution, Shadowing, TransportMode, fresnel,
    microfacet::{Mirror, further_surfaces},
    registry::{Case, GREY, Model, Visitor},
    scatter::Scatter,
};
use steradian_math::{Spectrum, Vec2, Vec3};

/// An opaque, reflecting surface.
#[derive(Clone, Copy, Debug)]
pub struct Conductor {
    /// Real part of the index, relative to the medium above, at the lanes' wavelengths (> 0; 0 reflects everything).
    pub eta: Spectrum,
    /// Imaginary part of the index (absorption), relative too.
    pub k: Spectrum,
    /// A factor on the reflectance, 1 for a physical metal.
    pub tint: Spectrum,
    /// The roughness of the surface.
    pub microfacet: Microfacet,
}

impl Conductor {
    /// The perfect mirror: a purely imaginary index reflects all light at all angles.
    pub fn mirror(reflectance: Spectrum, microfacet: Microfacet) -> Self {
        Self { eta: Spectrum::ZERO, k: Spectrum::ONE, tint: reflectance, microfacet }
    }

    /// A metal whose reflectance at normal incidence is `reflectance` (clamped below 1): `η = 1`, `k = 2√(r/(1−r))`, as
    /// pbrt-v4 reads the `reflectance` of its conductor.
    pub fn from_reflectance(reflectance: Spectrum, microfacet: Microfacet) -> Self {
        let k = reflectance.clamp(0.0, 0.9999).map(|r| 2.0 * (r / (1.0 - r)).sqrt());
        Self { eta: Spectrum::ONE, k, tint: Spectrum::ONE, microfacet }
    }

    /// By the square of the cosine.
    #[inline(always)]
    pub(super) fn reflectance(&self, cos2: f32) -> Spectrum {
        self.tint * fresnel::conductor_by_square(cos2, self.eta, self.k)
    }

    /// The value for a rough surface and `wo` above it.
    #[inline(always)]
    pub(super) fn eval_by(&self, mirror: &Mirror, wo: Vec3, wi: Vec3) -> BsdfEval {
        self.microfacet.reflecting_by(mirror, wo, wi).map_or(BsdfEval::ZERO, |facet| BsdfEval {
            value: self.reflectance(mirror.cos2) * facet.value,
            pdf: facet.pdf,
        })
    }
}

impl Scatter for Conductor {
    const MODELS: &'static [Model] = &[Model::new("conductor", "metals and mirrors, smooth or rough", cases)];

    fn eval(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> BsdfEval {
        if wo.z <= 0.0 || self.microfacet.is_smooth() {
            return BsdfEval::ZERO;
        }
        self.eval_by(&self.microfacet.mirror(wo, wi), wo, wi)
    }

    fn sample(&self, wo: Vec3, _: f32, u2: Vec2, _: TransportMode) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        if self.microfacet.is_smooth() {
            return Some(BsdfSample::mirrored(wo, self.reflectance(wo.z * wo.z), 1.0));
        }
        let n = self.microfacet.draw(wo, u2);
        let (wi, mirror) = (n.mirrored(wo), n.mirror());
        let facet = self.microfacet.reflecting_by(&mirror, wo, wi)?;
        let (weight, lobe) = (self.reflectance(mirror.cos2) * facet.weight, Lobe::REFLECTION.with(Lobe::GLOSSY));
        Some(BsdfSample { wi, weight, pdf: facet.pdf, lobe, eta: 1.0 })
    }

    fn albedo_estimate(&self, wo: Vec3) -> Spectrum {
        self.reflectance(wo.z * wo.z)
    }

    #[inline]
    fn is_specular(&self) -> bool {
        self.microfacet.is_smooth()
    }
}

fn cases(visit: &mut Visitor<'_>) {
    use NormalDistribution::{Beckmann, Ggx};
    use Shadowing::{HeightCorrelated, Separable};
    let gold = |microfacet| Conductor {
        eta: Spectrum::new([0.18, 0.42, 1.37, 0.37]),
        k: Spectrum::new([3.1, 2.35, 1.77, 2.82]),
        tint: Spectrum::ONE,
        microfacet,
    };
    let mut case = |label, value, lossless| visit(Case { label, bsdf: Bsdf::Conductor(value), lossless });
    case("smooth mirror", Conductor::mirror(Spectrum::ONE, Microfacet::SMOOTH), true);
    case("smooth gold", gold(Microfacet::SMOOTH), false);
    case("GGX mirror, 0.05", Conductor::mirror(Spectrum::ONE, Microfacet::ggx(0.05, 0.05)), false);
    case("GGX gold, 0.3", gold(Microfacet::ggx(0.3, 0.3)), false);
    case("GGX gold, separable, 0.5", gold(Microfacet::new(Ggx, Separable, 0.5, 0.5)), false);
    case("GGX gold, anisotropic 0.1 and 0.4", gold(Microfacet::ggx(0.1, 0.4)), false);
    case("GGX mirror, 1", Conductor::mirror(GREY, Microfacet::ggx(1.0, 1.0)), false);
    case("Beckmann gold, 0.05", gold(Microfacet::new(Beckmann, HeightCorrelated, 0.05, 0.05)), false);
    case("Beckmann gold, 0.3", gold(Microfacet::new(Beckmann, Separable, 0.3, 0.3)), false);
    case("Beckmann gold, anisotropic 0.4 and 0.1", gold(Microfacet::new(Beckmann, Separable, 0.4, 0.1)), false);
    case("from reflectance", Conductor::from_reflectance(GREY, Microfacet::ggx(0.2, 0.2)), false);
    for (label, distribution, shadowing, x, y) in further_surfaces() {
        case(label, gold(Microfacet::new(distribution, shadowing, x, y)), false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mirror_reflects_its_reflectance_at_every_angle() {
        let reflectance = Spectrum::new([0.9, 0.5, 0.1, 0.0]);
        let mirror = Conductor::mirror(reflectance, Microfacet::SMOOTH);
        for cos in [1.0f32, 0.7, 0.1] {
            let wo = Vec3::new(0.6 * (1.0 - cos * cos).sqrt(), -0.8 * (1.0 - cos * cos).sqrt(), cos);
            let s = mirror.sample(wo, 0.0, Vec2::splat(0.5), TransportMode::Radiance).unwrap();
            assert_eq!(s.wi, Vec3::new(-wo.x, -wo.y, wo.z));
            assert_eq!((s.weight, s.pdf), (reflectance, 1.0));
        }
        assert!(mirror.sample(-Vec3::Z, 0.0, Vec2::ZERO, TransportMode::Radiance).is_none());
    }

    #[test]
    fn a_metal_from_its_reflectance_has_it_at_normal_incidence() {
        let reflectance = Spectrum::new([0.9, 0.5, 0.1, 0.0]);
        let metal = Conductor::from_reflectance(reflectance, Microfacet::SMOOTH);
        let f = metal.sample(Vec3::Z, 0.0, Vec2::ZERO, TransportMode::Radiance).unwrap().weight;
        assert!((0..4).all(|i| (f[i] - reflectance[i]).abs() < 1e-5), "{f:?}");
        // The rough surface has the same Fresnel factor: tint and index act on the facets.
        let rough = Conductor { tint: Spectrum::splat(0.5), microfacet: Microfacet::ggx(0.2, 0.2), ..metal };
        let white = Conductor::mirror(Spectrum::ONE, rough.microfacet);
        let ratio = rough.eval(Vec3::Z, Vec3::Z, TransportMode::Radiance).value
            / white.eval(Vec3::Z, Vec3::Z, TransportMode::Radiance).value[0];
        assert!((0..4).all(|i| (ratio[i] - 0.5 * reflectance[i]).abs() < 1e-5), "{ratio:?}");
    }
}
