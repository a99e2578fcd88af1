//! Measured BRDFs in the adaptive parameterisation of the RGL database.
//!
//! A measurement is stored on warped unit squares: for each incident direction `ω` the density of visible microfacet
//! normals maps random numbers to half vectors, so that samples lie where the material scatters. With the normal `m` at
//! `(u, v)` of the unit square and the numbers `s` that the warp gives it,
//!
//! ```text
//! f(ω, ω') cosθ' = S(s; ω) D(m) / (4 σ(ω))
//! ```
//!
//! with `D` the distribution of normals and `σ` its projected area; sampling draws `s` by the luminance of `S` and
//! warps it. Jonathan Dupuy and Wenzel Jakob, "An Adaptive Parameterization for Efficient Material Acquisition and
//! Rendering" (2018). Read by pbrt-v4 and Mitsuba as `measured`.

use super::{MeasuredError, interpolant::Interpolant, tensor::TensorFile};
use std::f32::consts::{FRAC_PI_2, PI, TAU};
use steradian_math::{
    Spectrum, Vec2, Vec3,
    color::space::REC709,
    spectra::{cie, d65},
};

/// A measurement.
#[derive(Clone, Debug)]
pub struct Rgl {
    isotropic: bool,
    /// Number of repetitions of the measured azimuths around the circle: 1, 2 or 4.
    symmetry: u32,
    jacobian: bool,
    ndf: Interpolant<0>,
    sigma: Interpolant<0>,
    vndf: Interpolant<2>,
    luminance: Interpolant<2>,
    /// By azimuth, angle, and wavelength in nm or number of the channel.
    values: Interpolant<3>,
    /// True if the last axis of `values` is a wavelength.
    pub spectral: bool,
}

/// Which colours are wanted from a file that may have several.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// Linear Rec.709.
    Rgb,
    /// Wavelengths, where the file has them.
    Spectral,
}

impl Rgl {
    /// From a tensor file.
    ///
    /// # Errors
    /// What is missing or does not fit.
    pub fn read(file: &TensorFile<'_>, wanted: Wanted) -> Result<Self, MeasuredError> {
        let phi = file.need("phi_i", 1)?.axis("phi_i")?;
        let theta = file.need("theta_i", 1)?.axis("theta_i")?;
        // One or two azimuths mark an isotropic material; else the span of the azimuths tells the symmetry.
        let isotropic = phi.len() <= 2;
        let span = phi[phi.len() - 1] - phi[0];
        let symmetry = if isotropic { 1 } else { (TAU / span.max(1e-3)).round().max(1.0) as u32 };
        if !matches!(symmetry, 1 | 2 | 4) {
            return Err(MeasuredError::Fault(format!("its azimuths repeat {symmetry} times around the circle")));
        }
        let axes = || [phi.clone(), theta.clone()];
        let plain = |name: &str| {
            let t = file.need(name, 2)?;
            Interpolant::new(name, t.floats(name)?, [t.shape[0], t.shape[1]], [], false)
        };
        let warp = |name: &str| {
            let t = file.need(name, 4)?;
            Interpolant::new(name, t.floats(name)?, [t.shape[2], t.shape[3]], axes(), true)
        };
        // The normal and area tables have no parameters, the two warps those of incidence.
        let (values, spectral) = colours(file, wanted, &phi, &theta)?;
        let jacobian = file.need("jacobian", 1)?.floats("jacobian")?[0] != 0.0;
        Ok(Self {
            isotropic,
            symmetry,
            jacobian,
            ndf: plain("ndf")?,
            sigma: plain("sigma")?,
            vndf: warp("vndf")?,
            luminance: warp("luminance")?,
            values,
            spectral,
        })
    }

    /// Folds directions into the measured part of the circle, and tells by which mirrorings.
    #[inline]
    fn fold(&self, wo: Vec3) -> Vec2 {
        match self.symmetry {
            2 => Vec2::splat(1.0_f32.copysign(wo.y)),
            4 => Vec2::new(1.0_f32.copysign(wo.x), 1.0_f32.copysign(wo.y)),
            _ => Vec2::ONE,
        }
    }

    /// `f·cosθ_i` at the wavelengths (or of the three channels), and the density of sampling.
    pub fn eval(&self, wo: Vec3, wi: Vec3, lambda: [f32; 4]) -> (Spectrum, f32) {
        // Fold into the measured part of the circle by the material's symmetry.
        let fold = self.fold(wo);
        let turn = |w: Vec3| Vec3::new(w.x * fold.x, w.y * fold.y, w.z);
        let (wo, wi) = (turn(wo), turn(wi));
        // The half vector, in the coordinates of the unit square of normals.
        let Some(m) = (wo + wi).try_normalize().filter(|m| m.z > 0.0) else { return (Spectrum::ZERO, 0.0) };
        let o = Angles::of(wo);
        let normal = Angles::of(m);
        let azimuth = if self.isotropic { normal.phi - o.phi } else { normal.phi };
        let u_m = [theta_to_u(normal.theta), wrap(phi_to_u(azimuth))];
        // Invert the warp of visible normals: which numbers map to this half vector.
        let at = self.vndf.at([o.phi, o.theta]);
        let (s, vndf_pdf) = self.vndf.invert(u_m, &at);
        let value = self.value(s, u_m, o, lambda);
        let lum = self.luminance.at([o.phi, o.theta]);
        // Density: that of the numbers, times that of the warp, over the Jacobian of square and reflection.
        let pdf = self.luminance.pdf(s, &lum) * vndf_pdf / jacobian(u_m[0], normal.theta, wo.dot(m));
        (value, pdf)
    }

    /// A direction distributed about as the light that leaves; the density is what [`Rgl::eval`] gives.
    pub fn sample(&self, wo: Vec3, u: Vec2) -> Option<Vec3> {
        let fold = self.fold(wo);
        let wo = Vec3::new(wo.x * fold.x, wo.y * fold.y, wo.z);
        let o = Angles::of(wo);
        // The first axis of the unit square is the angle, the second the azimuth; drawn first is the second.
        let (s, _) = self.luminance.sample([u.y, u.x], &self.luminance.at([o.phi, o.theta]));
        let (u_m, _) = self.vndf.sample(s, &self.vndf.at([o.phi, o.theta]));
        // Normal from the unit square: θ = u²·π/2, φ = (2v − 1) π.
        let mut phi = (2.0 * u_m[1] - 1.0) * PI;
        if self.isotropic {
            phi += o.phi;
        }
        let (sin, cos) = (u_m[0] * u_m[0] * FRAC_PI_2).sin_cos();
        let m = Vec3::new(phi.cos() * sin, phi.sin() * sin, cos);
        // Reflect about the normal and unfold.
        let wi = 2.0 * wo.dot(m) * m - wo;
        (wi.z > 0.0).then(|| Vec3::new(wi.x * fold.x, wi.y * fold.y, wi.z))
    }

    #[inline]
    fn value(&self, s: [f32; 2], u_m: [f32; 2], o: Angles, lambda: [f32; 4]) -> Spectrum {
        // The spectrum is stored on the warped square, one slice for each wavelength.
        let lane = |l: f32| self.values.eval(s, &self.values.at([o.phi, o.theta, l])).max(0.0);
        let mut value = Spectrum::new(lambda.map(lane));
        // f cos θ' = S·D(m)/(4 σ(ω)).
        if self.jacobian {
            let alone = self.ndf.at([]);
            let u_o = [theta_to_u(o.theta), wrap(phi_to_u(o.phi))];
            value *= self.ndf.eval(u_m, &alone) / (4.0 * self.sigma.eval(u_o, &alone)).max(1e-6);
        }
        value
    }
}

/// The values by wavelength or channel, as the colour mode wants them.
fn colours(
    file: &TensorFile<'_>,
    wanted: Wanted,
    phi: &[f32],
    theta: &[f32],
) -> Result<(Interpolant<3>, bool), MeasuredError> {
    let spectral = file.get("spectra").is_some() && (wanted == Wanted::Spectral || file.get("rgb").is_none());
    let name = if spectral { "spectra" } else { "rgb" };
    let t = file.need(name, 5)?;
    let size = [t.shape[3], t.shape[4]];
    let axes = |last: Vec<f32>| [phi.to_vec(), theta.to_vec(), last];
    // Colours come by channel.
    if !spectral {
        if t.shape[2] != 3 {
            return Err(MeasuredError::Fault(format!("'rgb' has {} channels", t.shape[2])));
        }
        let data = t.floats(name)?;
        return Ok((Interpolant::new(name, data, size, axes(vec![0.0, 1.0, 2.0]), false)?, false));
    }
    let lambda = file.need("wavelengths", 1)?.axis("wavelengths")?;
    if lambda.len() != t.shape[2] {
        return Err(MeasuredError::Fault("'spectra' and 'wavelengths' differ in length".into()));
    }
    let data = t.floats(name)?;
    if wanted == Wanted::Spectral {
        return Ok((Interpolant::new(name, data, size, axes(lambda), false)?, true));
    }
    // From wavelengths to linear Rec.709 under D65, texel by texel.
    let weights = rgb_weights(&lambda);
    let patch = size[0].saturating_mul(size[1]).max(1);
    let mut rgb = Vec::with_capacity(data.len() / lambda.len() * 3);
    for block in data.chunks_exact(patch.saturating_mul(lambda.len())) {
        for channel in 0..3 {
            rgb.extend((0..patch).map(|p| {
                weights.iter().enumerate().map(|(l, w)| w[channel] * block[l * patch + p]).sum::<f32>().max(0.0)
            }));
        }
    }
    Ok((Interpolant::new(name, rgb, size, axes(vec![0.0, 1.0, 2.0]), false)?, false))
}

/// Contribution of each sampled wavelength of a reflectance to its linear Rec.709 colour under D65, for linear
/// interpolation between samples.
pub(super) fn rgb_weights(lambda: &[f32]) -> Vec<Vec3> {
    let last = lambda.len() - 1;
    (0..lambda.len())
        .map(|i| {
            let hat = |l: f32| -> f32 {
                let (here, low, high) = (lambda[i], i.checked_sub(1).map(|j| lambda[j]), lambda.get(i + 1));
                match (low, high) {
                    // The ends go on beyond the measured range.
                    (None, _) if l <= here => 1.0,
                    (_, None) if l >= here && i == last => 1.0,
                    (Some(low), _) if l > low && l <= here => (l - low) / (here - low),
                    (_, Some(high)) if l >= here && l < *high => (high - l) / (high - here),
                    _ => 0.0,
                }
            };
            // Integrate the hat function of the sample under D65 against the matching functions.
            (REC709.rgb_from_xyz() * cie::to_xyz(|l| hat(l) * d65().eval(l))).as_vec3()
        })
        .collect()
}

/// Spherical coordinates.
#[derive(Clone, Copy, Debug)]
struct Angles {
    theta: f32,
    phi: f32,
}

impl Angles {
    /// Accurate also near the pole.
    #[inline]
    fn of(w: Vec3) -> Self {
        // |w − z| = 2 sin(θ/2).
        Self { theta: 2.0 * (0.5 * (w - Vec3::Z).length()).min(1.0).asin(), phi: w.y.atan2(w.x) }
    }
}

#[inline]
fn theta_to_u(theta: f32) -> f32 {
    (theta / FRAC_PI_2).max(0.0).sqrt()
}

#[inline]
fn phi_to_u(phi: f32) -> f32 {
    phi / TAU + 0.5
}

#[inline]
fn wrap(u: f32) -> f32 {
    u - u.floor()
}

/// Solid angle of `wi` per area of the unit square of normals.
#[inline]
fn jacobian(u_theta: f32, theta_m: f32, wo_dot_m: f32) -> f32 {
    // dω_m = sin θ_m dθ dφ over du dv is 2π² u sin θ_m; reflection adds 4 (wo·m).
    (2.0 * PI * PI * u_theta * theta_m.sin()).max(1e-6) * 4.0 * wo_dot_m.max(1e-6)
}
