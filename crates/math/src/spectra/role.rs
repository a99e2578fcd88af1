//! Colour in the two modes: a parameter's spectrum on the four lanes, by the role of the parameter.
//!
//! In RGB mode three lanes are linear Rec.709. In spectral mode the lanes are radiances at four wavelengths; the first
//! is the hero, drawn by visible importance, and dispersion ends the other three. Arithmetic is the same in both: only
//! the evaluation of a parameter looks at the mode.
//!
//! | role | RGB value in spectral mode | spectrum in RGB mode |
//! |---|---|---|
//! | `Albedo` | sigmoid of a quadratic (Jakob, Hanika 2019), from 0 to 1 | its colour under D65, clamped |
//! | `Unbounded` | scaled sigmoid | its colour under D65 |
//! | `Illuminant` | scaled sigmoid × D65 of luminance one | its tristimulus, ∫s·cmf/∫ȳ |
//!
//! So RGB white as emission is D65 of luminance one in either mode. `normalize` on a light, which pbrt asks for and
//! Mitsuba does not, divides spectra other than RGB by their luminance. Two rules follow Mitsuba in its files: the RGB
//! of an emitted texture, and coefficients of media up to one, take the spectrum of an albedo.

use crate::{
    Spectrum, Vec3,
    color::{
        RgbSpace, luminance,
        space::REC709,
        upsample::{RgbAlbedo, RgbIlluminant, RgbUnbounded},
    },
    spectra::{ColorMode, Dense, Spd, Wavelengths, cie, d65},
};
use std::sync::Arc;

/// Physical meaning of a value, which decides how RGB becomes a spectrum and a spectrum RGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A reflectance or transmittance in [0, 1].
    Albedo,
    /// Any other quantity that is not negative.
    Unbounded,
    /// A refractive index or extinction coefficient: looked up at wavelengths, never integrated over them.
    Index,
    /// Emission: RGB white means D65 of luminance one.
    Illuminant,
}

/// A spectrum of one parameter, ready to be evaluated at the wavelengths of a path.
#[derive(Clone, Debug)]
pub enum Color {
    /// Fixed lanes for every path: RGB mode, and flat spectra.
    Lanes(Spectrum),
    /// A spectrum over wavelength.
    Spectral(Spd),
}

impl Color {
    /// Black.
    pub const BLACK: Self = Self::Lanes(Spectrum::ZERO);

    /// One value in every lane.
    pub const fn constant(v: f32) -> Self {
        Self::Lanes(Spectrum::splat(v))
    }

    /// A linear RGB triple of a colour space in a role. Reflectances are clamped to [0, 1], others to be at least zero.
    pub fn rgb(rgb: Vec3, space: &RgbSpace, role: Role, mode: ColorMode) -> Self {
        if mode == ColorMode::Rgb {
            let rgb = space.to_rec709(rgb);
            let rgb = if role == Role::Albedo { rgb.clamp(Vec3::ZERO, Vec3::ONE) } else { rgb.max(Vec3::ZERO) };
            return Self::Lanes(Spectrum::rgb(rgb.x, rgb.y, rgb.z));
        }
        let grey = rgb.x == rgb.y && rgb.y == rgb.z;
        match role {
            Role::Albedo if grey => Self::constant(rgb.x.clamp(0.0, 1.0)),
            Role::Unbounded | Role::Index if grey => Self::constant(rgb.x.max(0.0)),
            Role::Albedo => Self::Spectral(Spd::Albedo(RgbAlbedo::new(space, rgb))),
            Role::Unbounded | Role::Index => Self::Spectral(Spd::Unbounded(RgbUnbounded::new(space, rgb))),
            Role::Illuminant => Self::Spectral(Spd::Illuminant(RgbIlluminant::new(space, rgb))),
        }
    }

    /// A curve over wavelength in a role: its means over each nanometre, so that integrals are exact, and the values of
    /// an index. In RGB mode emission becomes its tristimulus (luminance `∫sȳ/∫ȳ`); other
    /// quantities become the colour they have under D65.
    pub fn curve(curve: &Spd, role: Role, mode: ColorMode) -> Self {
        let dense = match role {
            Role::Index => Arc::new(Dense::new(|l| curve.eval(l))),
            _ => curve.table(),
        };
        let flat = dense.values().windows(2).all(|w| w[0] == w[1]).then(|| dense.values()[0]);
        match (mode, flat) {
            (ColorMode::Spectral, Some(v)) => Self::constant(v),
            (ColorMode::Spectral, None) => Self::Spectral(Spd::Dense(dense)),
            (ColorMode::Rgb, Some(v)) if role != Role::Illuminant => {
                Self::constant(if role == Role::Albedo { v.clamp(0.0, 1.0) } else { v.max(0.0) })
            }
            (ColorMode::Rgb, _) => {
                let xyz = match role {
                    Role::Illuminant => cie::to_xyz(|l| dense.eval(l)),
                    _ => cie::to_xyz(|l| dense.eval(l) * d65().eval(l)),
                };
                let rgb = (REC709.rgb_from_xyz() * xyz).as_vec3();
                let rgb = if role == Role::Albedo { rgb.clamp(Vec3::ZERO, Vec3::ONE) } else { rgb.max(Vec3::ZERO) };
                Self::Lanes(Spectrum::rgb(rgb.x, rgb.y, rgb.z))
            }
        }
    }

    /// The lanes at the wavelengths of a path.
    #[inline]
    pub fn eval(&self, lambda: &Wavelengths) -> Spectrum {
        match self {
            Self::Lanes(s) => *s,
            Self::Spectral(s) => s.sample(lambda),
        }
    }

    /// This colour times a number.
    #[must_use]
    pub fn scaled(&self, k: f32) -> Self {
        match self {
            _ if k == 1.0 => self.clone(),
            Self::Lanes(s) => Self::Lanes(*s * k),
            Self::Spectral(s) => {
                let table = s.table();
                Self::Spectral(Spd::Dense(Arc::new(Dense::new(|l| table.eval(l) * k))))
            }
        }
    }

    /// True if it is zero everywhere.
    pub fn is_black(&self) -> bool {
        match self {
            Self::Lanes(s) => s.is_black(),
            Self::Spectral(s) => s.max() <= 0.0,
        }
    }

    /// Luminance Y; a flat spectrum of one and RGB white have Y = 1.
    pub fn luminance(&self, mode: ColorMode) -> f32 {
        match self {
            Self::Lanes(s) if mode == ColorMode::Spectral => s[0],
            Self::Lanes(s) => luminance(Vec3::from(s.to_rgb())),
            Self::Spectral(s) => s.to_xyz().y as f32,
        }
    }
}

/// Equal-energy lanes under D65 of luminance one, in which a white surface is white; in RGB mode they are as they were.
#[inline]
pub fn under_white(s: Spectrum, lambda: &Wavelengths, mode: ColorMode) -> Spectrum {
    match mode {
        ColorMode::Rgb => s,
        ColorMode::Spectral => s * texel(Vec3::ONE, Role::Illuminant, lambda, mode),
    }
}

/// The lanes of an RGB texel in a role.
#[inline]
pub fn texel(rgb: Vec3, role: Role, lambda: &Wavelengths, mode: ColorMode) -> Spectrum {
    match (mode, role) {
        (ColorMode::Rgb, Role::Albedo) => {
            let c = rgb.clamp(Vec3::ZERO, Vec3::ONE);
            Spectrum::rgb(c.x, c.y, c.z)
        }
        (ColorMode::Rgb, _) => Spectrum::rgb(rgb.x.max(0.0), rgb.y.max(0.0), rgb.z.max(0.0)),
        (ColorMode::Spectral, Role::Albedo) => RgbAlbedo::new(&REC709, rgb).sample(lambda),
        (ColorMode::Spectral, Role::Unbounded | Role::Index) => RgbUnbounded::new(&REC709, rgb).sample(lambda),
        (ColorMode::Spectral, Role::Illuminant) => RgbIlluminant::new(&REC709, rgb).sample(lambda),
    }
}
