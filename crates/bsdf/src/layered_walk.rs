//! The closed form of [`Coated`] against a simulation: light is followed through the interface, the absorbing coat and
//! the diffuse base, interface by interface, as pbrt-v4's layered materials define it.

use super::{
    Bsdf, CoatSeries, CoatTable, Coated, Dielectric, Diffuse, Microfacet, NormalDistribution, Shadowing, TransportMode,
};
use crate::Scatter;
use steradian_math::{Spectrum, Vec2, Vec3, hash::HashRng};
use steradian_testkit::{Moments, SphereGrid, sidak, z_test};

/// Equal bands of the upper hemisphere in `cosθ`.
const BANDS: usize = 8;
const PATHS: usize = 100_000;

struct Layers {
    interface: Dielectric,
    base: Diffuse,
    thickness: f32,
    max_depth: u32,
}

impl Layers {
    /// Direction in which light from `wo` that entered the coat leaves it, and the part that is left.
    fn walk(&self, wo: Vec3, rng: &mut HashRng) -> Option<(Vec3, f32)> {
        let mode = TransportMode::Importance;
        let (interface, base) = (Bsdf::Dielectric(self.interface), Bsdf::Diffuse(self.base));
        let mut draw = || (rng.next_f32(), Vec2::new(rng.next_f32(), rng.next_f32()));
        // Refract into the coat; what the interface reflects is its own lobe and not followed.
        let (u, u2) = draw();
        let entered = interface.sample(wo, u, u2, mode).filter(|s| s.lobe.is_transmission())?;
        let (mut w, mut weight) = (entered.wi, entered.weight[0]);
        for depth in 0..self.max_depth {
            // Beer–Lambert attenuation over the slanted way through the coat.
            weight *= (-self.thickness / w.z.abs()).exp();
            let (u, u2) = draw();
            // Base and interface take turns, until the interface lets the light out or the depth is reached.
            let s = if depth % 2 == 0 { base.sample(-w, u, u2, mode) } else { interface.sample(-w, u, u2, mode) }?;
            weight *= s.weight[0];
            w = s.wi;
            if s.lobe.is_transmission() {
                return Some((w, weight));
            }
        }
        None
    }

    /// Mean energy that leaves into each band.
    fn bands(&self, wo: Vec3, seed: u64) -> [Moments; BANDS] {
        let mut rng = HashRng::new(seed);
        let mut bands = [Moments::default(); BANDS];
        // Bin the energy of each walk by the cosine at which it leaves.
        for _ in 0..PATHS {
            let left = self.walk(wo, &mut rng);
            for (i, m) in bands.iter_mut().enumerate() {
                let here = left.filter(|(w, _)| ((w.z * BANDS as f32) as usize).min(BANDS - 1) == i);
                m.push(here.map_or(0.0, |(_, weight)| f64::from(weight)));
            }
        }
        bands
    }
}

/// Asserts that the diffuse part of the coat is what the walk finds, within chance and 0.3 %.
fn compare(
    distribution: NormalDistribution,
    shadowing: Shadowing,
    eta: f32,
    alpha: f32,
    rho: f32,
    thickness: f32,
    max_depth: u32,
) {
    let microfacet = Microfacet::new(distribution, shadowing, alpha, alpha);
    let layers = Layers {
        interface: Dielectric::new(eta, microfacet),
        base: Diffuse { reflectance: Spectrum::splat(rho) },
        thickness,
        max_depth,
    };
    let series = CoatSeries::Layered { thickness, max_depth };
    // Tabulate this roughness alone: both ends of the range are the same.
    let table = CoatTable::new(distribution, shadowing, eta, (alpha, alpha), series);
    // Without its tint the interface reflects nothing and only the base is seen.
    let coated = Bsdf::Coated(Coated::new(&table, Spectrum::splat(rho), Spectrum::ZERO, alpha, alpha));
    let grid = SphereGrid { bands: 2 * BANDS, sectors: 1 };
    for cos in [0.95f32, 0.5, 0.15] {
        let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
        let walked = layers.bands(wo, u64::from(cos.to_bits()));
        // Integrate the closed form over the same bands; z-test each against the mean of the walks.
        let integral = grid.integrate(|wi| f64::from(coated.eval(wo, wi, TransportMode::Radiance).value[0]), 1e-7);
        for (i, m) in walked.iter().enumerate() {
            let closed = integral[BANDS + i];
            let p = z_test(m, closed, 3e-3 * closed);
            assert!(
                p > sidak(0.01, 300),
                "{distribution:?} {alpha}, η {eta}, ρ {rho}, cosθ_o {cos}, band {i}: {closed} but walked {} ± {}",
                m.mean(),
                m.standard_error()
            );
        }
    }
}

use NormalDistribution::{Beckmann, Ggx};
use Shadowing::{HeightCorrelated, Separable};

#[test]
fn smooth_coats_are_the_limit_of_the_walk() {
    compare(Ggx, HeightCorrelated, 1.5, 0.0, 0.5, 0.01, 10);
    compare(Ggx, HeightCorrelated, 1.5, 0.0, 0.95, 0.2, u32::MAX);
    compare(Ggx, HeightCorrelated, 1.33, 0.0, 0.9, 0.0, 6);
    compare(Ggx, HeightCorrelated, 1.8, 0.0, 1.0, 0.0, 2);
}

#[test]
fn rough_coats_are_the_limit_of_the_walk() {
    compare(Ggx, HeightCorrelated, 1.5, 0.1, 0.8, 0.01, 10);
    compare(Ggx, HeightCorrelated, 1.5, 0.5, 0.8, 0.01, 10);
    compare(Beckmann, Separable, 1.49, 0.3, 0.6, 0.05, 100);
}

#[test]
fn smooth_plastic_is_fresnel_in_fresnel_out() {
    // f = ρ/(1 − F_dr) (1 − F_o)(1 − F_i)/(π η²), with F_dr of the fit: 0.5, 1.49 at 60° and 30°.
    let series = CoatSeries::Plastic { nonlinear: false };
    let table = CoatTable::new(Beckmann, Separable, 1.49, (0.0, 0.0), series);
    let coated = Bsdf::Coated(Coated::new(&table, Spectrum::splat(0.5), Spectrum::ONE, 0.0, 0.0));
    let at = |degrees: f32| {
        let (s, c) = degrees.to_radians().sin_cos();
        Vec3::new(s, 0.0, c)
    };
    let f = |c: f32| super::fresnel::dielectric(c, 1.49);
    let (wo, wi) = (at(60.0), at(30.0));
    let inside = super::fresnel::dielectric_diffuse_fit(1.0 / 1.49);
    let expected =
        0.5 / (1.0 - inside) * (1.0 - f(wo.z)) * (1.0 - f(wi.z)) / (1.49 * 1.49) * wi.z / std::f32::consts::PI;
    let e = coated.eval(wo, wi, TransportMode::Radiance);
    assert!((e.value[0] - expected).abs() < 1e-6, "{} is not {expected}", e.value[0]);
}

#[test]
fn textured_roughness_interpolates_the_rows() {
    let series = CoatSeries::Layered { thickness: 0.01, max_depth: 10 };
    let ranged = CoatTable::new(Ggx, HeightCorrelated, 1.5, (0.0, 0.8), series);
    for alpha in [0.0, 0.02, 0.15, 0.5, 0.8] {
        // One table interpolates over roughness, the other has exactly this one.
        let exact = CoatTable::new(Ggx, HeightCorrelated, 1.5, (alpha, alpha), series);
        let value = |t| Coated::new(t, Spectrum::splat(0.7), Spectrum::ZERO, alpha, alpha);
        let (a, b) = (value(&ranged), value(&exact));
        for (zo, zi) in [(0.9, 0.8), (0.5, 0.9), (0.3, 0.3), (0.1, 0.7)] {
            let w = |z: f32, s: f32| Vec3::new(s * (1.0 - z * z).sqrt(), 0.0, z);
            let (fa, fb) = (
                a.eval(w(zo, 1.0), w(zi, -1.0), TransportMode::Radiance).value[0],
                b.eval(w(zo, 1.0), w(zi, -1.0), TransportMode::Radiance).value[0],
            );
            assert!((fa - fb).abs() < 0.01 * fb, "roughness {alpha}: {fa} is not {fb}");
        }
    }
}
