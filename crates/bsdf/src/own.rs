//! Scattering models of a program's own, behind one dynamic variant of [`Bsdf`](super::Bsdf).

use super::{
    BsdfEval, BsdfSample, Inputs, Lobe, TransportMode,
    registry::{Case, GREY, MOST_INPUTS, Model, Visitor, WHITE},
    scatter::Scatter,
};
use std::fmt::Debug;
use steradian_math::{Spectrum, Vec2, Vec3, warp};

/// A scattering model of a program's own. Directions are unit vectors that point away from the surface, whose normal is
/// z; parameters are those of the point. Models that only reflect are black where z of a direction is not above 0.
///
/// Values that are negative or not finite count as black, so that a fault of a model shows as dark pixels.
pub trait OwnScatter: Debug + Send + Sync {
    /// `f·|cosθ_i|`, sr⁻¹, of light from `wi` to `wo`, without delta distributions.
    fn value(&self, at: &Inputs, wo: Vec3, wi: Vec3, mode: TransportMode) -> Spectrum;

    /// Density, sr⁻¹, with which [`Self::sample`] draws `wi`: by default that of a cosine lobe.
    fn pdf(&self, _at: &Inputs, wo: Vec3, wi: Vec3, _mode: TransportMode) -> f32 {
        if wo.z > 0.0 { wi.z.max(0.0) * std::f32::consts::FRAC_1_PI } else { 0.0 }
    }

    /// Draws a direction: `u` chooses among lobes, `u2` within one, all in `[0, 1)`. `None` for light that is lost.
    fn sample(&self, _at: &Inputs, wo: Vec3, _u: f32, u2: Vec2, _mode: TransportMode) -> Option<Draw> {
        (wo.z > 0.0).then(|| Draw::Spread(warp::cosine_hemisphere(u2)))
    }

    /// A cheap estimate of the directional albedo, for feature images: by default the first colour.
    fn albedo_estimate(&self, at: &Inputs, _wo: Vec3) -> Spectrum {
        at.colors[0]
    }

    /// True if every lobe is a delta distribution.
    fn is_specular(&self) -> bool {
        false
    }

    /// True if light can pass to the other side.
    fn transmits(&self) -> bool {
        false
    }

    /// True if the model is the same with the two directions exchanged.
    fn is_reciprocal(&self) -> bool {
        true
    }

    /// True if the orientation of the tangent x matters.
    fn is_anisotropic(&self) -> bool {
        false
    }

    /// True if its lobes are broad, which helps denoisers and the choice of paths that are reused.
    fn is_diffuse(&self) -> bool {
        false
    }

    /// Index of refraction below the surface relative to above, for what refracts into it.
    fn relative_eta(&self, _at: &Inputs) -> f32 {
        1.0
    }
}

/// A direction that a model of a program's own drew.
#[derive(Clone, Copy, Debug)]
pub enum Draw {
    /// A direction by the density of [`OwnScatter::pdf`].
    Spread(Vec3),
    /// The one direction of a delta distribution.
    Specular {
        /// The direction.
        wi: Vec3,
        /// Part of the light that goes there, over the probability of the draw.
        weight: Spectrum,
        /// Probability of the draw.
        probability: f32,
    },
}

/// A model of a program's own with its parameters at a point.
#[derive(Clone, Copy, Debug)]
pub struct Own<'a> {
    /// The model.
    pub model: &'a dyn OwnScatter,
    /// The parameters.
    pub at: Inputs,
}

/// Light, or none where a value is negative or not finite.
fn sound(value: Spectrum) -> Spectrum {
    if value.is_finite() { value.clamp(0.0, f32::MAX) } else { Spectrum::ZERO }
}

impl Own<'_> {
    fn lobe(&self, wo: Vec3, wi: Vec3, spread: Lobe) -> Lobe {
        if wo.z * wi.z < 0.0 { Lobe::TRANSMISSION.with(spread) } else { Lobe::REFLECTION.with(spread) }
    }

    /// Relative index that a direction on the other side met, η_t/η_i.
    fn eta(&self, wo: Vec3, wi: Vec3) -> f32 {
        let eta = self.model.relative_eta(&self.at);
        match () {
            () if wo.z * wi.z >= 0.0 => 1.0,
            () if wo.z > 0.0 => eta,
            () => 1.0 / eta,
        }
    }
}

impl Scatter for Own<'_> {
    const MODELS: &'static [Model] = &[
        Model::new("own", "a model of a program's own: what the trait has by default, a lobe, a pane", cases),
        Model::new("own-tilted", "one that is not reciprocal", tilted_cases).not_reciprocal(),
    ];

    fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfEval {
        let pdf = self.model.pdf(&self.at, wo, wi, mode);
        let pdf = if pdf.is_finite() { pdf.max(0.0) } else { 0.0 };
        BsdfEval { value: sound(self.model.value(&self.at, wo, wi, mode)), pdf }
    }

    fn sample(&self, wo: Vec3, u: f32, u2: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        match self.model.sample(&self.at, wo, u, u2, mode)? {
            Draw::Spread(wi) => {
                let wi = wi.try_normalize()?;
                let spread = if self.model.is_diffuse() { Lobe::DIFFUSE } else { Lobe::GLOSSY };
                self.eval(wo, wi, mode).drawn(wi, self.lobe(wo, wi, spread), self.eta(wo, wi))
            }
            Draw::Specular { wi, weight, probability } => {
                let wi = wi.try_normalize()?;
                let is_sound = weight.is_finite() && probability > 0.0 && probability <= 1.0;
                let lobe = self.lobe(wo, wi, Lobe::SPECULAR);
                let eta = self.eta(wo, wi);
                is_sound.then(|| BsdfSample { wi, weight: sound(weight), pdf: probability, lobe, eta })
            }
        }
    }

    fn albedo_estimate(&self, wo: Vec3) -> Spectrum {
        sound(self.model.albedo_estimate(&self.at, wo)).clamp(0.0, 1.0)
    }

    fn pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> f32 {
        let pdf = self.model.pdf(&self.at, wo, wi, mode);
        if pdf.is_finite() { pdf.max(0.0) } else { 0.0 }
    }

    fn is_specular(&self) -> bool {
        self.model.is_specular()
    }

    fn transmits(&self) -> bool {
        self.model.transmits()
    }

    fn is_reciprocal(&self) -> bool {
        self.model.is_reciprocal()
    }

    fn relative_eta(&self) -> f32 {
        self.model.relative_eta(&self.at)
    }
}

/// Lambert's law by the defaults of the trait; tilted, brighter from one side, which is not reciprocal.
#[derive(Debug)]
struct Plain {
    tilt: f32,
}

impl OwnScatter for Plain {
    fn value(&self, at: &Inputs, wo: Vec3, wi: Vec3, mode: TransportMode) -> Spectrum {
        let pdf = self.pdf(at, wo, wi, mode);
        at.colors[0] * pdf * (1.0 - self.tilt * (0.5 - 0.5 * wi.x))
    }

    fn is_reciprocal(&self) -> bool {
        self.tilt == 0.0
    }

    fn is_diffuse(&self) -> bool {
        true
    }

    fn is_anisotropic(&self) -> bool {
        self.tilt != 0.0
    }
}

/// A pane that spreads light to both sides evenly, and lets the second colour pass straight.
#[derive(Debug)]
struct Pane;

impl OwnScatter for Pane {
    fn value(&self, at: &Inputs, wo: Vec3, wi: Vec3, mode: TransportMode) -> Spectrum {
        // Half of the draws are spread.
        at.colors[0] * self.pdf(at, wo, wi, mode) * 2.0
    }

    fn pdf(&self, _: &Inputs, wo: Vec3, wi: Vec3, _: TransportMode) -> f32 {
        if wo.z == 0.0 { 0.0 } else { wi.z.abs() * 0.25 * std::f32::consts::FRAC_1_PI }
    }

    fn sample(&self, at: &Inputs, wo: Vec3, u: f32, u2: Vec2, _: TransportMode) -> Option<Draw> {
        if u < 0.5 {
            return Some(Draw::Specular { wi: -wo, weight: at.colors[1] * 2.0, probability: 0.5 });
        }
        let up = warp::cosine_hemisphere(u2);
        let wi = if u < 0.75 { up } else { -up };
        (wo.z != 0.0 && wi.z != 0.0).then_some(Draw::Spread(wi))
    }

    fn transmits(&self) -> bool {
        true
    }
}

const NOTHING: Inputs =
    Inputs { colors: [Spectrum::ZERO; MOST_INPUTS], numbers: [0.0; MOST_INPUTS], choice: 0, vector: Vec3::ZERO };

fn case(visit: &mut Visitor<'_>, label: &'static str, model: &dyn OwnScatter, colors: [Spectrum; 2], lossless: bool) {
    let [a, b] = colors;
    let at = Inputs { colors: [a, b, Spectrum::ZERO, Spectrum::ZERO], ..NOTHING };
    visit(Case { label, bsdf: super::Bsdf::Own(Own { model, at }), lossless });
}

fn cases(visit: &mut Visitor<'_>) {
    case(visit, "defaults", &Plain { tilt: 0.0 }, [GREY, GREY], false);
    case(visit, "lossless", &Plain { tilt: 0.0 }, [WHITE, GREY], true);
    case(visit, "pane", &Pane, [GREY * 0.5, GREY * 0.5], false);
    case(visit, "lossless pane", &Pane, [WHITE * 0.5, WHITE * 0.5], true);
}

fn tilted_cases(visit: &mut Visitor<'_>) {
    case(visit, "tilted", &Plain { tilt: 0.8 }, [GREY, GREY], false);
}

#[cfg(test)]
mod tests {
    use super::*;
    use TransportMode::Radiance;

    /// A model that gives numbers that are none.
    #[derive(Debug)]
    struct Faulty;

    impl OwnScatter for Faulty {
        fn value(&self, _: &Inputs, _: Vec3, wi: Vec3, _: TransportMode) -> Spectrum {
            Spectrum::splat(if wi.x > 0.0 { f32::NAN } else { -1.0 })
        }

        fn pdf(&self, _: &Inputs, _: Vec3, wi: Vec3, _: TransportMode) -> f32 {
            if wi.y > 0.0 { f32::INFINITY } else { -1.0 }
        }

        fn sample(&self, _: &Inputs, _: Vec3, u: f32, _: Vec2, _: TransportMode) -> Option<Draw> {
            let weight = Spectrum::splat(f32::NAN);
            Some(if u < 0.5 {
                Draw::Spread(Vec3::ZERO)
            } else {
                Draw::Specular { wi: Vec3::Z, weight, probability: 2.0 }
            })
        }
    }

    /// Faults of a model are darkness, and enter no picture.
    #[test]
    fn faulty_models_are_black() {
        let own = Own { model: &Faulty, at: NOTHING };
        for wi in [Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.6, 0.0, 0.8), Vec3::new(0.0, 0.6, 0.8)] {
            let e = own.eval(Vec3::Z, wi, Radiance);
            assert_eq!((e.value, e.pdf, own.pdf(Vec3::Z, wi, Radiance)), (Spectrum::ZERO, 0.0, 0.0), "{wi}");
        }
        assert!([0.1, 0.9].into_iter().all(|u| own.sample(Vec3::Z, u, Vec2::splat(0.5), Radiance).is_none()));
    }
}
