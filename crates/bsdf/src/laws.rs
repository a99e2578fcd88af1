//! The laws of scattering, checked on every registered model, and broken models that show that the checks bite.

use super::{Bsdf, BsdfEval, BsdfSample, Model, TransportMode, VARIANTS, models, registry::GREY};
use rayon::prelude::*;
use steradian_math::{
    Spectrum, Vec2, Vec3,
    hash::{HashRng, ONE_MINUS_EPSILON},
};
use steradian_testkit::{Moments, SphereGrid, chi2_test_within, normal_two_sided_p, sidak, z_test};

use TransportMode::{Importance, Radiance};

/// Subject of the laws: a BSDF, or a broken one.
trait Scatterer {
    fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfEval;
    fn sample(&self, wo: Vec3, u: f32, u2: Vec2, mode: TransportMode) -> Option<BsdfSample>;
    fn pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> f32 {
        self.eval(wo, wi, mode).pdf
    }
    fn is_stochastic(&self) -> bool {
        false
    }
    fn albedo_bound(&self) -> f32 {
        1.0
    }
}

impl Scatterer for Bsdf<'_> {
    fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfEval {
        self.eval(wo, wi, mode)
    }
    fn sample(&self, wo: Vec3, u: f32, u2: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        self.sample(wo, u, u2, mode)
    }
    fn pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> f32 {
        self.pdf(wo, wi, mode)
    }
    fn is_stochastic(&self) -> bool {
        self.is_stochastic()
    }
    fn albedo_bound(&self) -> f32 {
        self.albedo_bound()
    }
}

/// All tests of one run share this chance of failing by accident.
const ALPHA: f64 = 0.01;
/// Upper bound on the number of statistical tests in this file.
const TESTS: usize = 20_000;
/// Samples of one test here; [`a_million_samples_follow_the_density`] has more.
const SAMPLES: usize = 30_000;
/// Part of a million samples by which the quadrature of a density may be off; that many would find it wanting.
const QUADRATURE: f64 = 2e-4;
const GRID: SphereGrid = SphereGrid { bands: 20, sectors: 40 };

fn uniforms(rng: &mut HashRng) -> (f32, Vec2) {
    (rng.next_f32(), Vec2::new(rng.next_f32(), rng.next_f32()))
}

fn direction(cos: f32, phi: f32) -> Vec3 {
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    Vec3::new(sin * phi.cos(), sin * phi.sin(), cos)
}

fn random_direction(rng: &mut HashRng) -> Vec3 {
    direction(2.0 * rng.next_f32() - 1.0, std::f32::consts::TAU * rng.next_f32())
}

/// Directions that a model is looked at from.
fn outgoing(transmits: bool) -> Vec<Vec3> {
    let mut w = vec![Vec3::Z, direction(0.8, 0.4), direction(0.35, 2.0), direction(0.08, -1.0)];
    if transmits {
        w.extend([direction(-0.9, 1.0), direction(-0.4, -2.5), -Vec3::Z]);
    }
    w
}

fn p_must_exceed(p: f64, what: &str) -> Result<(), String> {
    if p > sidak(ALPHA, TESTS) { Ok(()) } else { Err(format!("{what}: p = {p:.2e}")) }
}

/// Samples follow the density, nothing is drawn where the density is zero, and what the density lacks to one is drawn
/// from specular lobes (with the probability they state) or rejected.
fn samples_follow_pdf(s: &impl Scatterer, wo: Vec3, samples: usize, seed: u64) -> Result<(), String> {
    let mut rng = HashRng::new(seed);
    let mut histogram = vec![0u64; GRID.cells()];
    let mut specular: Vec<(Vec3, f64, u64)> = Vec::new();
    for _ in 0..samples {
        let (u, u2) = uniforms(&mut rng);
        let Some(b) = s.sample(wo, u, u2, Radiance) else { continue };
        if !b.lobe.is_specular() {
            histogram[GRID.cell(b.wi)] += 1;
        } else if let Some(seen) = specular.iter_mut().find(|l| l.0 == b.wi) {
            seen.2 += 1;
        } else {
            specular.push((b.wi, f64::from(b.pdf), 1));
        }
    }
    for (wi, p, seen) in specular {
        let (n, seen) = (samples as f64, seen as f64);
        let deviation = (n * p * (1.0 - p)).sqrt();
        let z = if deviation > 1e-3 { (seen - n * p) / deviation } else { seen - n * p };
        p_must_exceed(normal_two_sided_p(z), &format!("specular lobe to {wi} of probability {p} drawn {seen} times"))?;
    }
    let expected = GRID.expected_counts(|wi| f64::from(s.pdf(wo, wi, Radiance)), &histogram, samples as u64);
    let quadrature = if samples > SAMPLES { QUADRATURE } else { 0.0 };
    let chi2 = chi2_test_within(&histogram, &expected, samples as u64, quadrature);
    let integral = expected.iter().sum::<f64>() / samples as f64;
    p_must_exceed(chi2.p_value, &format!("χ² from {wo}, {chi2:?}, ∫pdf = {integral}"))
}

/// A sample carries what `eval` says: the same density, and `weight = value/pdf`.
fn weight_is_value_over_pdf(s: &impl Scatterer, wo: Vec3, seed: u64) -> Result<(), String> {
    let mut rng = HashRng::new(seed);
    for mode in [Radiance, Importance] {
        for _ in 0..500 {
            let (u, u2) = uniforms(&mut rng);
            let Some(b) = s.sample(wo, u, u2, mode) else { continue };
            if !b.pdf.is_finite() || b.pdf <= 0.0 || !b.weight.is_finite() || !b.eta.is_finite() {
                return Err(format!("{b:?} from {wo}"));
            }
            if (b.wi.length() - 1.0).abs() > 1e-4 {
                return Err(format!("wi = {} has length {}", b.wi, b.wi.length()));
            }
            if (b.wi.z * wo.z < 0.0) != b.lobe.is_transmission() {
                return Err(format!("{b:?} from {wo} is on the wrong side"));
            }
            let e = s.eval(wo, b.wi, mode);
            if b.lobe.is_specular() {
                continue;
            }
            let close = |a: f32, b: f32| (a - b).abs() <= 2e-3 * a.abs().max(b.abs()) + 1e-7;
            let weighted = b.weight * b.pdf;
            if !close(e.pdf, s.pdf(wo, b.wi, mode))
                || !close(e.pdf, b.pdf)
                || (0..4).any(|i| !close(weighted[i], e.value[i]))
            {
                return Err(format!("{b:?} but {e:?} from {wo}"));
            }
        }
    }
    Ok(())
}

/// Runs a comparison of `f` over pairs of directions of which half are near the lobes; not for values that agree in the
/// mean only, for which see the tests of `layered`.
fn over_pairs(
    s: &impl Scatterer,
    seed: u64,
    compare: impl Fn(Vec3, Vec3, &dyn Fn(Vec3, Vec3, TransportMode) -> Spectrum) -> Result<(), String>,
) -> Result<(), String> {
    if s.is_stochastic() {
        return Ok(());
    }
    let mut rng = HashRng::new(seed);
    let f = |wo: Vec3, wi: Vec3, mode| s.eval(wo, wi, mode).value / wi.z.abs();
    for _ in 0..500 {
        let wo = random_direction(&mut rng);
        let wi = if rng.next_f32() < 0.5 {
            random_direction(&mut rng)
        } else {
            // Where it matters: near the lobes.
            let (u, u2) = uniforms(&mut rng);
            match s.sample(wo, u, u2, Radiance) {
                Some(b) => b.wi,
                None => continue,
            }
        };
        if wo.z.abs() < 1e-3 || wi.z.abs() < 1e-3 {
            continue;
        }
        compare(wo, wi, &f)?;
    }
    Ok(())
}

fn close(a: Spectrum, b: Spectrum) -> bool {
    (0..4).all(|i| (a[i] - b[i]).abs() <= 5e-3 * a[i].abs().max(b[i].abs()) + 1e-6)
}

/// `f_importance(wo, wi) = f_radiance(wi, wo)` for every model (Veach 1997, 5.3): paths from both ends find the same
/// light.
fn is_adjoint(s: &impl Scatterer, seed: u64) -> Result<(), String> {
    over_pairs(s, seed, |wo, wi, f| {
        let agree = close(f(wo, wi, Importance), f(wi, wo, Radiance));
        if agree { Ok(()) } else { Err(format!("importance from {wo} to {wi} is not radiance backwards")) }
    })
}

/// `f(wo, wi) = f(wi, wo)` on one side, and `f(wo, wi) η_i² = f(wi, wo) η_o²` for radiance through an interface. `eta`
/// is the index below relative to above.
fn is_reciprocal(s: &impl Scatterer, eta: f32, seed: u64) -> Result<(), String> {
    over_pairs(s, seed, |wo, wi, f| {
        let index2 = |w: Vec3| if w.z < 0.0 { eta * eta } else { 1.0 };
        let agree = close(f(wo, wi, Radiance) * index2(wi), f(wi, wo, Radiance) * index2(wo));
        if agree { Ok(()) } else { Err(format!("f({wo}, {wi}) = {:?} is not f({wi}, {wo})", f(wo, wi, Radiance))) }
    })
}

/// Fraction of light scattered: the sampled mean of the weights (compression of radiance taken out), lane by lane.
fn sampled_albedo(s: &impl Scatterer, wo: Vec3, seed: u64) -> ([Moments; 4], Moments) {
    let mut rng = HashRng::new(seed);
    let mut all = [Moments::default(); 4];
    let mut scattered = Moments::default();
    for _ in 0..SAMPLES {
        let (u, u2) = uniforms(&mut rng);
        let b = s.sample(wo, u, u2, Radiance);
        let weight = b.map_or(Spectrum::ZERO, |b| b.weight * (b.eta * b.eta));
        for (m, w) in all.iter_mut().zip(weight.to_array()) {
            m.push(f64::from(w));
        }
        let rough = b.filter(|b| !b.lobe.is_specular());
        scattered.push(rough.map_or(0.0, |b| f64::from(b.weight[0])));
    }
    (all, scattered)
}

/// No more light leaves than arrives; exactly as much if `lossless`; and the sampled lobes carry what quadrature of
/// `eval` says they do, lobes that are never sampled included.
fn energy_is_conserved(s: &impl Scatterer, wo: Vec3, lossless: bool, seed: u64) -> Result<(), String> {
    let (albedo, scattered) = sampled_albedo(s, wo, seed);
    nothing_is_gained(s, &albedo, wo, lossless)?;
    if s.is_stochastic() {
        return uniform_samples_find_as_much(s, wo, &scattered, seed);
    }
    sampled_albedo_is_the_integral(s, wo, &scattered)
}

fn nothing_is_gained(s: &impl Scatterer, albedo: &[Moments; 4], wo: Vec3, lossless: bool) -> Result<(), String> {
    for m in albedo {
        if m.mean() > f64::from(s.albedo_bound()) + 1e-4 + 3.0 * m.standard_error() {
            return Err(format!("albedo {} ± {} from {wo}", m.mean(), m.standard_error()));
        }
        if lossless {
            p_must_exceed(
                z_test(m, 1.0, 1e-3),
                &format!("white furnace: {} ± {} from {wo}", m.mean(), m.standard_error()),
            )?;
        }
    }
    Ok(())
}

/// The sampled lobes carry what quadrature of `eval` says.
fn sampled_albedo_is_the_integral(s: &impl Scatterer, wo: Vec3, scattered: &Moments) -> Result<(), String> {
    let integral: f64 = GRID.integrate(|wi| f64::from(s.eval(wo, wi, Radiance).value[0]), 1e-5).iter().sum();
    let what = format!(
        "sampled albedo {} ± {} is not ∫ f cos = {integral} from {wo}",
        scattered.mean(),
        scattered.standard_error()
    );
    p_must_exceed(z_test(scattered, integral, 2e-4), &what)
}

/// As the quadrature of `energy_is_conserved`, for values that are noisy: directions spread evenly find as much light.
fn uniform_samples_find_as_much(s: &impl Scatterer, wo: Vec3, scattered: &Moments, seed: u64) -> Result<(), String> {
    let mut rng = HashRng::new(seed ^ 0x5eed);
    let mut even = Moments::default();
    for _ in 0..SAMPLES {
        let wi = random_direction(&mut rng);
        even.push(4.0 * std::f64::consts::PI * f64::from(s.eval(wo, wi, Radiance).value[0]));
    }
    let error = scattered.standard_error().hypot(even.standard_error()).max(1e-9);
    let z = (scattered.mean() - even.mean()) / error;
    let what = format!("sampled albedo {} but spread evenly {} ± {error} from {wo}", scattered.mean(), even.mean());
    p_must_exceed(normal_two_sided_p(z), &what)
}

/// Values at the edges of the sample space and of the hemisphere are finite, not negative, and of the right side.
fn edges_are_finite(s: &impl Scatterer) -> Result<(), String> {
    let edge = [0.0, f32::MIN_POSITIVE, 1e-7, 0.25, 0.5, 0.75, 1.0 - 1e-6, ONE_MINUS_EPSILON];
    let cosines = [1.0, 0.5, 1e-3, 1.745e-4, 1e-6, 1e-20, 0.0, -0.0, -1e-20, -1e-4, -0.5, -1.0];
    let around = cosines.iter().flat_map(|&c| [0.0, 1.0, 4.0].map(|phi| direction(c, phi)));
    let fine = |v: Spectrum| v.is_finite() && v.to_array().iter().all(|&x| x >= 0.0);
    for wo in around.clone() {
        for wi in around.clone() {
            for mode in [Radiance, Importance] {
                let e = s.eval(wo, wi, mode);
                if !fine(e.value) || !e.pdf.is_finite() || e.pdf < 0.0 {
                    return Err(format!("{e:?} from {wo} to {wi}"));
                }
            }
        }
        for (&u, &x) in edge.iter().flat_map(|u| edge.iter().map(move |x| (u, x))) {
            for &y in &edge {
                let Some(b) = s.sample(wo, u, Vec2::new(x, y), Radiance) else { continue };
                if !fine(b.weight) || !b.pdf.is_finite() || b.pdf <= 0.0 || (b.wi.length() - 1.0).abs() > 1e-3 {
                    return Err(format!("{b:?} from {wo} at ({u}, {x}, {y})"));
                }
            }
        }
    }
    Ok(())
}

/// Runs a law on every case of every model and reports all that break it.
fn for_every_case(law: impl Fn(&Bsdf<'_>, bool, u64) -> Result<(), String> + Sync) {
    for_cases_of(|_| true, law);
}

/// Runs a law on every case of the models that pass, one model beside another.
fn for_cases_of(
    passes: impl Fn(&Model) -> bool + Sync,
    law: impl Fn(&Bsdf<'_>, bool, u64) -> Result<(), String> + Sync,
) {
    let broken = |(i, model): (usize, &Model)| {
        let (mut count, mut failures) = (0, Vec::new());
        (model.cases)(&mut |case| {
            count += 1;
            if let Err(e) = law(&case.bsdf, case.lossless, (i * 1000 + count) as u64) {
                failures.push(format!("{} ({}): {e}", model.name, case.label));
            }
        });
        assert!(count > 0, "{} has no cases", model.name);
        failures
    };
    let all: Vec<&Model> = models().collect();
    let models = all.into_par_iter().enumerate().with_max_len(1).filter(|(_, m)| passes(m));
    let failures: Vec<String> = models.flat_map_iter(broken).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn every_model_draws_what_its_density_says() {
    for_every_case(|b, _, seed| {
        outgoing(b.has_transmission()).into_iter().try_for_each(|wo| samples_follow_pdf(b, wo, SAMPLES, seed))
    });
}

/// Samples against densities with a million samples each, which takes four minutes on two cores:
/// `cargo test -p steradian-bsdf --lib a_million -- --ignored`.
#[test]
#[ignore = "takes minutes"]
fn a_million_samples_follow_the_density() {
    let law = |b: &Bsdf<'_>, _: bool, seed: u64| {
        let broken = |wo| samples_follow_pdf(b, wo, 1_000_000, seed).err();
        let broken: Vec<String> = outgoing(b.has_transmission()).into_iter().filter_map(broken).collect();
        if broken.is_empty() { Ok(()) } else { Err(broken.join("; ")) }
    };
    for_every_case(law);
}

/// A new kind of scattering does not come in without cases.
#[test]
fn every_kind_of_value_has_cases() {
    let mut seen = std::collections::BTreeSet::new();
    for model in models() {
        (model.cases)(&mut |case| _ = seen.insert(format!("{:?}", case.bsdf).split('(').next().unwrap().to_owned()));
    }
    assert!(VARIANTS.iter().all(|v| seen.contains(*v)), "{VARIANTS:?} but {seen:?}");
}

#[test]
fn every_model_weighs_samples_by_value_over_density() {
    for_every_case(|b, _, seed| {
        outgoing(b.has_transmission()).into_iter().try_for_each(|wo| weight_is_value_over_pdf(b, wo, seed))
    });
}

#[test]
fn every_model_is_reciprocal_but_those_that_say_they_are_not() {
    for_cases_of(|m| m.is_reciprocal, |b, _, seed| is_reciprocal(b, b.relative_eta(), seed));
    for_cases_of(
        |m| !m.is_reciprocal,
        |b, _, seed| match is_reciprocal(b, b.relative_eta(), seed) {
            Ok(()) => Err("is reciprocal after all".into()),
            Err(_) => Ok(()),
        },
    );
}

#[test]
fn every_model_carries_importance_as_it_does_radiance_backwards() {
    for_every_case(|b, _, seed| is_adjoint(b, seed));
}

#[test]
fn every_model_conserves_energy_but_those_that_say_they_do_not() {
    for_cases_of(
        |m| m.conserves,
        |b, lossless, seed| {
            outgoing(b.has_transmission()).into_iter().try_for_each(|wo| energy_is_conserved(b, wo, lossless, seed))
        },
    );
    // At 89.99° lobes are too narrow for the quadrature.
    for_cases_of(
        |m| m.conserves,
        |b, lossless, seed| {
            let wo = direction(89.99f32.to_radians().cos(), 0.7);
            nothing_is_gained(b, &sampled_albedo(b, wo, seed).0, wo, lossless)
        },
    );
    let gains = std::sync::Mutex::new(Vec::new());
    for_cases_of(
        |m| !m.conserves,
        |b, _, seed| {
            let wos = outgoing(false).into_iter().chain([direction(0.02, 1.0)]);
            let mut gain = false;
            for wo in wos {
                let (albedo, scattered) = sampled_albedo(b, wo, seed);
                sampled_albedo_is_the_integral(b, wo, &scattered)?;
                gain |= albedo.iter().any(|m| m.mean() > 1.01 + 4.0 * m.standard_error());
            }
            let (albedo, _) = sampled_albedo(b, direction(89.99f32.to_radians().cos(), 0.7), seed);
            gain |= albedo.iter().any(|m| m.mean() > 1.01 + 4.0 * m.standard_error());
            gains.lock().expect("no test panicked").push(gain);
            Ok(())
        },
    );
    let gains = gains.into_inner().expect("no test panicked");
    assert!(gains.iter().all(|&g| g), "a model that is listed as gaining energy does not: {gains:?}");
}

/// M98: turned about its normal, a surface stays as it is unless it is stretched.
#[test]
fn only_stretched_surfaces_change_when_turned() {
    use super::{Conductor, Microfacet, OrenNayar, OrenNayarForm, Phong, Ward, WardForm};
    let (black, white) = (Spectrum::ZERO, Spectrum::ONE);
    let metal = |x, y| Bsdf::Conductor(Conductor::mirror(white, Microfacet::ggx(x, y)));
    let ward = |x, y| Bsdf::Ward(Ward::new(black, white, x, y, WardForm::Bounded));
    for (label, b, stretched) in [
        ("metal", metal(0.3, 0.3), false),
        ("brushed metal", metal(0.1, 0.4), true),
        ("Ward", ward(0.2, 0.2), false),
        ("Ward, stretched", ward(0.1, 0.3), true),
        ("Phong", Bsdf::Phong(Phong::modified(black, white, 12.0)), false),
        ("clay", Bsdf::OrenNayar(OrenNayar::new(GREY, 0.5, OrenNayarForm::Full)), false),
    ] {
        let mut rng = HashRng::new(3);
        let mut changed = 0.0f32;
        for _ in 0..200 {
            let (o, i) = (0.1 + 0.9 * rng.next_f32(), 0.1 + 0.9 * rng.next_f32());
            let (phi, delta) = (7.0 * rng.next_f32(), 7.0 * rng.next_f32());
            // Near the mirror direction.
            let f = |turn: f32| {
                b.eval(direction(o, turn), direction(i, turn + std::f32::consts::PI + 0.2 * phi), Radiance).value[0]
            };
            let (here, turned) = (f(phi), f(phi + delta));
            changed = changed.max((here - turned).abs() / here.abs().max(turned.abs()).max(1e-3));
        }
        assert_eq!(changed > 1e-2, stretched, "{label}: {changed}");
    }
}

#[test]
fn every_model_is_finite_at_the_edges() {
    for_every_case(|b, _, _| edges_are_finite(b));
}

#[test]
fn every_model_says_truly_what_it_does() {
    for_every_case(|b, _, seed| {
        let mut rng = HashRng::new(seed);
        let (mut specular_only, mut transmits) = (true, false);
        for _ in 0..4000 {
            let wo = random_direction(&mut rng);
            let (u, u2) = uniforms(&mut rng);
            let Some(s) = b.sample(wo, u, u2, Radiance) else { continue };
            if wo.z < 0.0 && !b.has_transmission() {
                return Err("scatters below".into());
            }
            specular_only &= s.lobe.is_specular();
            // What goes below a surface does not come out on the other side.
            transmits |= s.lobe.is_transmission() && !s.lobe.is_subsurface();
            let estimate = b.albedo_estimate(wo);
            if !estimate.is_finite() || estimate.max_element() > 1.0 + 1e-3 || estimate.0.min_element() < 0.0 {
                return Err(format!("albedo estimate {estimate:?} from {wo}"));
            }
        }
        if specular_only != b.is_specular() || transmits != b.has_transmission() {
            return Err(format!("specular only: {specular_only}, transmits: {transmits}"));
        }
        Ok(())
    });
}

/// A diffuse reflector with one fault.
#[derive(Clone, Copy, PartialEq)]
enum Fault {
    /// The density is 3 % too large.
    Density,
    /// Directions are drawn uniformly, but the density says cosine.
    MissingCosine,
    /// More light leaves than arrives.
    EnergyGain,
    /// A sample's weight is not value over density.
    Weight,
    /// The value depends on which direction is which.
    Reciprocity,
    /// A part of the directions is never drawn.
    HiddenLobe,
    /// Not a number where `wi` is lower than `wo`.
    Grazing,
}

impl Scatterer for Fault {
    fn eval(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> BsdfEval {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return BsdfEval::ZERO;
        }
        let pdf = wi.z / std::f32::consts::PI;
        let factor = match self {
            Self::EnergyGain => 1.02,
            Self::Reciprocity => 0.9 + 0.1 * wo.z,
            Self::Grazing => (wi.z - wo.z).ln().signum(),
            _ => 1.0,
        };
        BsdfEval { value: Spectrum::splat(factor * pdf), pdf: if *self == Self::Density { 1.03 * pdf } else { pdf } }
    }

    fn sample(&self, wo: Vec3, _: f32, u2: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        use steradian_math::warp::{cosine_hemisphere, uniform_hemisphere};
        let wi = if *self == Self::MissingCosine { uniform_hemisphere(u2) } else { cosine_hemisphere(u2) };
        if *self == Self::HiddenLobe && wi.x > 0.9 {
            return None;
        }
        let e = self.eval(wo, wi, mode);
        let weight = e.value / e.pdf * if *self == Self::Weight { 0.98 } else { 1.0 };
        let lobe = super::Lobe::REFLECTION.with(super::Lobe::DIFFUSE);
        (e.pdf > 0.0).then_some(BsdfSample { wi, weight, pdf: e.pdf, lobe, eta: 1.0 })
    }
}

#[test]
fn the_laws_catch_broken_models() {
    let wo = direction(0.7, 0.3);
    assert!(samples_follow_pdf(&Fault::Density, wo, SAMPLES, 1).is_err());
    assert!(samples_follow_pdf(&Fault::MissingCosine, wo, SAMPLES, 1).is_err());
    assert!(samples_follow_pdf(&Fault::HiddenLobe, wo, SAMPLES, 1).is_err());
    assert!(energy_is_conserved(&Fault::EnergyGain, wo, false, 1).is_err());
    assert!(energy_is_conserved(&Fault::HiddenLobe, wo, false, 1).is_err());
    assert!(energy_is_conserved(&Fault::Weight, wo, true, 1).is_err());
    assert!(weight_is_value_over_pdf(&Fault::Weight, wo, 1).is_err());
    assert!(is_reciprocal(&Fault::Reciprocity, 1.0, 1).is_err());
    assert!(is_adjoint(&Fault::Reciprocity, 1).is_err());
    assert!(edges_are_finite(&Fault::Grazing).is_err());
    // The same surface keeps the laws it does not break.
    assert!(samples_follow_pdf(&Fault::Reciprocity, wo, SAMPLES, 1).is_ok());
    assert!(is_reciprocal(&Fault::Density, 1.0, 1).is_ok());
    assert!(weight_is_value_over_pdf(&Fault::Reciprocity, wo, 1).is_ok());
    assert!(energy_is_conserved(&Fault::Reciprocity, wo, false, 1).is_ok());
}
