//! A spectrum of any kind: what a spectral parameter of a scene is once its units and colour space are settled.

use super::{Blackbody, Curve, Dense, Wavelengths, cie};
use crate::Spectrum;
use crate::color::upsample::{RgbAlbedo, RgbIlluminant, RgbUnbounded};
use glam::DVec3;
use std::sync::Arc;

/// A value over the wavelength. Cheap to clone.
#[derive(Clone, Debug, PartialEq)]
pub enum Spd {
    /// The same value at all wavelengths.
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

    /// The largest value at a whole visible nanometre.
    pub fn max(&self) -> f32 {
        cie::lambdas().map(|l| self.eval(l)).fold(f32::MIN, f32::max)
    }

    /// This spectrum tabulated at every visible nanometre, the fastest form for a spectrum that is read at every sample.
    pub fn to_dense(&self) -> Dense {
        Dense::new(|l| self.eval(l))
    }

    /// CIE XYZ, the constant spectrum 1 having Y = 1.
    pub fn to_xyz(&self) -> DVec3 {
        cie::to_xyz(|l| self.eval(l))
    }

    /// `∫ s ȳ dλ`, pbrt-v4's photometric integral. Of an RGB illuminant it takes the illuminant alone, without the RGB factor, as
    /// pbrt-v4 does when it scales a light to a given power.
    pub fn to_photometric(&self) -> f64 {
        match self {
            Self::Illuminant(i) => cie::to_photometric(|l| i.white().eval(l)),
            _ => cie::to_photometric(|l| self.eval(l)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;
    use crate::color::space::REC709;
    use crate::spectra::{CIE_Y_INTEGRAL, d65, named};

    #[test]
    fn lanes_are_evaluations_and_dense_tables_agree_at_whole_nanometres() {
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
            assert_eq!(s.to_dense().eval(610.0), s.eval(610.0));
            assert!(s.max() >= s.eval(610.0) && s.max() == s.to_dense().max());
        }
    }

    #[test]
    fn photometric_integral_of_an_rgb_illuminant_leaves_the_rgb_out() {
        let s = Spd::Illuminant(RgbIlluminant::new(&REC709, Vec3::new(3.0, 1.0, 2.0)));
        assert!((s.to_photometric() / CIE_Y_INTEGRAL - 1.0).abs() < 1e-6);
        assert!((Spd::Constant(2.0).to_photometric() / CIE_Y_INTEGRAL - 2.0).abs() < 1e-6);
    }
}
