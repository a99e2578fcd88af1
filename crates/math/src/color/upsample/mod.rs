//! Smooth spectra for RGB values: Jakob and Hanika 2019, "A Low-Dimensional Function Space for Efficient Spectral
//! Upsampling".
//!
//! A reflectance is a sigmoid of a quadratic polynomial, `S(c₀ λ² + c₁ λ + c₂)` with `S(x) = ½ + x / (2 √(1 + x²))`
//! (their eqs. 3 and 4; λ in nm). The coefficients of an RGB value are those whose colour under the white of its space
//! differs least in CIELAB; they are tabulated and interpolated as in pbrt-v4, whose three kinds of RGB spectra are
//! [`RgbAlbedo`], [`RgbUnbounded`] and [`RgbIlluminant`].
//!
//! Within Rec.709 colours come back with ΔE < 1, but for the very dark and saturated, which need steeper polynomials
//! than the bound on the coefficients allows: green (0, 0.004, 0) comes back as (0.003, 0.013, 0), ΔE 14; from (0,
//! 0.05, 0) on all is well. pbrt-v4 and Mitsuba, whose tables have the same bound, show the same colours.

mod solve;
mod table;

use super::RgbSpace;
use super::space::{ACES2065_1, DCI_P3, REC709, REC2020};
use crate::spectra::{Dense, LAMBDA_MAX, LAMBDA_MIN, Wavelengths, d65, named::aces_d60};
use crate::{Spectrum, Vec3};
use std::sync::LazyLock;
use table::Table;

/// A smooth spectrum with values in [0, 1]: the sigmoid of a quadratic polynomial of the wavelength.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RgbSigmoid {
    /// Coefficients of λ², λ and 1, λ in nm. Polynomials beyond ±1e18 at some wavelength are not to be had from this
    /// crate.
    pub c: [f32; 3],
}

/// Beyond this the sigmoid is 0 or 1 to the last bit; its square is still finite.
const SATURATED: f32 = 1e9;

impl RgbSigmoid {
    /// The spectrum of constant value `v` in [0, 1].
    pub fn constant(v: f32) -> Self {
        let c = (v - 0.5) / (v * (1.0 - v)).max(0.0).sqrt();
        Self { c: [0.0, 0.0, if c.is_nan() { 0.0 } else { c.clamp(-SATURATED, SATURATED) }] }
    }

    /// The spectrum of linear `rgb` in `space`, components clamped to [0, 1]; NaN counts as 0. Equal components give a
    /// constant spectrum exactly.
    pub fn new(space: &RgbSpace, rgb: Vec3) -> Self {
        let rgb = rgb.to_array().map(unit);
        if rgb[0] == rgb[1] && rgb[1] == rgb[2] {
            return Self::constant(rgb[0]);
        }
        table(space).lookup(rgb)
    }

    /// The spectrum of linear `rgb`, solved for by itself rather than interpolated in the table: for colours that are
    /// kept. It is dearer than a lookup where the table's columns are there, but a column takes 64 such solutions.
    pub fn solved(space: &RgbSpace, rgb: Vec3) -> Self {
        let unit = rgb.to_array().map(unit);
        let is_grey = unit[0] == unit[1] && unit[1] == unit[2];
        let solved = if is_grey { None } else { table(space).solve(unit) };
        solved.unwrap_or_else(|| Self::new(space, rgb))
    }

    /// The value at `lambda` nm.
    #[inline]
    pub fn eval(&self, lambda: f32) -> f32 {
        let [a, b, c] = self.c;
        let x = (a * lambda + b) * lambda + c;
        0.5 + 0.5 * x / (1.0 + x * x).sqrt()
    }

    /// The values at four sampled wavelengths.
    #[inline]
    pub fn sample(&self, wavelengths: &Wavelengths) -> Spectrum {
        Spectrum::new(wavelengths.lambda.map(|l| self.eval(l)))
    }

    /// The largest value over the visible range: at one of its ends, or where the polynomial turns.
    pub fn max(&self) -> f32 {
        let turn = -self.c[1] / (2.0 * self.c[0]);
        let ends = self.eval(LAMBDA_MIN).max(self.eval(LAMBDA_MAX));
        if (LAMBDA_MIN..=LAMBDA_MAX).contains(&turn) { ends.max(self.eval(turn)) } else { ends }
    }
}

/// The reflectance of an RGB value in [0, 1].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RgbAlbedo(pub RgbSigmoid);

impl RgbAlbedo {
    /// The reflectance of linear `rgb` in `space`, components clamped to [0, 1].
    pub fn new(space: &RgbSpace, rgb: Vec3) -> Self {
        Self(RgbSigmoid::new(space, rgb))
    }

    /// The reflectance at `lambda` nm, in [0, 1].
    #[inline]
    pub fn eval(&self, lambda: f32) -> f32 {
        self.0.eval(lambda)
    }

    /// The values at four sampled wavelengths.
    #[inline]
    pub fn sample(&self, wavelengths: &Wavelengths) -> Spectrum {
        self.0.sample(wavelengths)
    }
}

/// A non-negative RGB value without an upper bound, as a scaled sigmoid: the largest component is brought to ½, where
/// spectra are smooth. Its colour is right under the space's white.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RgbUnbounded {
    /// Twice the largest component.
    pub scale: f32,
    /// The spectrum of the value over `scale`.
    pub sigmoid: RgbSigmoid,
}

impl RgbUnbounded {
    /// The spectrum of linear `rgb` in `space`; negative and NaN components count as 0, infinite ones as the largest
    /// finite.
    pub fn new(space: &RgbSpace, rgb: Vec3) -> Self {
        let rgb = Vec3::from_array(rgb.to_array().map(|v| if v > 0.0 { v.min(0.5 * f32::MAX) } else { 0.0 }));
        let scale = 2.0 * rgb.max_element();
        // The quotient of subnormal components can be off; they are black to any renderer.
        if scale < f32::MIN_POSITIVE {
            return Self { scale: 0.0, sigmoid: RgbSigmoid::constant(0.0) };
        }
        Self { scale, sigmoid: RgbSigmoid::new(space, rgb / scale) }
    }

    /// The value at `lambda` nm.
    #[inline]
    pub fn eval(&self, lambda: f32) -> f32 {
        self.scale * self.sigmoid.eval(lambda)
    }

    /// The values at four sampled wavelengths.
    #[inline]
    pub fn sample(&self, wavelengths: &Wavelengths) -> Spectrum {
        self.scale * self.sigmoid.sample(wavelengths)
    }

    /// The largest value over the visible range.
    pub fn max(&self) -> f32 {
        self.scale * self.sigmoid.max()
    }
}

/// The emission of a light given as RGB: an unbounded spectrum times the white of the space (luminance Y = 1), so that
/// the light's colour is that RGB. Mitsuba's RGB emitters are the same spectrum: its D65 is normalised to Y = 1 too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RgbIlluminant {
    /// The factor of the white.
    pub factor: RgbUnbounded,
    white: &'static Dense,
}

impl RgbIlluminant {
    /// The emission of linear `rgb` in `space`; negative and NaN components count as 0.
    pub fn new(space: &RgbSpace, rgb: Vec3) -> Self {
        let white = if *space == ACES2065_1 { aces_d60() } else { d65() };
        Self { factor: RgbUnbounded::new(space, rgb), white }
    }

    /// The white of the space, at luminance Y = 1.
    pub fn white(&self) -> &'static Dense {
        self.white
    }

    /// The value at `lambda` nm.
    #[inline]
    pub fn eval(&self, lambda: f32) -> f32 {
        self.factor.eval(lambda) * self.white.eval(lambda)
    }

    /// The values at four sampled wavelengths.
    #[inline]
    pub fn sample(&self, wavelengths: &Wavelengths) -> Spectrum {
        self.factor.sample(wavelengths) * self.white.sample(wavelengths)
    }
}

/// Clamps to [0, 1]; NaN is 0.
fn unit(v: f32) -> f32 {
    if v > 0.0 { v.min(1.0) } else { 0.0 }
}

/// The table of a space, made when it is first asked for; its columns are filled as they are needed.
fn table(space: &RgbSpace) -> &'static Table {
    static TABLES: [LazyLock<Table>; 4] = [
        LazyLock::new(|| Table::new(&REC709)),
        LazyLock::new(|| Table::new(&DCI_P3)),
        LazyLock::new(|| Table::new(&REC2020)),
        LazyLock::new(|| Table::new(&ACES2065_1)),
    ];
    // Every space is one of these.
    let i = RgbSpace::all().into_iter().position(|s| std::ptr::eq(s, space) || s == space).unwrap_or_default();
    &TABLES[i]
}

#[cfg(test)]
mod tests;
