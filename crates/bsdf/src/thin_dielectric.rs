//! A pane of glass that is thin against everything else: light is refracted in and out again and leaves without
//! changing its direction. All reflections inside are summed: `R' = R + T²R/(1 − R²) = 2R/(1 + R)`, `T' = 1 − R'`.

use super::{
    Bsdf, BsdfEval, BsdfSample, Lobe, TransportMode, fresnel,
    registry::{Case, Model, Visitor},
    scatter::Scatter,
};
use steradian_math::{Spectrum, Vec2, Vec3};

/// A thin transparent sheet, the same from both sides.
#[derive(Clone, Copy, Debug)]
pub struct ThinDielectric {
    /// A factor on reflected light, 1 for a physical pane.
    pub reflectance: Spectrum,
    /// A factor on transmitted light, 1 for a physical pane.
    pub transmittance: Spectrum,
    /// Index of the pane relative to the medium around it (> 0).
    pub eta: f32,
}

impl ThinDielectric {
    /// A pane without tint.
    pub fn new(eta: f32) -> Self {
        Self { reflectance: Spectrum::ONE, transmittance: Spectrum::ONE, eta }
    }

    /// The reflected fraction with all reflections inside.
    fn reflected(&self, wo: Vec3) -> f32 {
        let r = fresnel::dielectric(wo.z.abs(), self.eta);
        2.0 * r / (1.0 + r)
    }
}

impl Scatter for ThinDielectric {
    const MODELS: &'static [Model] = &[Model::new("thin-dielectric", "a thin pane of glass", cases)];

    fn sample(&self, wo: Vec3, u: f32, _: Vec2, _: TransportMode) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let f = self.reflected(wo);
        let (r, t) = (f * self.reflectance.max_element(), (1.0 - f) * self.transmittance.max_element());
        if r + t <= 0.0 {
            return None;
        }
        let p = r / (r + t);
        let (wi, tint, fraction, p, side) = if u < p {
            (Vec3::new(-wo.x, -wo.y, wo.z), self.reflectance, f, p, Lobe::REFLECTION)
        } else {
            (-wo, self.transmittance, 1.0 - f, 1.0 - p, Lobe::TRANSMISSION)
        };
        (p > 0.0).then(|| BsdfSample {
            wi,
            weight: tint * (fraction / p),
            pdf: p,
            lobe: side.with(Lobe::SPECULAR),
            eta: 1.0,
        })
    }

    fn albedo_estimate(&self, wo: Vec3) -> Spectrum {
        let f = self.reflected(wo);
        self.reflectance * f + self.transmittance * (1.0 - f)
    }

    fn straight_transmission(&self, wo: Vec3) -> Option<Spectrum> {
        Some(self.transmittance * (1.0 - self.reflected(wo)))
    }

    #[inline]
    fn eval(&self, _: Vec3, _: Vec3, _: TransportMode) -> BsdfEval {
        BsdfEval::ZERO
    }

    #[inline]
    fn is_specular(&self) -> bool {
        true
    }

    #[inline]
    fn transmits(&self) -> bool {
        true
    }
}

fn cases(visit: &mut Visitor<'_>) {
    visit(Case { label: "pane", bsdf: Bsdf::ThinDielectric(ThinDielectric::new(1.5)), lossless: true });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_reflections_inside_are_summed() {
        // R + T R T (1 + R² + R⁴ + …) by explicit summation, at several angles.
        for cos in [1.0f32, 0.6, 0.2, -0.4] {
            let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
            let r = f64::from(fresnel::dielectric(cos.abs(), 1.5));
            let series: f64 = r + (0..200).map(|n| (1.0 - r).powi(2) * r.powi(2 * n + 1)).sum::<f64>();
            let pane = ThinDielectric::new(1.5);
            let (reflected, transmitted) = (
                pane.sample(wo, 0.0, Vec2::ZERO, TransportMode::Radiance).unwrap(),
                pane.sample(wo, 0.999, Vec2::ZERO, TransportMode::Radiance).unwrap(),
            );
            assert!((f64::from(reflected.pdf) - series).abs() < 1e-5, "{} is not {series}", reflected.pdf);
            assert!((f64::from(transmitted.pdf) - (1.0 - series)).abs() < 1e-5);
            assert_eq!(reflected.wi, Vec3::new(-wo.x, 0.0, wo.z));
            assert_eq!(transmitted.wi, -wo);
        }
        // At normal incidence on glass 2·0.04/1.04.
        assert!(
            (ThinDielectric::new(1.5).sample(Vec3::Z, 0.0, Vec2::ZERO, TransportMode::Radiance).unwrap().pdf
                - 0.076923)
                .abs()
                < 1e-6
        );
    }
}
