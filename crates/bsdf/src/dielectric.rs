//! Glass and liquids: light is reflected in the ratio `F` of Fresnel's equations and refracted otherwise, at a smooth
//! surface or at microfacets (Walter et al. 2007, eqs. 20 and 21). Refraction into a denser medium compresses radiance
//! by `(η_t/η_i)²`, so radiance that is followed backwards is divided by it.

use super::{
    Bsdf, BsdfEval, BsdfSample, Lobe, Microfacet, NormalDistribution, Shadowing, TransportMode, fresnel,
    microfacet::{Facet, further_surfaces},
    registry::{Case, GREY, Model, Visitor},
    scatter::Scatter,
};
use steradian_math::{Spectrum, Vec2, Vec3};

/// An interface between two transparent media, the same from both sides.
#[derive(Clone, Copy, Debug)]
pub struct Dielectric {
    /// A factor on reflected light, 1 for a physical interface.
    pub reflectance: Spectrum,
    /// A factor on transmitted light, 1 for a physical interface.
    pub transmittance: Spectrum,
    /// Index of the medium below relative to the one above (> 0). One number: where it depends on the wavelength, the
    /// caller follows one wavelength.
    pub eta: f32,
    /// The roughness of the interface.
    pub microfacet: Microfacet,
}

impl Dielectric {
    /// An interface without tint.
    pub fn new(eta: f32, microfacet: Microfacet) -> Self {
        Self { reflectance: Spectrum::ONE, transmittance: Spectrum::ONE, eta, microfacet }
    }

    /// True if the two media do not differ: light goes straight through, however rough the interface is.
    pub(crate) fn is_matched(&self) -> bool {
        (self.eta - 1.0).abs() < 1e-4
    }

    /// The probability of reflection where the fraction `f` is reflected; `None` where nothing is scattered.
    #[inline]
    pub(crate) fn reflection_probability(&self, f: f32) -> Option<f32> {
        let [r, sum] = self.shares(f);
        (sum > 0.0).then(|| r / sum)
    }

    /// Reflected part, and scattered part in all, in the brightest lanes.
    #[inline]
    fn shares(&self, f: f32) -> [f32; 2] {
        let r = f * self.reflectance.max_element();
        [r, r + (1.0 - f) * self.transmittance.max_element()]
    }

    /// Reflection from a facet that reflects the fraction `f` and is sampled to do so with probability `p`.
    fn reflected(&self, facet: Facet, f: f32, p: f32) -> BsdfEval {
        BsdfEval { value: self.reflectance * (f * facet.value), pdf: p * facet.pdf }
    }

    /// Transmission through such a facet.
    fn transmitted(&self, facet: Facet, f: f32, p: f32, eta: f32, mode: TransportMode) -> BsdfEval {
        let value = (1.0 - f) * facet.value * mode.compression(eta);
        BsdfEval { value: self.transmittance * value, pdf: (1.0 - p) * facet.pdf }
    }

    fn sample_smooth(&self, wo: Vec3, u: f32, mode: TransportMode) -> Option<BsdfSample> {
        let f = if self.is_matched() { 0.0 } else { fresnel::dielectric(wo.z, self.eta) };
        let p = self.reflection_probability(f)?;
        if u < p {
            return Some(BsdfSample::mirrored(wo, self.reflectance * (f / p), p));
        }
        let (wi, eta) = if self.is_matched() { (-wo, 1.0) } else { fresnel::refract(wo, Vec3::Z, self.eta)? };
        let p = 1.0 - p;
        (p > 0.0).then(|| BsdfSample {
            wi,
            weight: self.transmittance * ((1.0 - f) / p * mode.compression(eta)),
            pdf: p,
            lobe: Lobe::TRANSMISSION.with(Lobe::SPECULAR),
            eta,
        })
    }
}

impl Scatter for Dielectric {
    const MODELS: &'static [Model] = &[Model::new("dielectric", "glass and liquids, smooth or rough", cases)];

    fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfEval {
        if self.is_specular() {
            return BsdfEval::ZERO;
        }
        let eta = if wo.z > 0.0 { self.eta } else { 1.0 / self.eta };
        let e = if wo.z * wi.z > 0.0 {
            let mirror = self.microfacet.mirror(wo, wi);
            self.microfacet.reflecting_by(&mirror, wo, wi).and_then(|facet| {
                let f = fresnel::Crossing::by_square(mirror.cos2, eta).reflectance;
                Some(self.reflected(facet, f, self.reflection_probability(f)?))
            })
        } else {
            self.microfacet.refracting(wo, wi, eta).and_then(|facet| {
                let f = fresnel::dielectric(facet.cos_o, self.eta);
                Some(self.transmitted(facet, f, self.reflection_probability(f)?, eta, mode))
            })
        };
        e.unwrap_or(BsdfEval::ZERO)
    }

    fn sample(&self, wo: Vec3, u: f32, u2: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        if self.is_specular() {
            return self.sample_smooth(wo, u, mode);
        }
        let n = self.microfacet.draw(wo, u2);
        let crossing = n.crossing(self.eta);
        let f = crossing.reflectance;
        let [r, sum] = self.shares(f);
        if sum <= 0.0 {
            return None;
        }
        let p = r / sum;
        // A direction on the wrong side of the surface has met a second facet: not modelled, black.
        let (wi, e, eta, side) = if u * sum < r {
            let wi = n.mirrored(wo);
            let facet = self.microfacet.reflecting_by(&n.mirror(), wo, wi)?;
            (wi, self.reflected(facet, f, p), 1.0, Lobe::REFLECTION)
        } else {
            let (wi, eta) = n.refracted(wo, &crossing)?;
            let facet = self.microfacet.refracting_drawn(&n, &crossing, wo, wi)?;
            (wi, self.transmitted(facet, f, p, eta, mode), eta, Lobe::TRANSMISSION)
        };
        e.drawn(wi, side.with(Lobe::GLOSSY), eta)
    }

    fn albedo_estimate(&self, wo: Vec3) -> Spectrum {
        let f = fresnel::dielectric(wo.z, self.eta);
        self.reflectance * f + self.transmittance * (1.0 - f)
    }

    fn is_specular(&self) -> bool {
        self.microfacet.is_smooth() || self.is_matched()
    }

    #[inline]
    fn transmits(&self) -> bool {
        true
    }

    #[inline]
    fn relative_eta(&self) -> f32 {
        self.eta
    }
}

fn cases(visit: &mut Visitor<'_>) {
    use NormalDistribution::{Beckmann, Ggx};
    use Shadowing::Separable;
    let mut case = |label, value, lossless| visit(Case { label, bsdf: Bsdf::Dielectric(value), lossless });
    case("smooth glass", Dielectric::new(1.5, Microfacet::SMOOTH), true);
    case("smooth bubble", Dielectric::new(1.0 / 1.33, Microfacet::SMOOTH), true);
    case("index 1", Dielectric::new(1.0, Microfacet::ggx(0.3, 0.3)), true);
    case("GGX glass, 0.1", Dielectric::new(1.5, Microfacet::ggx(0.1, 0.1)), false);
    case("GGX glass, 0.5", Dielectric::new(1.5, Microfacet::ggx(0.5, 0.5)), false);
    case("GGX glass, anisotropic, separable", Dielectric::new(1.33, Microfacet::new(Ggx, Separable, 0.15, 0.4)), false);
    case("GGX bubble, 0.3", Dielectric::new(1.0 / 1.5, Microfacet::ggx(0.3, 0.3)), false);
    case("GGX diamond, 0.2", Dielectric::new(2.417, Microfacet::ggx(0.2, 0.2)), false);
    case("Beckmann glass, 0.2", Dielectric::new(1.5, Microfacet::new(Beckmann, Separable, 0.2, 0.2)), false);
    let tinted = Dielectric {
        reflectance: GREY,
        transmittance: Spectrum::new([0.9, 0.1, 0.4, 0.2]),
        ..Dielectric::new(1.5, Microfacet::ggx(0.25, 0.25))
    };
    case("tinted", tinted, false);
    for (label, distribution, shadowing, x, y) in further_surfaces().into_iter().step_by(3) {
        case(label, Dielectric::new(1.5, Microfacet::new(distribution, shadowing, x, y)), false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use TransportMode::{Importance, Radiance};

    fn direction(degrees: f32) -> Vec3 {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Vec3::new(sin, 0.0, cos)
    }

    #[test]
    fn reflected_and_transmitted_light_add_up_and_radiance_is_compressed() {
        let glass = Dielectric::new(1.5, Microfacet::SMOOTH);
        for degrees in [0.0f32, 30.0, 60.0, 85.0, 120.0, 150.0] {
            let wo = direction(degrees);
            let r = glass.sample(wo, 0.0, Vec2::ZERO, Radiance).unwrap();
            assert_eq!(r.wi, Vec3::new(-wo.x, 0.0, wo.z));
            let Some(t) = glass.sample(wo, 0.9999, Vec2::ZERO, Radiance).filter(|t| t.lobe.is_transmission()) else {
                assert_eq!(r.pdf, 1.0, "only total internal reflection leaves nothing to transmit");
                continue;
            };
            assert!((r.pdf * r.weight[0] + t.pdf * t.weight[0] * t.eta * t.eta - 1.0).abs() < 1e-6);
            assert_eq!(t.eta, if wo.z > 0.0 { 1.5 } else { 1.0 / 1.5 });
            // Snell, and no compression of importance.
            assert!((t.wi.x.abs() * t.eta - wo.x.abs()).abs() < 1e-6);
            let adjoint = glass.sample(wo, 0.9999, Vec2::ZERO, Importance).unwrap();
            assert!((adjoint.weight[0] - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn a_slab_reflects_all_orders() {
        // Follow the expected light through two interfaces: 2F/(1 + F) comes back, and what leaves goes on in its
        // direction.
        let glass = Dielectric::new(1.5, Microfacet::SMOOTH);
        for degrees in [0.0f32, 45.0, 75.0] {
            let wo = direction(degrees);
            let pick = |w: Vec3, transmitted: bool| {
                let s = glass.sample(w, if transmitted { 0.99999 } else { 0.0 }, Vec2::ZERO, Radiance).unwrap();
                (s.wi, s.pdf * s.weight[0])
            };
            let (inside, entered) = pick(wo, true);
            let up = Vec3::new(inside.x, inside.y, -inside.z);
            let (_, kept) = pick(-up, false);
            let (left, leaves) = pick(-up, true);
            assert!((left.z - wo.z).abs() < 1e-5, "{left} leaves {wo}");
            let f = pick(wo, false).1;
            let total = f + entered * leaves * kept / (1.0 - kept * kept);
            assert!((total - 2.0 * f / (1.0 + f)).abs() < 1e-5, "{total} at {degrees}°");
        }
    }

    /// Rough glass in a furnace, from outside and from inside (M96): all light is found again but for what meets a
    /// second facet, which is little on smooth glass and the more the rougher it is.
    #[test]
    fn rough_glass_scatters_nearly_all_light_from_both_sides() {
        let scattered = |alpha: f32, wo: Vec3| {
            let glass = Dielectric::new(1.5, Microfacet::ggx(alpha, alpha));
            steradian_testkit::integrate_sphere(|wi| f64::from(glass.eval(wo, wi, Importance).value[0]), 1e-4)
        };
        for degrees in [0.0, 50.0, 130.0, 160.0] {
            let [smoother, rougher] = [0.1, 0.5].map(|alpha| scattered(alpha, direction(degrees)));
            // Inside, rough facets let light out near the horizon, where others stand in the way; most beyond the
            // critical angle.
            let least = if degrees == 130.0 { 0.965 } else { 0.985 };
            let rough = if degrees > 90.0 { 0.67 } else { 0.85 };
            assert!((least..1.001).contains(&smoother), "{degrees}°: {smoother}");
            assert!((rough..0.9995).contains(&rougher) && rougher < smoother, "{degrees}°: {rougher}, {smoother}");
        }
        // Radiance that is transmitted is compressed by the square of the index, that which is reflected not.
        let (glass, wo) = (Dielectric::new(1.5, Microfacet::ggx(0.3, 0.3)), direction(35.0));
        let ratio = |wi: Vec3| glass.eval(wo, wi, Radiance).value[0] / glass.eval(wo, wi, Importance).value[0];
        assert!((ratio(direction(-20.0)) - 1.0).abs() < 1e-6);
        assert!((ratio(direction(200.0)) - 1.0 / 2.25).abs() < 1e-6);
    }

    #[test]
    fn tints_act_on_their_lobe_alone() {
        let (red, blue) = (Spectrum::rgb(1.0, 0.2, 0.0), Spectrum::rgb(0.0, 0.3, 1.0));
        for microfacet in [Microfacet::SMOOTH, Microfacet::ggx(0.2, 0.2)] {
            let plain = Dielectric::new(1.5, microfacet);
            let tinted = Dielectric { reflectance: red, transmittance: blue, ..plain };
            for (u, tint) in [(0.0, red), (0.999, blue)] {
                // Contribution `weight·pdf` with the tint over that without, in each lane.
                let of = |d: &Dielectric| {
                    d.sample(direction(40.0), u, Vec2::new(0.3, 0.2), Radiance).map(|s| s.weight * s.pdf)
                };
                let ratio = of(&tinted).unwrap() / of(&plain).unwrap()[0];
                assert!((0..4).all(|i| (ratio[i] - tint[i]).abs() < 1e-5), "{ratio:?} is not {tint:?}");
            }
        }
    }
}
