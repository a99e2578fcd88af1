//! Scattering of light by a sphere, by Mie's series.
//!
//! `a_n`, `b_n` from Riccati–Bessel functions; the logarithmic derivative of ψ inside by downward recurrence (Bohren,
//! Huffman, *Absorption and Scattering of Light by Small Particles*, eqs. 4.56, 4.57, 4.61, 4.62, 4.74 and 4.89).

use crate::laboratory::{Axis, Chart, Error, Experiment, Parameter, Report, Run, Series, Values};
use rustfft::num_complex::Complex;
use std::f64::consts::PI;

type C = Complex<f64>;

pub const EXPERIMENT: Experiment = Experiment {
    name: "mie",
    doc: "scattering by a sphere of any size: efficiencies, asymmetry, light by angle",
    source: "Bohren, Huffman, Absorption and Scattering of Light by Small Particles, chapter 4",
    parameters: &[
        Parameter::number("radius", 5.0, (1e-4, 200.0), "µm", "of the sphere"),
        Parameter::number("wavelength", 550.0, (10.0, 1e6), "nm", "in vacuum"),
        Parameter::number("n", 1.333, (0.05, 10.0), "", "index of the sphere, real part"),
        Parameter::number("k", 0.0, (0.0, 10.0), "", "index of the sphere, imaginary part (absorption)"),
        Parameter::number("medium", 1.0, (1.0, 5.0), "", "index of what is around it"),
    ],
    run: Run::Alone(run),
};

/// Scattering by a sphere.
#[derive(Clone, Debug)]
pub(super) struct Sphere {
    /// Extinction and scattering cross sections over the cross section of the sphere.
    pub extinction: f64,
    pub scattering: f64,
    /// Radar backscattering efficiency (4π times the differential one at 180°, over the cross section).
    pub backscattering: f64,
    /// Mean cosine of the scattering angle.
    pub asymmetry: f64,
    a: Vec<C>,
    b: Vec<C>,
}

impl Sphere {
    /// Sphere of size parameter `x = 2π r n_medium/λ` and relative index `m` (imaginary part positive: absorption).
    pub fn new(x: f64, m: C) -> Self {
        // Wiscombe's number of terms.
        let terms = (x + 4.05 * x.cbrt() + 2.0).ceil() as usize;
        let mx = m * x;
        let depth = terms.max(mx.norm().ceil() as usize) + 16;
        let mut d = vec![C::new(0.0, 0.0); depth + 1];
        for n in (1..=depth).rev() {
            let k = C::from(n as f64) / mx;
            d[n - 1] = k - (d[n] + k).inv();
        }
        let (mut psi0, mut psi1) = (x.cos(), x.sin());
        let (mut chi0, mut chi1) = (-x.sin(), x.cos());
        let mut xi1 = C::new(psi1, -chi1);
        let (mut a, mut b) = (Vec::with_capacity(terms), Vec::with_capacity(terms));
        for (k, dn) in d.iter().enumerate().take(terms + 1).skip(1) {
            let n = k as f64;
            let psi = (2.0 * n - 1.0) * psi1 / x - psi0;
            let chi = (2.0 * n - 1.0) * chi1 / x - chi0;
            let xi = C::new(psi, -chi);
            let (da, db) = (*dn / m + n / x, m * *dn + n / x);
            a.push((da * psi - psi1) / (da * xi - xi1));
            b.push((db * psi - psi1) / (db * xi - xi1));
            (psi0, psi1, chi0, chi1, xi1) = (psi1, psi, chi1, chi, xi);
        }
        let sum = |f: &dyn Fn(f64, usize) -> f64| -> f64 { (0..a.len()).map(|i| f(i as f64 + 1.0, i)).sum() };
        let extinction = 2.0 / (x * x) * sum(&|n, i| (2.0 * n + 1.0) * (a[i] + b[i]).re);
        let scattering = 2.0 / (x * x) * sum(&|n, i| (2.0 * n + 1.0) * (a[i].norm_sqr() + b[i].norm_sqr()));
        let back: C =
            (0..a.len()).map(|i| (a[i] - b[i]) * ((2.0 * i as f64 + 3.0) * if i % 2 == 0 { -1.0 } else { 1.0 })).sum();
        let moment = sum(&|n, i| {
            let next = if i + 1 < a.len() { (a[i] * a[i + 1].conj() + b[i] * b[i + 1].conj()).re } else { 0.0 };
            n * (n + 2.0) / (n + 1.0) * next + (2.0 * n + 1.0) / (n * (n + 1.0)) * (a[i] * b[i].conj()).re
        });
        Self {
            extinction,
            scattering,
            backscattering: back.norm_sqr() / (x * x),
            asymmetry: 4.0 / (x * x) * moment / scattering,
            a,
            b,
        }
    }

    /// `(|S₁|² + |S₂|²)/2` at an angle: unpolarised scattered light, up to a factor.
    pub fn intensity(&self, cos: f64) -> f64 {
        let (mut s1, mut s2) = (C::new(0.0, 0.0), C::new(0.0, 0.0));
        let (mut pi0, mut pi1) = (0.0, 1.0);
        for (i, (a, b)) in self.a.iter().zip(&self.b).enumerate() {
            let n = i as f64 + 1.0;
            let tau = n * cos * pi1 - (n + 1.0) * pi0;
            let f = (2.0 * n + 1.0) / (n * (n + 1.0));
            s1 += (a * pi1 + b * tau) * f;
            s2 += (a * tau + b * pi1) * f;
            (pi0, pi1) = (pi1, ((2.0 * n + 1.0) * cos * pi1 - (n + 1.0) * pi0) / n);
        }
        0.5 * (s1.norm_sqr() + s2.norm_sqr())
    }
}

fn run(values: &Values) -> Result<Report, Error> {
    let (radius, lambda) = (values.number("radius") * 1e-6, values.number("wavelength") * 1e-9);
    let medium = values.number("medium");
    let m = C::new(values.number("n"), values.number("k")) / medium;
    let x = 2.0 * PI * radius * medium / lambda;
    if x > 20_000.0 {
        let why = format!("the sphere is {:.0} wavelengths around; beyond 20000 use rays ('rainbow')", x);
        return Err(Error::Impossible(why));
    }
    if (m - 1.0).norm() < 1e-9 {
        return Err(Error::Impossible("the sphere has the index of what is around it: it scatters nothing".into()));
    }
    let sphere = Sphere::new(x, m);
    let mut report = Report::default();
    report.quantity("size parameter", x, "");
    report.quantity("extinction efficiency", sphere.extinction, "");
    report.quantity("scattering efficiency", sphere.scattering, "");
    report.quantity("backscattering efficiency", sphere.backscattering, "");
    report.quantity("asymmetry (mean cosine)", sphere.asymmetry, "");
    // Normalised to ∫ p dω = 1.
    let norm = PI * x * x * sphere.scattering;
    let points = (0..=1800)
        .map(|k| f64::from(k) / 10.0)
        .map(|degrees| (degrees, sphere.intensity(degrees.to_radians().cos()) / norm))
        .collect();
    report.chart = Some(
        Chart::new(
            format!("sphere of {} µm, index {}, {} nm", radius * 1e6, values.number("n"), lambda * 1e9),
            Axis::linear("scattering angle (°)"),
            Axis::log("phase function (1/sr)"),
        )
        .with(Series::line("phase function", points)),
    );
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::quadrature::integrate;

    /// The example in Bohren and Huffman's appendix A: x = 5.213, m = 1.55.
    #[test]
    fn efficiencies_are_those_in_print() {
        let x = 2.0 * PI * 0.525 / 0.6328;
        let s = Sphere::new(x, C::new(1.55, 0.0));
        assert!((s.extinction - 3.10543).abs() < 1e-5 && (s.scattering - 3.10543).abs() < 1e-5, "{}", s.extinction);
        assert!((s.backscattering - 2.92534).abs() < 2e-5, "{}", s.backscattering);
    }

    /// The phase function of droplets in scenes has the mean cosine of water's, over sizes that differ by a tenth and
    /// over visible wavelengths, within 0.02: its own is drawn from its samples.
    #[test]
    fn droplets_of_scenes_have_the_mean_cosine_of_spheres() {
        use steradian_core::medium::Phase;
        use steradian_math::{Vec2, Vec3};
        for diameter in [6.0, 10.0, 20.0, 45.0] {
            let (mut sum, mut weights) = (0.0, 0.0);
            for lambda in [0.45, 0.55, 0.65] {
                for k in -2..=2 {
                    let d = diameter * (1.0 + 0.05 * f64::from(k));
                    let sphere = Sphere::new(PI * d / lambda, C::new(1.333, 0.0));
                    (sum, weights) =
                        (sum + d * d * sphere.scattering * sphere.asymmetry, weights + d * d * sphere.scattering);
                }
            }
            let phase = Phase::droplets(diameter);
            let of = |u: Vec2| -f64::from(phase.sample(Vec3::Z, u).0.z);
            let mean = (0..20_000).map(|k| of(Vec2::new((k as f32 + 0.5) / 20_000.0, 0.5))).sum::<f64>() / 20_000.0;
            assert!((mean - sum / weights).abs() < 0.02, "{diameter} µm: {mean}, by Mie's theory {}", sum / weights);
        }
    }

    /// Small spheres scatter as x⁴ (Rayleigh), large ones twice their cross section (the extinction paradox).
    #[test]
    fn small_and_large_spheres_have_their_limits() {
        let (x, m) = (1e-3_f64, C::new(1.5, 0.0));
        let polarizability = ((m * m - 1.0) / (m * m + 2.0)).norm_sqr();
        let rayleigh = 8.0 / 3.0 * x.powi(4) * polarizability;
        assert!((Sphere::new(x, m).scattering / rayleigh - 1.0).abs() < 1e-5);
        let large = Sphere::new(3000.0, C::new(1.33, 0.1));
        // Edge effects fade as x^(−2/3): 1.99 x^(−2/3) (Nussenzveig, Wiscombe 1980).
        assert!((large.extinction - 2.0 - 1.99 * 3000f64.powf(-2.0 / 3.0)).abs() < 2e-3, "{}", large.extinction);
    }

    /// The phase function integrates to one, and its mean cosine is the asymmetry of the series.
    #[test]
    fn the_phase_function_is_normalised() {
        let (x, m) = (8.0, C::new(1.4, 0.01));
        let s = Sphere::new(x, m);
        let norm = PI * x * x * s.scattering;
        let total = integrate(|c| s.intensity(c) * 2.0 * PI / norm, -1.0, 1.0, 128);
        let mean = integrate(|c| c * s.intensity(c) * 2.0 * PI / norm, -1.0, 1.0, 128);
        assert!((total - 1.0).abs() < 1e-10 && (mean - s.asymmetry).abs() < 1e-10, "{total} {mean} {}", s.asymmetry);
    }
}
