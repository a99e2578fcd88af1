//! The sun's disc (Hosek and Wilkie 2013).

use super::{
    Atmosphere,
    body::CelestialBody,
    data::{self, BANDS, LIMB, POWERS, SEGMENTS},
    disc::{Disc, polynomial},
};
use std::f32::consts::{FRAC_2_PI, FRAC_PI_2};
use steradian_math::{
    Spectrum, Vec2, Vec3,
    color::luminance,
    spectra::{ColorMode, Wavelengths},
};

/// The aperture (the whole angle) that the model is made for, in degrees.
const APERTURE: f32 = 0.5358;

/// Appearance of the sun.
#[derive(Clone, Copy, Debug)]
pub struct SunLook {
    /// The whole angle of the disc in degrees, in (0, 90); its light stays the same.
    pub aperture: f32,
    /// Enables limb darkening: the disc is darker at its edge, and low down; else all of it has the mean radiance.
    pub limb_darkening: bool,
    /// Selects the coarser sum over wavelengths of Mitsuba's RGB variants for linear sRGB, which is brighter by five to
    /// nine per cent.
    pub coarse_rgb: bool,
}

/// The sun without the sky.
#[derive(Clone, Debug)]
pub struct SunDisc {
    disc: Disc,
    up: Vec3,
    segments: Vec<[[f32; POWERS]; BANDS]>,
    limb: [[f32; LIMB]; BANDS],
    rgb: [[f32; 3]; BANDS],
    /// The radiance of all of the disc, where that is even.
    even: Option<[f32; BANDS]>,
    is_up: bool,
    /// Factor by which a disc of another size is as bright.
    scale: f32,
    mode: ColorMode,
    fluence: f32,
}

impl SunDisc {
    /// The sun in an atmosphere; black where its middle is below the horizon.
    pub fn new(air: &Atmosphere, look: &SunLook) -> Self {
        let exact = data::rgb_of_bands();
        let mut disc = Self {
            disc: Disc::new(air.sun, look.aperture),
            up: air.up,
            segments: data::sun(air.turbidity),
            limb: data::limb(),
            rgb: if look.coarse_rgb { data::rgb_of_bands_by_mitsuba() } else { exact },
            even: None,
            is_up: air.height() >= 0.0,
            // Keep the irradiance: radiance goes with the inverse of the solid angle.
            scale: Disc::new(air.sun, APERTURE).relative_to(&Disc::new(air.sun, look.aperture)),
            mode: air.mode,
            fluence: 0.0,
        };
        if disc.is_up {
            // Without limb darkening the disc has its mean radiance everywhere, so that the irradiance stays the same.
            let mean = disc.mean();
            let y: f32 = (0..BANDS).map(|b| mean[b] * luminance(Vec3::from_array(exact[b]))).sum();
            disc.fluence = disc.disc.integral(y.max(0.0) * disc.scale);
            disc.even = (!look.limb_darkening).then_some(mean);
        }
        disc
    }

    /// Radiance averaged over the part of the disc that is above the horizon.
    fn mean(&self) -> [f32; BANDS] {
        const EDGE: u32 = 64;
        let (mut sum, mut count) = ([0.0_f64; BANDS], 0_u32);
        for k in 0..EDGE * EDGE {
            let u = Vec2::new((k % EDGE) as f32 + 0.5, (k / EDGE) as f32 + 0.5) / EDGE as f32;
            // Average over stratified directions in the disc.
            let w = self.sample(u).0;
            if let (Some(mu2), true) = (self.disc.mu2(w), w.dot(self.up) >= 0.0) {
                count += 1;
                sum.iter_mut().enumerate().for_each(|(b, s)| *s += f64::from(self.band(b, w) * self.darkening(b, mu2)));
            }
        }
        sum.map(|s| (s / f64::from(count.max(1))) as f32)
    }

    /// Radiance of a band at the middle of a disc at the height of `w`: the polynomial of its segment.
    fn band(&self, b: usize, w: Vec3) -> f32 {
        let height = w.dot(self.up).clamp(0.0, 1.0).asin();
        // Segments are spaced by the cube of the elevation.
        let segment = (((height * FRAC_2_PI).cbrt() * SEGMENTS as f32) as usize).min(SEGMENTS - 1);
        let x = height - FRAC_PI_2 * (segment as f32 / SEGMENTS as f32).powi(3);
        polynomial(&self.segments[segment][b], x)
    }

    /// The share of that where the sun's surface is seen at an angle.
    fn darkening(&self, b: usize, mu2: f32) -> f32 {
        polynomial(&self.limb[b], mu2.sqrt())
    }
}

impl CelestialBody for SunDisc {
    fn radiance(&self, w: Vec3, lambda: &Wavelengths) -> Spectrum {
        let Some(mu2) = self.disc.mu2(w).filter(|_| self.is_up && w.dot(self.up) >= 0.0) else { return Spectrum::ZERO };
        let value = |b: usize| self.scale * self.even.map_or_else(|| self.band(b, w), |even| even[b]);
        let share = |b: usize| if self.even.is_some() { 1.0 } else { self.darkening(b, mu2) };
        match self.mode {
            // Both are interpolated by themselves, as in the authors' program.
            ColorMode::Spectral => data::at_wavelengths(lambda, value) * data::at_wavelengths(lambda, share),
            ColorMode::Rgb => {
                let band = |b: usize| Vec3::from_array(self.rgb[b]) * (value(b) * share(b));
                let rgb = (0..BANDS).map(band).sum::<Vec3>().max(Vec3::ZERO);
                Spectrum::rgb(rgb.x, rgb.y, rgb.z)
            }
        }
    }

    fn sample(&self, u: Vec2) -> (Vec3, f32) {
        self.disc.sample(u)
    }

    fn pdf(&self, w: Vec3) -> f32 {
        self.disc.pdf(w)
    }

    fn fluence(&self) -> f32 {
        self.fluence
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.segments[..])
    }
}
