//! Sampled curves over the wavelength: irregular samples joined by lines, and a table of every visible nanometre.
//!
//! Tables of emission, reflectance and absorption hold *means*: the exact mean of the curve over the nanometre around
//! each wavelength. So they keep the integral of a curve whatever its samples, lines narrower than a nanometre
//! included. Refractive indices are tabulated by their values at the wavelengths, since nothing integrates them.

use super::cie::{lambdas, nearest, to_photometric};
use super::{CIE_Y_INTEGRAL, LAMBDA_COUNT, LAMBDA_MAX, LAMBDA_MIN, Wavelengths};
use crate::{Error, Spectrum};

/// Values at increasing wavelengths joined by straight lines; zero outside the first and last wavelength, as in pbrt-v4
/// ([`Curve::extended`] holds the end values over the visible range instead).
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    lambda: Box<[f32]>,
    value: Box<[f32]>,
}

impl Curve {
    /// From wavelengths in nm, strictly increasing, and as many values; both finite and at least one of each.
    pub fn new(lambda: impl Into<Box<[f32]>>, value: impl Into<Box<[f32]>>) -> Result<Self, Error> {
        let (lambda, value) = (lambda.into(), value.into());
        if lambda.len() != value.len() {
            return Err(Error::Curve(format!("{} wavelengths but {} values", lambda.len(), value.len())));
        }
        if lambda.is_empty() {
            return Err(Error::Curve("no samples".into()));
        }
        if let Some(v) = lambda.iter().chain(value.iter()).find(|v| !v.is_finite()) {
            return Err(Error::Curve(format!("{v} is not a finite number")));
        }
        if let Some(w) = lambda.windows(2).find(|w| w[0] >= w[1]) {
            return Err(Error::Curve(format!("wavelengths must increase, but {} nm follows {} nm", w[1], w[0])));
        }
        Ok(Self { lambda, value })
    }

    /// From λ, value, λ, value, … (nm).
    pub fn from_interleaved(samples: &[f32]) -> Result<Self, Error> {
        if !samples.len().is_multiple_of(2) {
            return Err(Error::Curve(format!("{} numbers do not make pairs of wavelength and value", samples.len())));
        }
        let lane = |k: usize| samples.iter().skip(k).step_by(2).copied().collect::<Box<[f32]>>();
        Self::new(lane(0), lane(1))
    }

    /// The values at evenly spaced wavelengths from `min` to `max` nm, both included.
    pub fn regular(min: f32, max: f32, values: impl Into<Box<[f32]>>) -> Result<Self, Error> {
        let value = values.into();
        let last = value.len().saturating_sub(1).max(1) as f32;
        let lambda: Box<[f32]> = (0..value.len()).map(|i| min + (max - min) * (i as f32 / last)).collect();
        Self::new(lambda, value)
    }

    /// This curve with its end values held over the whole visible range, which pbrt-v4 does to its named spectra.
    #[must_use]
    pub fn extended(&self) -> Self {
        let (mut lambda, mut value) = (self.lambda.to_vec(), self.value.to_vec());
        if lambda[0] > LAMBDA_MIN {
            lambda.insert(0, LAMBDA_MIN - 1.0);
            value.insert(0, value[0]);
        }
        let end = lambda.len() - 1;
        if lambda[end] < LAMBDA_MAX {
            lambda.push(LAMBDA_MAX + 1.0);
            value.push(value[end]);
        }
        Self { lambda: lambda.into(), value: value.into() }
    }

    /// This curve times `k`.
    #[must_use]
    pub fn scaled(&self, k: f32) -> Self {
        Self { lambda: self.lambda.clone(), value: self.value.iter().map(|v| v * k).collect() }
    }

    /// This curve scaled to luminance Y = 1 by its values at whole nanometres, as standards and pbrt-v4 do for
    /// illuminants; unchanged where that luminance is not positive.
    #[must_use]
    pub fn normalized(&self) -> Self {
        let y = to_photometric(|l| self.eval(l));
        if y > 0.0 { self.scaled((CIE_Y_INTEGRAL / y) as f32) } else { self.clone() }
    }

    /// The value at `lambda` nm.
    pub fn eval(&self, lambda: f32) -> f32 {
        let after = self.lambda.partition_point(|&l| l <= lambda);
        if after == 0 {
            return 0.0;
        }
        let (l0, v0) = (self.lambda[after - 1], self.value[after - 1]);
        match self.lambda.get(after) {
            Some(&l1) => {
                let t = (lambda - l0) / (l1 - l0);
                v0 * (1.0 - t) + self.value[after] * t
            }
            None if lambda == l0 => v0,
            None => 0.0,
        }
    }

    /// The mean over the wavelengths from `low` to `high` nm: exact, piece by piece between the samples. Parts beyond
    /// the first and last sample count as zero. A single sample has no width: its value is the mean of what contains
    /// it.
    pub fn mean(&self, low: f32, high: f32) -> f32 {
        if let ([at], [value]) = (&*self.lambda, &*self.value) {
            return if (low..high).contains(at) { *value } else { 0.0 };
        }
        let first = self.lambda.partition_point(|&l| l <= low).saturating_sub(1);
        let mut sum = 0.0f64;
        for (l, v) in self.lambda[first..].windows(2).zip(self.value[first..].windows(2)) {
            if l[0] >= high {
                break;
            }
            let [l0, l1, v0, v1] = [l[0], l[1], v[0], v[1]].map(f64::from);
            let (from, to) = (f64::from(low).max(l0), f64::from(high).min(l1));
            if to > from {
                // The integral of a line is its value in the middle times the width.
                let t = (0.5 * (from + to) - l0) / (l1 - l0);
                sum += (v0 + (v1 - v0) * t) * (to - from);
            }
        }
        (sum / (f64::from(high) - f64::from(low))) as f32
    }

    /// The values at four sampled wavelengths. For hot paths prefer a [`Dense`] table.
    pub fn sample(&self, wavelengths: &Wavelengths) -> Spectrum {
        Spectrum::new(wavelengths.lambda.map(|l| self.eval(l)))
    }

    /// The largest value (that of the curve is at one of its samples; zero outside them).
    pub fn max(&self) -> f32 {
        self.value.iter().copied().fold(f32::MIN, f32::max)
    }

    /// The wavelengths of the samples, nm, increasing.
    pub fn lambda(&self) -> &[f32] {
        &self.lambda
    }

    /// The values of the samples.
    pub fn values(&self) -> &[f32] {
        &self.value
    }
}

/// A value at every whole visible nanometre; a lookup rounds to the nearest. Zero outside the visible range.
#[derive(Clone, Debug, PartialEq)]
pub struct Dense {
    values: Box<[f32; LAMBDA_COUNT]>,
}

impl Dense {
    /// Tabulates `s(λ in nm)`.
    pub fn new(s: impl Fn(f32) -> f32) -> Self {
        let mut values = Box::new([0.0; LAMBDA_COUNT]);
        for (v, l) in values.iter_mut().zip(lambdas()) {
            *v = s(l);
        }
        Self { values }
    }

    /// Tabulates the means of a function `mean(from, to)` over the visible part of the nanometre around each
    /// wavelength.
    pub fn of_means(mean: impl Fn(f32, f32) -> f32) -> Self {
        Self::new(|l| {
            let [low, high] = interval(l);
            mean(low, high)
        })
    }

    /// The value at the whole nanometre nearest to `lambda` nm.
    #[inline]
    pub fn eval(&self, lambda: f32) -> f32 {
        nearest(lambda).map_or(0.0, |i| self.values[i])
    }

    /// The values at four sampled wavelengths.
    #[inline]
    pub fn sample(&self, wavelengths: &Wavelengths) -> Spectrum {
        Spectrum::new(wavelengths.lambda.map(|l| self.eval(l)))
    }

    /// The largest value.
    pub fn max(&self) -> f32 {
        self.values.iter().copied().fold(f32::MIN, f32::max)
    }

    /// The values at 360, 361, …, 830 nm.
    pub fn values(&self) -> &[f32; LAMBDA_COUNT] {
        &self.values
    }
}

/// The wavelengths that an entry of a table stands for: the visible part of the nanometre around a whole one.
pub(super) fn interval(whole: f32) -> [f32; 2] {
    [(whole - 0.5).max(LAMBDA_MIN), (whole + 0.5).min(LAMBDA_MAX)]
}

/// The means of the curve, exact: the table has its integral.
impl From<&Curve> for Dense {
    fn from(c: &Curve) -> Self {
        Self::of_means(|low, high| c.mean(low, high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_between_samples_and_zero_outside() {
        let c = Curve::from_interleaved(&[400.0, 1.0, 500.0, 3.0, 600.0, 0.0]).unwrap();
        assert_eq!([400.0, 450.0, 500.0, 575.0, 600.0].map(|l| c.eval(l)), [1.0, 2.0, 3.0, 0.75, 0.0]);
        assert_eq!([399.9, 600.1, f32::NAN].map(|l| c.eval(l)), [0.0; 3]);
        assert_eq!(c.max(), 3.0);
    }

    #[test]
    fn a_single_sample_is_a_curve_of_one_point() {
        let c = Curve::new([500.0], [2.0]).unwrap();
        assert_eq!([499.0, 500.0, 501.0].map(|l| c.eval(l)), [0.0, 2.0, 0.0]);
        assert_eq!([360.0, 500.0, 830.0].map(|l| c.extended().eval(l)), [2.0; 3]);
    }

    #[test]
    fn malformed_samples_are_refused_by_name() {
        let why = |r: Result<Curve, Error>| r.unwrap_err().to_string();
        assert!(why(Curve::new([1.0, 2.0], [1.0])).contains("2 wavelengths but 1 values"));
        assert!(why(Curve::new([], [])).contains("no samples"));
        assert!(why(Curve::new([500.0, 400.0], [1.0, 1.0])).contains("400 nm follows 500 nm"));
        assert!(why(Curve::new([500.0, 500.0], [1.0, 1.0])).contains("must increase"));
        assert!(why(Curve::new([500.0, f32::NAN], [1.0, 1.0])).contains("not a finite number"));
        assert!(why(Curve::from_interleaved(&[1.0])).contains("pairs"));
        assert!(why(Curve::regular(400.0, 400.0, [1.0, 1.0])).contains("must increase"));
    }

    #[test]
    fn regular_spacing_includes_both_ends() {
        let c = Curve::regular(400.0, 700.0, [0.0, 3.0, 6.0, 9.0]).unwrap();
        assert_eq!(c.lambda(), &[400.0, 500.0, 600.0, 700.0]);
        assert!((c.eval(650.0) - 7.5).abs() < 1e-6);
    }

    #[test]
    fn normalized_has_luminance_one() {
        let c = Curve::new([400.0, 700.0], [3.0, 9.0]).unwrap().normalized();
        assert!((to_photometric(|l| c.eval(l)) / CIE_Y_INTEGRAL - 1.0).abs() < 1e-6);
        let dark = Curve::new([400.0, 700.0], [0.0, 0.0]).unwrap();
        assert_eq!(dark.normalized(), dark);
    }

    #[test]
    fn dense_agrees_with_its_curve_at_whole_nanometres() {
        let c = Curve::new([350.0, 470.0, 900.0], [0.0, 3.0, 9.0]).unwrap();
        let d = Dense::new(|l| c.eval(l));
        for l in [360.0, 470.0, 555.0, 830.0] {
            assert_eq!(d.eval(l), c.eval(l));
        }
        assert_eq!(d.eval(555.4), c.eval(555.0));
        assert_eq!(d.eval(831.0), 0.0);
        assert_eq!(d.max(), c.eval(830.0));
        // Means along a line are its values in the middle; at the ends of the range half a nanometre is left.
        let d = Dense::from(&c);
        assert!((d.eval(555.0) - c.eval(555.0)).abs() < 1e-6 && (d.eval(360.0) - c.eval(360.25)).abs() < 1e-6);
        assert!((d.eval(830.0) - c.eval(829.75)).abs() < 1e-6 && d.eval(831.0) == 0.0);
        let flat = Dense::from(&Curve::new([360.0, 400.1, 830.0], [0.7; 3]).unwrap());
        assert!(flat.values().iter().all(|v| *v == flat.values()[0]), "a flat curve is flat");
    }

    /// Integrals of narrow lines, boxes and Gaussians, by their triangles and trapezoids: whatever lies between whole
    /// nanometres is kept.
    #[test]
    fn tables_keep_integrals() {
        let gauss: Vec<f32> = (0..61).map(|k| 100.0 * (-0.5 * ((k as f32 - 30.0) / 6.0).powi(2)).exp()).collect();
        let cases = [
            (Curve::new([589.2, 589.4, 589.6], [0.0, 100.0, 0.0]).unwrap(), 20.0),
            (Curve::new([589.1, 589.2, 589.3], [0.0, 100.0, 0.0]).unwrap(), 10.0),
            (Curve::new([404.0, 405.0, 406.0], [0.0, 100.0, 0.0]).unwrap(), 100.0),
            (Curve::new([499.9, 500.0, 600.0, 600.1], [0.0, 1.0, 1.0, 0.0]).unwrap(), 100.1),
            (Curve::new([548.9, 549.0, 551.0, 551.1], [0.0, 1.0, 1.0, 0.0]).unwrap(), 2.1),
            (Curve::new([400.0, 700.0], [2.0, 2.0]).unwrap(), 600.0),
            (Curve::new([300.0, 360.25, 361.0], [0.0, 1.0, 0.0]).unwrap(), 0.25 * (2.0 - 0.25 / 60.25) * 0.5 + 0.375),
            (Curve::regular(541.0, 547.0, gauss).unwrap(), 0.1 * 100.0 * 6.0 * (2.0 * std::f64::consts::PI).sqrt()),
        ];
        for (curve, expected) in cases {
            let table = Dense::from(&curve);
            let width = |l: f32| f64::from(interval(l)[1] - interval(l)[0]);
            let sum: f64 = lambdas().map(|l| f64::from(table.eval(l)) * width(l)).sum();
            assert!((sum / expected - 1.0).abs() < 1e-3, "{curve:?}: {sum}, not {expected}");
        }
        let line = Dense::from(&Curve::new([500.0], [2.0]).unwrap());
        assert_eq!([499.0, 500.0, 501.0].map(|l| line.eval(l)), [0.0, 2.0, 0.0]);
    }
}
