//! Diffraction gratings, reflecting or transmitting, in spectral mode.
//!
//! With `w⊥` the components of a direction along the surface (direction cosines), grooves along `x` and a period `d`
//! across them, order `m` of light of the wavelength `λ` is where
//!
//! ```text
//! wi⊥ = −wo⊥ + m λ/d ŷ            conical mounting; Loewen, Popov, Diffraction Gratings and Applications (1997), 2.1
//! ```
//!
//! Orders of which that is longer than one are evanescent and carry nothing. Scattering of a rough grating blurs each
//! order by the same Gaussian in direction cosines (shift invariance: Harvey, *Light-scattering characteristics of
//! optical surfaces*, 1976), so that
//!
//! ```text
//! f = R Σ_m η_m K(wi⊥ + wo⊥ − m λ/d ŷ),     K(δ) = exp(−(δ_x/2α_x)² − (δ_y/2α_y)²)/(4π α_x α_y)
//! ```
//!
//! where `R` is Fresnel's factor of the metal at the half vector (of a transmitting grating the tint) and `η_m` the
//! efficiency of the [`Profile`], with the retardation `Γ = h/λ (cosθ_o + cosθ_i)` in reflection and
//! `h/2λ (√(n² − sin²θ_o) − cosθ_o + √(n² − sin²θ_i) − cosθ_i)` through a relief of index `n`; `h` is
//! the depth from top to bottom. A facet of slope `α` (Beckmann) mirrors into that `K` near the normal. The mirror is
//! the grating with the zeroth order alone.
//!
//! Energy: what falls to evanescent orders and to those beyond the largest is absorbed. Scalar theory, whose
//! retardation differs between orders, can give more than all light at grazing angles: `η_m` is divided by the larger
//! of its sums over the propagating orders of either direction where that exceeds one. Both directions are moved by
//! `δ/2` for that, to where the grating equation holds, which keeps `f` reciprocal and its albedo at most one for any
//! roughness.
//!
//! Not there: polarisation (Wood's anomalies), shadowing of grooves, coherence between places.

use super::{
    Bsdf, BsdfEval, BsdfSample, Conductor, Lobe, Microfacet, TransportMode,
    grating_profile::Profile,
    registry::{Case, Model, Visitor, gold},
    scatter::Scatter,
};
use std::{f32::consts::PI, ops::RangeInclusive};
use steradian_math::{
    Spectrum, Vec2, Vec3,
    elementary::{exp, ln, sin_cos_turns},
};

/// Exponent beyond which the Gaussian is left out; samples go to 17.
const FARTHEST: f32 = 18.0;
/// Added to the efficiency of an order for the probability of sampling its blur, in which it may be larger.
const SELDOM: f32 = 0.01;

/// Grooves: what a [`Grating`] is made of beside its material.
#[derive(Clone, Debug)]
pub struct Grooves {
    /// Distance of grooves in nm (> 0).
    pub period: f32,
    /// Their depth in nm, from top to bottom.
    pub depth: f32,
    /// Their shape.
    pub profile: Profile,
    /// The largest order.
    pub orders: u16,
    /// Index of refraction of the relief (≥ 1) of a grating that transmits; none of one that reflects.
    pub transmits: Option<f32>,
}

/// A surface with grooves along its tangent.
#[derive(Clone, Copy, Debug)]
pub struct Grating<'a> {
    metal: Conductor,
    grooves: &'a Grooves,
    /// `λ/d` of the lanes.
    shift: Spectrum,
    alpha: Vec2,
    /// Number of lanes that are followed: 4, or 1 for the hero alone.
    lanes: u8,
}

impl<'a> Grating<'a> {
    /// Grating of a metal, whose roughness `α` is that of the blur; wavelengths in nm. If `is_single`, or if the metal
    /// is smooth, directions are those of the first wavelength, which alone is right.
    pub fn new(metal: Conductor, grooves: &'a Grooves, lambda: [f32; 4], is_single: bool) -> Self {
        let lanes = if is_single || metal.microfacet.is_smooth() { 1 } else { 4 };
        let shift = Spectrum::new(lambda.map(|l| l / grooves.period));
        Self { metal, grooves, shift, alpha: metal.microfacet.alpha(), lanes }
    }

    /// By how many wavelengths of a lane the path over the depth differs, between directions of these cosines.
    fn retardation(&self, lane: usize, cos_o: f32, cos_i: f32) -> f32 {
        let path = match self.grooves.transmits {
            None => cos_o + cos_i,
            Some(n) => {
                let of = |cos: f32| (n * n - 1.0 + cos * cos).max(0.0).sqrt() - cos;
                0.5 * (of(cos_o) + of(cos_i))
            }
        };
        self.grooves.depth / (self.grooves.period * self.shift[lane]) * path
    }

    /// The orders whose centre has a component across the grooves within these bounds, as seen from `o`.
    fn orders(&self, lane: usize, o: Vec2, bound: f32) -> RangeInclusive<i32> {
        self.between(lane, o.y - bound, o.y + bound)
    }

    /// The orders `m` with `low ≤ m λ/d ≤ high`.
    fn between(&self, lane: usize, low: f32, high: f32) -> RangeInclusive<i32> {
        let most = i32::from(self.grooves.orders);
        let (low, high) = (low / self.shift[lane], high / self.shift[lane]);
        (low.ceil() as i32).max(-most)..=(high.floor() as i32).min(most)
    }

    /// Direction of an order.
    fn centre(&self, lane: usize, o: Vec2, order: i32) -> Vec2 {
        Vec2::new(-o.x, order as f32 * self.shift[lane] - o.y)
    }

    /// By scalar theory, between two directions.
    fn scalar(&self, lane: usize, order: i32, cos_o: f32, cos_i: f32) -> f32 {
        self.grooves.profile.efficiency(order, self.retardation(lane, cos_o, cos_i))
    }

    /// Total efficiency of all propagating orders from `o`, by scalar theory.
    fn sum(&self, lane: usize, o: Vec2) -> f32 {
        let Some(cos_o) = height(o) else { return 0.0 };
        let of = |m| height(self.centre(lane, o, m)).map(|cos_i| self.scalar(lane, m, cos_o, cos_i));
        self.orders(lane, o, 1.0).filter_map(of).sum()
    }

    /// The efficiency of an order between directions of which it is one; bounded so that all together are at most one.
    fn efficiency(&self, lane: usize, order: i32, o: Vec2, i: Vec2) -> f32 {
        let (Some(cos_o), Some(cos_i)) = (height(o), height(i)) else { return 0.0 };
        let scalar = self.scalar(lane, order, cos_o, cos_i);
        match &self.grooves.profile {
            Profile::Listed(_) => scalar,
            _ if scalar > 0.0 => scalar / self.sum(lane, o).max(self.sum(lane, i)).max(1.0),
            _ => 0.0,
        }
    }

    /// Unnormalised probability of sampling an order.
    fn frequency(&self, lane: usize, order: i32, o: Vec2) -> f32 {
        let Some(cos_o) = height(o) else { return 0.0 };
        let centre = self.centre(lane, o, order);
        let is_listed = matches!(self.grooves.profile, Profile::Listed(_));
        let floor = if is_listed || self.is_smooth() { 0.0 } else { SELDOM };
        match height(centre) {
            Some(cos_i) => self.scalar(lane, order, cos_o, cos_i) + floor,
            None if self.is_smooth() => 0.0,
            // Part of its blur may be above the horizon.
            None => self.scalar(lane, order, cos_o, 0.0) + floor,
        }
    }

    /// All orders of which at least the blur propagates.
    fn sampled(&self, lane: usize, o: Vec2) -> RangeInclusive<i32> {
        self.orders(lane, o, 1.0 + self.reach(self.alpha.y))
    }

    fn frequencies(&self, lane: usize, o: Vec2) -> f32 {
        self.sampled(lane, o).map(|m| self.frequency(lane, m, o)).sum()
    }

    fn is_smooth(&self) -> bool {
        self.metal.microfacet.is_smooth()
    }

    /// Radius of the blur for this roughness.
    fn reach(&self, alpha: f32) -> f32 {
        if self.is_smooth() { 0.0 } else { 2.0 * alpha * FARTHEST.sqrt() }
    }

    /// `f/R` of a lane, if it is wanted, and the density, both over projected solid angle.
    fn lane(&self, lane: usize, o: Vec2, i: Vec2, is_wanted: bool) -> (f32, f32) {
        let sum = o + i;
        let reach = self.reach(self.alpha.y);
        let orders = self.between(lane, sum.y - reach, sum.y + reach);
        if orders.is_empty() {
            return (0.0, 0.0);
        }
        let (mut value, mut frequency) = (0.0, 0.0);
        for m in orders {
            let delta = Vec2::new(sum.x, sum.y - m as f32 * self.shift[lane]);
            let exponent = (delta / (2.0 * self.alpha)).length_squared();
            if exponent > FARTHEST {
                continue;
            }
            let blur = exp(-exponent);
            if is_wanted {
                value += blur * self.efficiency(lane, m, o - 0.5 * delta, i - 0.5 * delta);
            }
            frequency += blur * self.frequency(lane, m, o);
        }
        let normalisation = 1.0 / (4.0 * PI * self.alpha.x * self.alpha.y);
        let all = if frequency > 0.0 { self.frequencies(lane, o) } else { 0.0 };
        (value * normalisation, if all > 0.0 { frequency / all * normalisation } else { 0.0 })
    }

    /// `f |cosθ_i|/R`, if it is wanted, and the density.
    fn blurred(&self, wo: Vec3, wi: Vec3, is_wanted: bool) -> BsdfEval {
        let is_across = wo.z * wi.z < 0.0;
        if !self.is_lit(wo) || wi.z == 0.0 || is_across != self.transmits() || self.is_smooth() {
            return BsdfEval::ZERO;
        }
        let (o, i) = (wo.truncate(), wi.truncate());
        if (o.x + i.x).abs() > self.reach(self.alpha.x) {
            return BsdfEval::ZERO;
        }
        let (mut values, mut pdf) = ([0.0; 4], 0.0);
        for (lane, value) in values.iter_mut().enumerate().take(usize::from(self.lanes)) {
            let (f, p) = self.lane(lane, o, i, is_wanted);
            *value = f;
            pdf += p;
        }
        let cosine = wi.z.abs();
        BsdfEval { value: Spectrum::new(values) * cosine, pdf: pdf / f32::from(self.lanes) * cosine }
    }

    /// The metal's factor.
    fn reflectance(&self, wo: Vec3, wi: Vec3) -> Spectrum {
        match self.grooves.transmits {
            None => self.metal.reflectance(0.5 + 0.5 * wo.dot(wi)),
            Some(_) => self.metal.tint,
        }
    }

    /// The direction of these components along the surface, on the side to which light from `wo` goes.
    fn raised(&self, i: Vec2, wo: Vec3) -> Option<Vec3> {
        let up = height(i)?;
        let sign = if self.grooves.transmits.is_some() { -wo.z.signum() } else { wo.z.signum() };
        Some(i.extend(sign * up))
    }

    fn lobe(&self, kind: Lobe) -> Lobe {
        let side = if self.grooves.transmits.is_some() { Lobe::TRANSMISSION } else { Lobe::REFLECTION };
        side.with(kind)
    }

    fn is_lit(&self, wo: Vec3) -> bool {
        wo.z > 0.0 || (wo.z < 0.0 && self.grooves.transmits.is_some())
    }
}

/// The cosine to the normal of a direction with these components along the surface; none where they are too long.
fn height(w: Vec2) -> Option<f32> {
    let cos2 = 1.0 - w.length_squared();
    (cos2 > 0.0).then(|| cos2.sqrt())
}

impl Scatter for Grating<'_> {
    const MODELS: &'static [Model] = &[Model::new("grating", "diffraction by grooves, smooth or rough", cases)];

    fn eval(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> BsdfEval {
        let BsdfEval { value, pdf } = self.blurred(wo, wi, true);
        BsdfEval { value: self.reflectance(wo, wi) * value, pdf }
    }

    fn pdf(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> f32 {
        self.blurred(wo, wi, false).pdf
    }

    fn sample(&self, wo: Vec3, u: f32, u2: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        if !self.is_lit(wo) {
            return None;
        }
        let o = wo.truncate();
        let scaled = u * f32::from(self.lanes);
        let lane = (scaled as usize).min(usize::from(self.lanes) - 1);
        let all = self.frequencies(lane, o);
        let mut left = (scaled - lane as f32) * all;
        let mut drawn = None;
        for m in self.sampled(lane, o) {
            let frequency = self.frequency(lane, m, o);
            if frequency > 0.0 {
                drawn = Some((m, frequency));
                left -= frequency;
                if left < 0.0 {
                    break;
                }
            }
        }
        let (order, frequency) = drawn?;
        let centre = self.centre(lane, o, order);
        if self.is_smooth() {
            let wi = self.raised(centre, wo)?;
            let pdf = frequency / all;
            let weight = self.reflectance(wo, wi) * (self.efficiency(lane, order, o, centre) / pdf);
            return Some(BsdfSample { wi, weight, pdf, lobe: self.lobe(Lobe::SPECULAR), eta: 1.0 });
        }
        let (sin, cos) = sin_cos_turns(u2.x);
        let radius = 2.0 * (-ln(1.0 - u2.y)).max(0.0).sqrt();
        let wi = self.raised(centre + radius * self.alpha * Vec2::new(cos, sin), wo)?;
        self.eval(wo, wi, mode).drawn(wi, self.lobe(Lobe::GLOSSY), 1.0)
    }

    fn albedo_estimate(&self, wo: Vec3) -> Spectrum {
        match self.grooves.transmits {
            None => self.metal.reflectance(wo.z * wo.z),
            Some(_) => self.metal.tint,
        }
    }

    fn is_specular(&self) -> bool {
        self.is_smooth()
    }

    fn transmits(&self) -> bool {
        self.grooves.transmits.is_some()
    }
}

/// Wavelengths of the cases, nm.
const LAMBDA: [f32; 4] = [550.0, 632.8, 435.8, 700.0];

fn cases(visit: &mut Visitor<'_>) {
    use Profile::{Blazed, Listed, Rectangular};
    let white = |x, y| Conductor::mirror(Spectrum::ONE, Microfacet::ggx(x, y));
    let (eta, k) = gold();
    let on_gold = |x, y| Conductor { eta, k, ..white(x, y) };
    let sine = || Profile::sinusoidal(10, 3.0);
    let cd = || Grooves { period: 1600.0, depth: 120.0, profile: sine(), orders: 10, transmits: None };
    let mut case = |label, metal, grooves: Grooves, is_single, lossless| {
        visit(Case { label, bsdf: Bsdf::Grating(Grating::new(metal, &grooves, LAMBDA, is_single)), lossless });
    };
    let listed = |efficiencies: &[f32]| Grooves { profile: Listed(efficiencies.to_vec()), ..cd() };
    case("smooth", white(0.0, 0.0), cd(), true, false);
    case("the zeroth order alone is a mirror", white(0.0, 0.0), listed(&[1.0]), true, true);
    case("gold, blurred", on_gold(0.05, 0.05), cd(), false, false);
    case("one wavelength, blurred more along", white(0.15, 0.05), cd(), true, false);
    let steps = Grooves { profile: Rectangular(0.3), period: 740.0, depth: 300.0, ..cd() };
    case("deep steps", white(0.1, 0.1), steps, true, false);
    case(
        "blazed, very rough",
        white(0.2, 0.3),
        Grooves { profile: Blazed, depth: 275.0, period: 800.0, ..cd() },
        true,
        false,
    );
    case("listed", white(0.06, 0.06), listed(&[0.3, 0.1, 0.6]), false, false);
    let through = |profile| Grooves { profile, transmits: Some(1.5), depth: 600.0, ..cd() };
    case("through a smooth sheet", white(0.0, 0.0), through(sine()), true, false);
    case("through a rough sheet", white(0.07, 0.1), through(Blazed), true, false);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scatter;

    fn cd(profile: Profile) -> Grooves {
        Grooves { period: 1600.0, depth: 120.0, profile, orders: 10, transmits: None }
    }

    fn mirror(alpha: f32) -> Conductor {
        Conductor::mirror(Spectrum::ONE, Microfacet::ggx(alpha, alpha))
    }

    /// All directions that a smooth grating sends light of a wavelength to, with their weight times probability.
    fn orders(grooves: &Grooves, lambda: f32, wo: Vec3) -> Vec<(Vec3, f32)> {
        let g = Grating::new(mirror(0.0), grooves, [lambda; 4], true);
        let mut found: Vec<(Vec3, f32)> = Vec::new();
        for k in 0..4000 {
            let u = (k as f32 + 0.5) / 4000.0;
            let Some(s) = g.sample(wo, u, Vec2::splat(0.5), TransportMode::Radiance) else { continue };
            if found.iter().all(|f| f.0 != s.wi) {
                found.push((s.wi, s.weight[0] * s.pdf));
            }
        }
        found.sort_by(|a, b| a.0.y.total_cmp(&b.0.y));
        found
    }

    fn from_degrees(across: f32, azimuth: f32) -> Vec3 {
        let ((sin, cos), (s, c)) = (across.to_radians().sin_cos(), azimuth.to_radians().sin_cos());
        Vec3::new(sin * s, sin * c, cos)
    }

    /// Angles worked out with a pocket calculator: `sin θ_m = m λ/d − sin θ`.
    #[test]
    fn orders_are_where_the_grating_equation_has_them() {
        let even = |lines: f32| Grooves { period: lines, ..cd(Profile::Listed(vec![0.14; 7])) };
        // A CD at normal incidence under a He–Ne laser: 0, ±23.30°, ±52.28°; the third order is evanescent.
        let angle = |w: Vec3| w.y.atan2(w.z).to_degrees();
        let of =
            |grooves: &Grooves, lambda, wo| orders(grooves, lambda, wo).into_iter().map(|o| o.0).collect::<Vec<_>>();
        for (period, lambda, incidence, expected) in [
            (1600.0, 632.8, 0.0, vec![-52.28, -23.30, 0.0, 23.30, 52.28]),
            (740.0, 532.0, 0.0, vec![-45.97, 0.0, 45.97]),
            (1600.0, 550.0, 30.0, vec![-57.54, -30.0, -8.99, 10.81, 32.09]),
            // Littrow: the first order comes back along λ/2d = sin 21.1832°.
            (740.0, 534.8, 21.1832, vec![-21.1832, 21.1832]),
        ] {
            let grooves = even(period);
            let found = of(&grooves, lambda, from_degrees(incidence, 0.0));
            assert_eq!(found.len(), expected.len(), "{period} nm, {lambda} nm, {incidence}°: {found:?}");
            for (w, expected) in found.into_iter().zip(expected) {
                assert!(
                    (angle(w) - expected).abs() < 0.006,
                    "{period} nm, {lambda} nm: {}° is not {expected}°",
                    angle(w)
                );
                assert!(w.x.abs() < 1e-7);
            }
        }
        // Conical: 40° from the normal, 60° from the plane across the grooves. sin 40° = 0.642788: along −0.556671,
        // across −0.321394 + m 500/1600, of which the cosine is √(1 − 0.309882 − β²).
        let found = of(&even(1600.0), 500.0, from_degrees(40.0, 60.0));
        let expected = [
            (-0.633_894, 0.536_933),
            (-0.321_394, 0.766_044),
            (-0.008_894, 0.830_686),
            (0.303_606, 0.773_267),
            (0.616_106, 0.557_253),
        ];
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (w, (across, up)) in found.into_iter().zip(expected) {
            assert!((w - Vec3::new(-0.556671, across, up)).length() < 3e-6, "{w} is not at {across}, {up}");
        }
    }

    /// At normal incidence and small angles the efficiencies are the squares of Bessel functions in print: a
    /// retardation of 2/π gives `J_m²(2)` = 0.0501, 0.3326, 0.1245, 0.0166 (Abramowitz, Stegun, table 9.1); all orders
    /// have all light.
    #[test]
    fn a_sine_of_wide_period_has_the_efficiencies_of_tables() {
        let (lambda, period) = (500.0, 200_000.0);
        let depth = lambda / PI;
        let found = orders(&Grooves { period, depth, ..cd(Profile::sinusoidal(10, 1.0)) }, lambda, Vec3::Z);
        let middle = found.len() / 2;
        for (m, j) in [0.223_890_78, 0.576_724_8, 0.352_834_03, 0.128_943_25].into_iter().enumerate() {
            for k in [middle - m, middle + m] {
                assert!((found[k].1 - j * j).abs() < 1e-4, "order {m}: {} is not {}", found[k].1, j * j);
            }
        }
        let all: f32 = found.iter().map(|f| f.1).sum();
        assert!((all - 1.0).abs() < 1e-3, "{all}");
    }

    /// In Littrow's mounting a blazed grating with `2 h cos θ = λ` throws all light back to where it comes from.
    #[test]
    fn a_blaze_sends_all_light_into_its_order() {
        let (lambda, period) = (500.0f32, 20_000.0);
        let theta = (lambda / (2.0 * period)).asin();
        let grooves = Grooves { period, depth: lambda / (2.0 * theta.cos()), ..cd(Profile::Blazed) };
        let wo = Vec3::new(0.0, theta.sin(), theta.cos());
        let found = orders(&grooves, lambda, wo);
        let (wi, strongest) = found.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).expect("orders");
        assert!((wi - wo).length() < 1e-5 && strongest > 0.999, "{wi}, {strongest}");
    }

    /// The blur gets narrower, and each lane's light is about its own order's centre.
    #[test]
    fn each_wavelength_has_its_own_centre() {
        let grooves = cd(Profile::Listed(vec![0.0, 0.0, 1.0]));
        let lambda = [450.0, 500.0, 600.0, 680.0];
        let g = Grating::new(mirror(0.004), &grooves, lambda, false);
        for (lane, l) in lambda.into_iter().enumerate() {
            let across = l / 1600.0;
            let value = g
                .eval(Vec3::Z, Vec3::new(0.0, across, (1.0f32 - across * across).sqrt()), TransportMode::Radiance)
                .value;
            let peak = (1.0 - across * across).sqrt() / (4.0 * PI * 0.004 * 0.004);
            for other in 0..4 {
                let expected = if other == lane { peak } else { 0.0 };
                assert!((value[other] - expected).abs() < 1e-3 * peak, "{l} nm: {value:?}");
            }
        }
    }
}
