//! Entry of light into a medium below a surface.

use crate::{
    Bsdf, BsdfEval, BsdfSample, Dielectric, Microfacet, TransportMode, fresnel,
    registry::{Case, Model, Visitor},
    scatter::Scatter,
};
use steradian_math::{Spectrum, Vec2, Vec3};

/// The surface of a medium that light enters to leave it elsewhere: reflection at a dielectric, and a lobe of its own,
/// [`Lobe::SUBSURFACE`](crate::Lobe::SUBSURFACE), for what is not reflected there.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Interface that reflects; its transmittance is a factor on the light that enters.
    pub interface: Dielectric,
}

impl Entry {
    /// Sample of the light that enters: the part `passed`, which is not reflected, drawn with a probability.
    fn entering(&self, passed: f32, probability: f32) -> Option<BsdfSample> {
        // The light that enters is a lobe without direction: its weight is the transmittance over its probability.
        (probability > 0.0)
            .then(|| BsdfSample::entering(self.interface.transmittance * (passed / probability), probability))
    }
}

impl Scatter for Entry {
    const MODELS: &'static [Model] =
        &[Model::new("subsurface", "the surface of a medium that light enters to leave it elsewhere", cases)];

    fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfEval {
        if wo.z <= 0.0 || wi.z <= 0.0 { BsdfEval::ZERO } else { self.interface.eval(wo, wi, mode) }
    }

    fn sample(&self, wo: Vec3, u: f32, u2: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        if !self.interface.is_specular() {
            // Facets reflect as those of glass; what they let through enters, whichever way it is refracted.
            let n = self.interface.microfacet.draw(wo, u2);
            let f = n.crossing(self.interface.eta).reflectance;
            let p = self.interface.reflection_probability(f)?;
            if u >= p {
                return self.entering(1.0 - f, 1.0 - p);
            }
        } else if self.interface.is_matched() {
            return self.entering(1.0, 1.0);
        }
        let drawn = self.interface.sample(wo, u, u2, mode)?;
        // A smooth interface chooses between reflection and entry by its Fresnel reflectance.
        if drawn.lobe.is_transmission() {
            return self.entering(1.0 - fresnel::dielectric(wo.z, self.interface.eta), drawn.pdf);
        }
        Some(drawn)
    }

    fn albedo_estimate(&self, wo: Vec3) -> Spectrum {
        self.interface.albedo_estimate(wo)
    }

    fn is_specular(&self) -> bool {
        self.interface.is_specular()
    }

    #[inline]
    fn transmits(&self) -> bool {
        false
    }

    #[inline]
    fn relative_eta(&self) -> f32 {
        self.interface.eta
    }
}

fn cases(visit: &mut Visitor<'_>) {
    let mut case = |label, eta: f32| {
        let interface = Dielectric::new(eta, Microfacet::SMOOTH);
        visit(Case { label, bsdf: Bsdf::Subsurface(Entry { interface }), lossless: true });
    };
    case("skin", 1.4);
    case("index 1", 1.0);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Lobe, TransportMode::Radiance};
    use steradian_math::hash::HashRng;

    /// The light that enters a rough surface and the light that it reflects are together no more than arrives, and the
    /// light that enters is the part that the facets in view let through: for a smooth surface 1 − F.
    #[test]
    fn what_is_not_reflected_enters() {
        let mut rng = HashRng::new(7);
        for alpha in [0.02, 0.3, 0.7] {
            let entry = Entry { interface: Dielectric::new(1.4, Microfacet::ggx(alpha, alpha)) };
            for cos in [1.0f32, 0.6, 0.15] {
                let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
                let (mut entered, mut reflected, n) = (0.0f64, 0.0f64, 40_000);
                for _ in 0..n {
                    let (u, u2) = (rng.next_f32(), Vec2::new(rng.next_f32(), rng.next_f32()));
                    let Some(s) = entry.sample(wo, u, u2, Radiance) else { continue };
                    let weight = f64::from(s.weight[0]) / f64::from(n);
                    if s.lobe.contains(Lobe::SUBSURFACE) { entered += weight } else { reflected += weight }
                }
                assert!(entered + reflected < 1.003, "α {alpha}, cosine {cos}: {entered} + {reflected}");
                if alpha < 0.1 && cos > 0.5 {
                    let expected = 1.0 - f64::from(fresnel::dielectric(cos, 1.4));
                    assert!((entered - expected).abs() < 5e-3, "{entered}, not {expected}");
                }
            }
        }
    }
}
