//! A spectrum of any kind: what a spectral parameter of a scene is once its units and colour space are settled.

use super::{Blackbody, CIE_Y_INTEGRAL, Curve, Dense, Wavelengths, cie, d65};
use crate::color::space::REC709;
use crate::color::upsample::{RgbAlbedo, RgbIlluminant, RgbUnbounded};
use crate::{Spectrum, Vec3};
use glam::DVec3;
use std::sync::Arc;

/// A value over the wavelength. Cheap to clone.
#[derive(Clone, Debug, PartialEq)]
pub enum Spd {
    /// One value at all wavelengths.
    Constant(f32),
    /// A value at every visible nanometre.
    Dense(Arc<Dense>),
    /// Samples joined by lines.
    Curve(Arc<Curve>),
    /// Thermal emission.
    Blackbody(Blackbody),
    /// A reflectance given as RGB in [0, 1].
    Albedo(RgbAlbedo),
    /// A non-negative RGB value without an upper bound, such as a cross-section.
    Unbounded(RgbUnbounded),
    /// The emission of a light given as RGB.
    Illuminant(RgbIlluminant),
}

impl Spd {
    /// The value at `lambda` nm.
    pub fn eval(&self, lambda: f32) -> f32 {
        match self {
            Self::Constant(v) => *v,
            Self::Dense(d) => d.eval(lambda),
            Self::Curve(c) => c.eval(lambda),
            Self::Blackbody(b) => b.eval(lambda),
            Self::Albedo(a) => a.eval(lambda),
            Self::Unbounded(u) => u.eval(lambda),
            Self::Illuminant(i) => i.eval(lambda),
        }
    }

    /// The values at four sampled wavelengths.
    #[inline]
    pub fn sample(&self, wavelengths: &Wavelengths) -> Spectrum {
        match self {
            Self::Constant(v) => Spectrum::splat(*v),
            Self::Dense(d) => d.sample(wavelengths),
            Self::Curve(c) => c.sample(wavelengths),
            Self::Blackbody(b) => b.sample(wavelengths),
            Self::Albedo(a) => a.sample(wavelengths),
            Self::Unbounded(u) => u.sample(wavelengths),
            Self::Illuminant(i) => i.sample(wavelengths),
        }
    }

    /// The table of this spectrum whose integrals are those of the spectrum: means of a [`Curve`], values of what is
    /// smooth.
    pub fn table(&self) -> Arc<Dense> {
        match self {
            Self::Dense(d) => Arc::clone(d),
            Self::Curve(c) => Arc::new(Dense::from(&**c)),
            _ => Arc::new(Dense::new(|l| self.eval(l))),
        }
    }

    /// The largest value in a visible nanometre.
    pub fn max(&self) -> f32 {
        self.table().max()
    }

    /// CIE XYZ, the constant spectrum 1 having Y = 1.
    pub fn to_xyz(&self) -> DVec3 {
        let table = self.table();
        cie::to_xyz(|l| table.eval(l))
    }

    /// The linear Rec.709 colour of this spectrum as emitted light. The constant spectrum is not white: it is the white
    /// E, slightly pink against D65. Components are negative outside the gamut.
    pub fn to_rgb(&self) -> Vec3 {
        (REC709.rgb_from_xyz() * self.to_xyz()).as_vec3()
    }

    /// The linear Rec.709 colour of this spectrum as a reflectance, seen under D65: a constant is a grey.
    pub fn to_rgb_reflectance(&self) -> Vec3 {
        let table = self.table();
        (REC709.rgb_from_xyz() * cie::to_xyz(|l| table.eval(l) * d65().eval(l))).as_vec3()
    }

    /// `∫ s ȳ dλ`, pbrt-v4's photometric integral. Of an RGB illuminant it takes the illuminant alone, without the RGB
    /// factor, as pbrt-v4 does when it scales a light to a given power.
    pub fn to_photometric(&self) -> f64 {
        match self {
            Self::Illuminant(i) => cie::to_photometric(|l| i.white().eval(l)),
            _ => self.to_xyz().y * CIE_Y_INTEGRAL,
        }
    }
}

impl From<f32> for Spd {
    fn from(v: f32) -> Self {
        Self::Constant(v)
    }
}

impl From<Curve> for Spd {
    fn from(c: Curve) -> Self {
        Self::Curve(Arc::new(c))
    }
}

impl From<Dense> for Spd {
    fn from(d: Dense) -> Self {
        Self::Dense(Arc::new(d))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectra::named;

    #[test]
    fn lanes_are_evaluations() {
        let rgb = Vec3::new(0.2, 0.9, 0.4);
        let all = [
            Spd::Constant(0.5),
            Spd::Dense(Arc::new(d65().clone())),
            Spd::Curve(Arc::new(named("metal-Au-eta").unwrap())),
            Spd::Blackbody(Blackbody::normalized(3000.0)),
            Spd::Albedo(RgbAlbedo::new(&REC709, rgb)),
            Spd::Unbounded(RgbUnbounded::new(&REC709, rgb * 7.0)),
            Spd::Illuminant(RgbIlluminant::new(&REC709, rgb * 7.0)),
        ];
        let w = Wavelengths::sample_visible(0.37);
        for s in all {
            let lanes = s.sample(&w);
            for i in 0..4 {
                assert!((lanes[i] - s.eval(w.lambda[i])).abs() <= 1e-5 * lanes[i].abs(), "{s:?}");
            }
            assert!(s.max() >= s.eval(610.0));
        }
    }

    #[test]
    fn colours_of_light_and_of_reflectance() {
        let grey = Spd::from(0.5);
        assert!((grey.to_rgb_reflectance() - 0.5).abs().max_element() < 1e-5);
        let e = grey.to_rgb();
        assert!(e.x > e.y && e.x > e.z && e.x < 0.65, "{e}");
        let d65 = Spd::from(d65().clone());
        assert!((d65.to_rgb() - 1.0).abs().max_element() < 1e-5);
        let copper =
            Spd::from(Curve::new([400.0, 560.0, 640.0, 780.0], [0.4, 0.5, 0.95, 0.97]).unwrap()).to_rgb_reflectance();
        assert!(copper.x > copper.y && copper.y > copper.z);
    }

    #[test]
    fn photometric_integral_of_an_rgb_illuminant_leaves_the_rgb_out() {
        let s = Spd::Illuminant(RgbIlluminant::new(&REC709, Vec3::new(3.0, 1.0, 2.0)));
        assert!((s.to_photometric() / CIE_Y_INTEGRAL - 1.0).abs() < 1e-6);
        assert!((Spd::Constant(2.0).to_photometric() / CIE_Y_INTEGRAL - 2.0).abs() < 1e-6);
    }
}
