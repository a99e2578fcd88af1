//! Thin plates that act on polarisation alone: polarisers and retarders. Light goes straight through.
//!
//! ```text
//! linear polariser    M = T/2 vᵀv,  v = (1, cos2φ, sin2φ, 0)          passes the field along φ
//! circular polariser  M = T/2 vᵀv,  v = (1, 0, 0, ±1)                 passes right- (+) or left-circular light
//! retarder            M = R(−φ) (1 ⊕ 1 ⊕ (cosδ, sinδ; −sinδ, cosδ)) R(φ)   the field along φ is ahead by δ
//! ```
//!
//! with the part `T` of what the ideal polariser passes (Collett, *Field Guide to Polarization*, 2005; Goldstein,
//! *Polarized Light*, 6.43). Both axes, the one that passes and the fast one, lie in the plate at `θ` from ∂p/∂u about
//! the normal. Light at a slant sees them along its way: a polariser absorbs the field along its projected absorbing
//! axis (Korger et al., *The polarization properties of a tilted polarizer*, 2013), a retarder has the projected fast
//! axis and, as in Mitsuba 3, `δ` times the cosine, the same at all wavelengths. Unpolarised light loses half in a
//! polariser and nothing in a retarder.
//!
//! The axes are fixed to the plate, so that from behind `θ` is seen with the other sign. Mitsuba turns by `θ` about
//! the ray, from both sides alike, which no plate does.

use super::{
    Bsdf, BsdfEval, BsdfSample, Lobe, TransportMode,
    registry::{Case, GREY, Model, Recipe, Visitor, WHITE},
    scatter::Scatter,
};
use steradian_math::{
    Frame, Spectrum, Vec2, Vec3,
    polarization::{Mueller, basis},
};

/// A polariser or a retarder, the same from both sides.
#[derive(Clone, Copy, Debug)]
pub struct Filter {
    /// The part of unpolarised light that passes.
    transmittance: Spectrum,
    effect: Effect,
}

/// A filter's effect on polarisation. Axes are in the plane of the shading frame.
#[derive(Clone, Copy, Debug)]
enum Effect {
    /// Absorbs the field along an axis.
    Absorbs(Vec3),
    /// Passes right-circular (1) or left-circular (−1) light.
    Circular(f32),
    /// The field across the fast axis falls behind by an angle.
    Retards { fast: Vec3, by: f32 },
}

/// The axis in the plate at an angle in degrees from x towards y.
fn axis(degrees: f32) -> Vec3 {
    let (sin, cos) = angle(degrees).sin_cos();
    Vec3::new(cos, sin, 0.0)
}

/// An angle in radians; zero where a texture has none.
fn angle(degrees: f32) -> f32 {
    if degrees.is_finite() { (degrees % 360.0).to_radians() } else { 0.0 }
}

impl Filter {
    /// A linear polariser that passes light that swings along an axis, at `theta` degrees from `x`, with this part of
    /// it.
    pub fn linear(theta: f32, transmittance: Spectrum) -> Self {
        Self { transmittance: transmittance * 0.5, effect: Effect::Absorbs(axis(theta + 90.0)) }
    }

    /// A circular polariser that passes right- or left-circular light, with this part of it.
    pub fn circular(is_right: bool, transmittance: Spectrum) -> Self {
        let hand = if is_right { 1.0 } else { -1.0 };
        Self { transmittance: transmittance * 0.5, effect: Effect::Circular(hand) }
    }

    /// A retarder whose fast axis is at `theta` degrees from `x`, by `delta` degrees.
    pub fn retarder(theta: f32, delta: f32) -> Self {
        Self { transmittance: Spectrum::ONE, effect: Effect::Retards { fast: axis(theta), by: angle(delta) } }
    }

    /// The Mueller matrix of light that leaves towards `wo` (in the shading frame `frame`), relative to the part of
    /// unpolarised light that passes, in the frame of [`basis`] of that direction in the world.
    pub(crate) fn relative(&self, frame: &Frame, wo: Vec3) -> Mueller {
        let across = |axis: Vec3| (axis - wo * wo.dot(axis)).try_normalize().map(|a| frame.to_world(a));
        let k = frame.to_world(wo);
        let own = basis(k);
        let (reference, m) = match self.effect {
            Effect::Absorbs(axis) => (across(axis).map(|a| a.cross(k)), LINEAR),
            Effect::Circular(hand) => return circular(hand),
            Effect::Retards { fast, by } => (across(fast), Mueller::retarder(0.0, by * wo.z.abs())),
        };
        let bases = [reference.unwrap_or(own), own];
        m.in_bases(k, bases, k, bases)
    }
}

/// Twice the linear polariser along the reference.
const LINEAR: Mueller = {
    let (l, o) = (Spectrum::ONE, Spectrum::ZERO);
    Mueller([[l, l, o, o], [l, l, o, o], [o; 4], [o; 4]])
};

/// Twice the circular polariser.
fn circular(hand: f32) -> Mueller {
    let (l, h, o) = (Spectrum::ONE, Spectrum::splat(hand), Spectrum::ZERO);
    Mueller([[l, o, o, h], [o; 4], [o; 4], [h, o, o, l]])
}

impl Scatter for Filter {
    const MODELS: &'static [Model] = &[
        Model::new("polarizer", "a linear or circular polariser", polarizers),
        Model::new("retarder", "a plate that retards one polarisation", retarders),
    ];
    const RECIPES: &'static [Recipe] = &[
        Recipe::new("polarizer", |i| {
            let transmittance = i.colors[0];
            Bsdf::Filter(match i.choice {
                0 => Self::linear(i.numbers[0], transmittance),
                form => Self::circular(form == 1, transmittance),
            })
        })
        .anisotropic()
        .polarizing(),
        Recipe::new("retarder", |i| Bsdf::Filter(Self::retarder(i.numbers[0], i.numbers[1])))
            .anisotropic()
            .polarizing(),
    ];

    fn sample(&self, wo: Vec3, _: f32, _: Vec2, _: TransportMode) -> Option<BsdfSample> {
        let lobe = Lobe::TRANSMISSION.with(Lobe::SPECULAR);
        let passes = wo.z != 0.0 && !self.transmittance.is_black();
        passes.then(|| BsdfSample { wi: -wo, weight: self.transmittance, pdf: 1.0, lobe, eta: 1.0 })
    }

    fn albedo_estimate(&self, _: Vec3) -> Spectrum {
        self.transmittance
    }

    fn straight_transmission(&self, _: Vec3) -> Option<Spectrum> {
        Some(self.transmittance)
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

fn polarizers(visit: &mut Visitor<'_>) {
    let mut case = |label, filter| visit(Case { label, bsdf: Bsdf::Filter(filter), lossless: false });
    case("linear", Filter::linear(30.0, WHITE));
    case("linear, tinted", Filter::linear(90.0, GREY));
    case("right-circular", Filter::circular(true, WHITE));
    case("left-circular", Filter::circular(false, GREY));
}

fn retarders(visit: &mut Visitor<'_>) {
    let mut case = |label, filter| visit(Case { label, bsdf: Bsdf::Filter(filter), lossless: true });
    case("quarter wave", Filter::retarder(45.0, 90.0));
    case("half wave", Filter::retarder(0.0, 180.0));
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::polarization::Stokes;

    fn frames() -> [Frame; 2] {
        [Frame::from_z(Vec3::Z), Frame::from_zx(Vec3::new(0.48, -0.6, 0.64), Vec3::new(1.0, 2.0, 0.3))]
    }

    /// The Stokes vector behind filters that light meets one after the other, relative to x of the frame.
    fn behind(filters: &[Filter], frame: &Frame, wo: Vec3) -> [f32; 4] {
        let k = frame.to_world(wo);
        let light = filters
            .iter()
            .fold(Stokes::unpolarized(Spectrum::ONE), |s, f| f.relative(frame, wo).scaled(f.transmittance) * s);
        let x = (frame.x - k * k.dot(frame.x)).normalize();
        (Mueller::change_basis(k, basis(k), x) * light).0.map(|s| s[0])
    }

    fn is(found: [f32; 4], expected: [f32; 4]) {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 2e-6), "{found:?} is not {expected:?}");
    }

    #[test]
    fn a_linear_polariser_passes_its_axis() {
        for frame in frames() {
            for (theta, s1, s2) in [(0.0, 0.5, 0.0), (45.0, 0.0, 0.5), (90.0, -0.5, 0.0), (-45.0, 0.0, -0.5)] {
                let filter = Filter::linear(theta, WHITE);
                is(behind(&[filter], &frame, Vec3::Z), [0.5, s1, s2, 0.0]);
                // From behind the same axis lies on the other side of x.
                is(behind(&[filter], &frame, -Vec3::Z), [0.5, s1, -s2, 0.0]);
            }
        }
    }

    #[test]
    fn a_quarter_wave_plate_makes_left_circular_light_of_light_ahead_by_45_degrees() {
        for frame in frames() {
            // Goldstein, Polarized Light, 6.3: the fast axis along x, light along the diagonal.
            let plates = [Filter::linear(45.0, WHITE), Filter::retarder(0.0, 90.0)];
            is(behind(&plates, &frame, Vec3::Z), [0.5, 0.0, 0.0, -0.5]);
            let left = Filter::circular(false, WHITE);
            is(behind(&[plates[0], plates[1], left], &frame, Vec3::Z), [0.5, 0.0, 0.0, -0.5]);
            let right = Filter::circular(true, WHITE);
            is(behind(&[plates[0], plates[1], right], &frame, Vec3::Z), [0.0; 4]);
        }
    }

    /// At a slant it is the absorbing axis that is projected: crossed axes are no longer crossed for the ray, and a
    /// ray in the plane of one of them sees that one and the other as at normal incidence.
    #[test]
    fn tilted_polarisers_follow_the_absorbing_axis() {
        let crossed = [Filter::linear(45.0, WHITE), Filter::linear(-45.0, WHITE)];
        let cos = 0.6f32;
        let wo = Vec3::new(0.8, 0.0, cos);
        for frame in frames() {
            // Projected along (sin, 0, cos), the diagonals are (cos, ±1): at tan = 1/cos from x.
            let leak = behind(&crossed, &frame, wo)[0];
            let between = 2.0 * (1.0 / cos).atan();
            assert!((leak - 0.5 * between.cos().powi(2)).abs() < 2e-6, "{leak}");
            let straight = [Filter::linear(0.0, WHITE), Filter::linear(90.0, WHITE)];
            assert!(behind(&straight, &frame, wo)[0].abs() < 1e-6);
        }
    }

    #[test]
    fn angles_that_are_none_and_large_ones_are_no_harm() {
        let frame = frames()[1];
        for theta in [f32::NAN, f32::INFINITY, 3e30] {
            for filter in [Filter::linear(theta, WHITE), Filter::retarder(theta, theta)] {
                for wo in [Vec3::Z, Vec3::X, Vec3::Y, -Vec3::Z] {
                    assert!(behind(&[filter], &frame, Vec3::Z).iter().all(|v| v.is_finite()));
                    assert!(filter.relative(&frame, wo).0.iter().flatten().all(|v| v.is_finite()));
                }
            }
        }
    }
}
