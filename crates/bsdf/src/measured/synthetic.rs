//! Measurements of a material whose values are known: a microfacet metal, in each of the formats. Tests compare lookups
//! against the formula, benchmarks and the registry have data without files.

use super::{
    AngleTable, Btf, MeasuredData, MeasuredError, Merl, Wanted, angles, btf, interpolant::Interpolant, merl,
    tensor::write,
};
use std::f64::consts::{FRAC_PI_2, PI};
use steradian_math::{DVec3, Vec3};

/// An isotropic GGX metal over a little Lambertian reflection.
#[derive(Clone, Copy, Debug)]
pub struct Metal {
    /// Roughness α.
    pub alpha: f64,
    /// Reflectance of the facets, per channel.
    pub facets: [f64; 3],
    /// Albedo of the Lambertian part.
    pub diffuse: f64,
}

/// A metal for demonstrations.
pub const METAL: Metal = Metal { alpha: 0.35, facets: [0.7, 0.5, 0.3], diffuse: 0.15 };

impl Metal {
    /// Distribution of normals (Walter et al. 2007).
    fn d(&self, cos: f64) -> f64 {
        // GGX: D = α²/(π (cos²θ (α² − 1) + 1)²).
        let a2 = self.alpha * self.alpha;
        let t = cos * cos * (a2 - 1.0) + 1.0;
        if cos > 0.0 { a2 / (PI * t * t) } else { 0.0 }
    }

    fn lambda(&self, cos: f64) -> f64 {
        // Smith's Λ = (√(1 + α² tan²θ) − 1)/2.
        let tan2 = (1.0 - cos * cos).max(0.0) / (cos * cos).max(1e-12);
        0.5 * ((1.0 + self.alpha * self.alpha * tan2).sqrt() - 1.0)
    }

    /// `f` (sr⁻¹) of two directions above the surface.
    pub fn f(&self, wo: DVec3, wi: DVec3) -> [f64; 3] {
        let h = (wo + wi).normalize_or(DVec3::Z);
        // Height-correlated masking; specular D·G₂/(4 cos θ_o cos θ_i) over a Lambertian base.
        let g = 1.0 / (1.0 + self.lambda(wo.z) + self.lambda(wi.z));
        let specular = self.d(h.z) * g / (4.0 * wo.z * wi.z).max(1e-9);
        self.facets.map(|c| c * specular + self.diffuse / PI)
    }

    /// As a MERL file of some size.
    pub fn merl(&self, size: [usize; 3]) -> Vec<u8> {
        merl::write(size, |theta_h, theta_d, phi_d| {
            // The pair of directions with these angles, the half vector over the x axis.
            let ((sh, ch), (sd, cd), (sp, cp)) = (theta_h.sin_cos(), theta_d.sin_cos(), phi_d.sin_cos());
            let (x, y, z) = (DVec3::new(ch, 0.0, -sh), DVec3::Y, DVec3::new(sh, 0.0, ch));
            let around = x * (sd * cp) + y * (sd * sp);
            let (wi, wo) = (around + z * cd, z * cd - around);
            if wi.z > 1e-3 && wo.z > 1e-3 { self.f(wo, wi) } else { [0.0; 3] }
        })
    }

    /// As a table of angles.
    pub fn angles(&self, steps: [f64; 2], azimuths: &[f64]) -> String {
        let w = |theta: f64, phi: f64| {
            let ((s, c), (y, x)) = (theta.min(89.0).to_radians().sin_cos(), phi.to_radians().sin_cos());
            DVec3::new(s * x, s * y, c)
        };
        angles::write(steps, azimuths, |ti, pi, to, po| self.f(w(to, po), w(ti, pi))[1])
    }

    /// In the adaptive parameterisation: `n` × `n` samples for each of so many incident angles.
    ///
    /// # Errors
    /// For sizes below 2.
    pub fn rgl(&self, n: usize, angles: usize) -> Result<Vec<u8>, MeasuredError> {
        let theta_i: Vec<f32> = (0..angles).map(|i| (1.5 * i as f64 / (angles - 1) as f64) as f32).collect();
        let unit = |i: usize, n: usize| i as f64 / (n - 1) as f64;
        // Normal of a place on the unit square, as the parameterisation maps it.
        let normal = |u: f64, v: f64| {
            let ((s, c), phi) = ((u * u * FRAC_PI_2).sin_cos(), (2.0 * v - 1.0) * PI);
            DVec3::new(s * phi.cos(), s * phi.sin(), c)
        };
        let incident = |theta: f32| DVec3::new(f64::from(theta).sin(), 0.0, f64::from(theta).cos());
        // Projected area of the facets seen from ω, which is cosθ / G₁.
        let sigma = |cos: f64| cos * (1.0 + self.lambda(cos));
        let m = 64;
        let ndf: Vec<f32> =
            (0..2 * m).map(|i| self.d((unit(i % m, m).powi(2) * FRAC_PI_2).cos().max(1e-9)) as f32).collect();
        let sigmas: Vec<f32> =
            (0..2 * m).map(|i| sigma((unit(i % m, m).powi(2) * FRAC_PI_2).cos().max(1e-6)) as f32).collect();
        let mut vndf = Vec::new();
        for theta in &theta_i {
            let wo = incident(*theta);
            vndf.extend((0..n * n).map(|i| {
                let (u, v) = (unit(i % n, n), unit(i / n, n));
                let h = normal(u, v);
                let sin = (u * u * FRAC_PI_2).sin();
                // Density of visible normals over the square: D (wo·m) times the Jacobian u sin θ.
                (self.d(h.z) * wo.dot(h).max(0.0) * u * sin) as f32
            }));
        }
        let axes = || [vec![0.0], theta_i.clone()];
        let warp = Interpolant::new("vndf", vndf.clone(), [n, n], axes(), true)?;
        let (mut rgb, mut luminance) = (Vec::new(), Vec::new());
        for theta in &theta_i {
            let wo = incident(*theta);
            let at = warp.at([0.0, *theta]);
            let values: Vec<[f64; 3]> = (0..n * n)
                .map(|i| {
                    // Warp even numbers to normals, and store f·cos θ_i without the factor D/(4 σ).
                    let ([u, v], _) = warp.sample([unit(i % n, n) as f32, unit(i / n, n) as f32], &at);
                    let h = normal(f64::from(u), f64::from(v));
                    let wi = 2.0 * wo.dot(h) * h - wo;
                    let d = self.d(h.z).max(1e-9);
                    if wi.z > 0.0 { self.f(wo, wi).map(|f| f * wi.z * 4.0 * sigma(wo.z) / d) } else { [0.0; 3] }
                })
                .collect();
            (0..3).for_each(|c| rgb.extend(values.iter().map(|v| v[c] as f32)));
            luminance.extend(values.iter().map(|v| (v.iter().sum::<f64>() / 3.0 + 1e-4) as f32));
        }
        let a = angles;
        Ok(write::file(&[
            ("description", vec![1], vec![0.0], true),
            ("jacobian", vec![1], vec![1.0], true),
            ("phi_i", vec![1], vec![0.0], false),
            ("theta_i", vec![a], theta_i, false),
            ("ndf", vec![2, m], ndf, false),
            ("sigma", vec![2, m], sigmas, false),
            ("vndf", vec![1, a, n, n], vndf, false),
            ("luminance", vec![1, a, n, n], luminance, false),
            ("rgb", vec![1, a, 3, n, n], rgb, false),
        ]))
    }

    /// As pictures by angle.
    ///
    /// # Errors
    /// None for sound numbers.
    pub fn btf(&self) -> Result<Btf, MeasuredError> {
        btf::stack(|wi: Vec3, wo: Vec3| self.f(wo.as_dvec3(), wi.as_dvec3())[1] as f32)
    }

    /// In every format, with what it is called.
    ///
    /// # Errors
    /// None for sound numbers.
    pub fn all(&self) -> Result<Vec<(&'static str, MeasuredData)>, MeasuredError> {
        let merl = MeasuredData { ..MeasuredData::new(super::Table::Merl(Merl::read(&self.merl([60, 30, 36]))?)) };
        let table = |azimuths: &[f64]| AngleTable::read(&self.angles([15.0, 30.0], azimuths));
        Ok(vec![
            ("adaptive", MeasuredData::read(&self.rgl(32, 8)?, Wanted::Rgb)?),
            ("harmonics", merl.projected(8)),
            ("MERL", merl),
            ("table of angles", MeasuredData::new(super::Table::Angles(table(&[0.0])?))),
            ("anisotropic table", MeasuredData::new(super::Table::Angles(table(&[0.0, 90.0, 180.0, 270.0])?))),
            ("pictures by angle", MeasuredData::from_btf(self.btf()?)),
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Measured;
    use crate::{Scatter, TransportMode};
    use steradian_math::{
        Vec2,
        hash::HashRng,
        spectra::{ColorMode, Wavelengths},
        warp,
    };

    fn relative_errors(data: &MeasuredData) -> Vec<f64> {
        let m = Measured::new(data, &Wavelengths::sample_visible(0.5), ColorMode::Rgb, Vec2::splat(0.25));
        let mut rng = HashRng::new(9);
        let mut errors = Vec::new();
        while errors.len() < 500 {
            let wo = warp::cosine_hemisphere((rng.next_f32(), rng.next_f32()).into());
            let u = (rng.next_f32(), rng.next_f32()).into();
            let Some(s) = m.sample(wo, rng.next_f32(), u, TransportMode::Radiance) else { continue };
            if wo.z < 0.2 || s.wi.z < 0.2 {
                continue;
            }
            let expected = METAL.f(wo.as_dvec3(), s.wi.as_dvec3())[1] * f64::from(s.wi.z);
            errors.push((f64::from(m.eval(wo, s.wi, TransportMode::Radiance).value[1]) / expected - 1.0).abs());
        }
        errors.sort_by(f64::total_cmp);
        errors
    }

    /// M106: what was tabulated is found again at directions between the table's, nearer where the table is finer.
    #[test]
    fn every_format_finds_the_model_again() {
        for (name, data) in METAL.all().expect("sound") {
            let errors = relative_errors(&data);
            let (median, bound) = (
                errors[errors.len() / 2],
                match name {
                    "adaptive" => 0.02,
                    "MERL" => 0.02,
                    "table of angles" => 0.1,
                    "harmonics" | "anisotropic table" => 0.2,
                    _ => 0.4,
                },
            );
            assert!(median < bound, "{name}: half of the errors exceed {median}");
        }
    }

    /// At the pairs of directions that were pictured, the value is the model's, to the rounding of its half floats:
    /// between them, 30° apart, a lobe cannot be followed.
    #[test]
    fn pictured_pairs_come_back() {
        let data = MeasuredData::from_btf(METAL.btf().expect("sound"));
        let m = Measured::new(&data, &Wavelengths::sample_visible(0.5), ColorMode::Rgb, Vec2::splat(0.25));
        let direction = |theta: f32, phi: f32| {
            let (s, c) = theta.to_radians().sin_cos();
            Vec3::new(s * phi.to_radians().cos(), s * phi.to_radians().sin(), c)
        };
        for (ti, to) in [(0.0, 30.0), (30.0, 30.0), (30.0, 60.0), (60.0, 60.0), (60.0, 80.0)] {
            for step in 0..6 {
                let (wi, wo) = (direction(ti, 0.0), direction(to, 60.0 * step as f32));
                let expected = METAL.f(wo.as_dvec3(), wi.as_dvec3())[1] * f64::from(wi.z);
                let found = f64::from(m.eval(wo, wi, TransportMode::Radiance).value[1]);
                assert!((found / expected - 1.0).abs() < 5e-3, "{ti}° {to}° {step}: {found} {expected}");
            }
        }
    }

    /// M98: a turn of both directions about the normal changes nothing of an isotropic material.
    #[test]
    fn isotropic_tables_do_not_feel_a_turn() {
        for (name, data) in
            METAL.all().expect("sound").iter().filter(|d| !d.0.contains("anis") && !d.0.contains("pict"))
        {
            let m = Measured::new(data, &Wavelengths::sample_visible(0.5), ColorMode::Rgb, Vec2::ZERO);
            let turn = |w: Vec3, phi: f32| {
                Vec3::new(w.x * phi.cos() - w.y * phi.sin(), w.x * phi.sin() + w.y * phi.cos(), w.z)
            };
            let (wo, wi) = (Vec3::new(0.48, 0.36, 0.8), Vec3::new(-0.36, 0.0, 0.872_7).normalize());
            let first = m.eval(wo, wi, TransportMode::Radiance);
            for phi in [0.7, 2.0, -1.0, 3.1] {
                let turned = m.eval(turn(wo, phi), turn(wi, phi), TransportMode::Radiance);
                let close = |a: f32, b: f32| (a - b).abs() < 2e-3 * a.abs().max(0.01);
                assert!(
                    close(first.value[0], turned.value[0]) && close(first.pdf, turned.pdf),
                    "{name} at {phi}: {first:?} {turned:?}"
                );
            }
        }
    }

    /// Bytes cut, changed and grown give a message or data that can be used: never a panic, NaN or runaway memory.
    #[test]
    fn damaged_files_are_survived() {
        let metal = Metal { alpha: 0.5, ..METAL };
        let files =
            [metal.merl([3, 3, 4]), metal.rgl(4, 2).expect("sound"), metal.angles([45.0, 90.0], &[0.0]).into_bytes()];
        let mut rng = HashRng::new(77);
        for file in &files {
            for round in 0..600 {
                let mut bad = file.clone();
                match round % 3 {
                    0 => bad.truncate(rng.next_u64() as usize % file.len()),
                    1 => {
                        let at = rng.next_u64() as usize % file.len();
                        bad[at] = rng.next_u64() as u8;
                    }
                    _ => {
                        let at = rng.next_u64() as usize % file.len().saturating_sub(8).max(1);
                        let value = [u64::MAX, 1_000_000_000, 0, f64::NAN.to_bits(), 1 << 32][round % 5].to_le_bytes();
                        bad[at..at + 8].copy_from_slice(&value);
                    }
                }
                let Ok(data) = MeasuredData::read(&bad, Wanted::Spectral) else { continue };
                let m = Measured::new(&data, &Wavelengths::sample_visible(0.3), ColorMode::Spectral, Vec2::ZERO);
                for _ in 0..8 {
                    let wo = warp::cosine_hemisphere((rng.next_f32(), rng.next_f32()).into());
                    let u = (rng.next_f32(), rng.next_f32()).into();
                    if let Some(s) = m.sample(wo, rng.next_f32(), u, TransportMode::Radiance) {
                        assert!(s.weight.is_finite() && s.pdf.is_finite() && s.pdf > 0.0 && s.wi.is_finite(), "{s:?}");
                    }
                }
            }
        }
    }
}
