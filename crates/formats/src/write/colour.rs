//! Spectra as formats can hold them: one number, three linear Rec.709 components, or samples over wavelength.

use steradian_math::{
    Vec3,
    color::space,
    spectra::{self, Blackbody, Curve, cie},
};
use steradian_scene::{ColorSpace, SpectrumValue};

/// Step between samples of computed curves, nm.
const STEP: usize = 5;

/// A spectral value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Colour {
    /// One value at all wavelengths.
    Grey(f64),
    /// Linear Rec.709.
    Rgb([f64; 3]),
    /// Piecewise linear over wavelengths in nm.
    Curve(Vec<f32>, Vec<f32>),
}

impl Colour {
    pub fn of(value: &SpectrumValue) -> Self {
        match value {
            SpectrumValue::Constant(v) => Self::Grey(*v),
            SpectrumValue::Rgb(c, ColorSpace::Srgb) => Self::Rgb(*c),
            SpectrumValue::Rgb(c, named) => {
                let from = match named {
                    ColorSpace::DciP3 => &space::DCI_P3,
                    ColorSpace::Rec2020 => &space::REC2020,
                    _ => &space::ACES2065_1,
                };
                let c = from.to_rec709(Vec3::from(c.map(|v| v as f32)));
                Self::Rgb([c.x, c.y, c.z].map(f64::from))
            }
            SpectrumValue::Sampled { lambdas, values } => Self::Curve(lambdas.clone(), values.clone()),
            SpectrumValue::Blackbody(kelvin) => {
                let body = Blackbody::normalized(*kelvin);
                Self::computed(|l| body.eval(l))
            }
            SpectrumValue::Named(name) => match spectra::named(name) {
                Some(curve) => Self::Curve(curve.lambda().to_vec(), curve.values().to_vec()),
                None => Self::Grey(1.0),
            },
        }
    }

    fn computed(value: impl Fn(f32) -> f32) -> Self {
        let lambdas: Vec<f32> = cie::lambdas().step_by(STEP).collect();
        let values = lambdas.iter().map(|&l| value(l)).collect();
        Self::Curve(lambdas, values)
    }

    fn at(&self, lambda: f32) -> f32 {
        match self {
            Self::Grey(v) => *v as f32,
            Self::Rgb(c) => (c.iter().sum::<f64>() / 3.0) as f32,
            Self::Curve(l, v) => Curve::new(l.clone(), v.clone()).map_or(0.0, |c| c.extended().eval(lambda)),
        }
    }

    /// The value at the sodium line, for which indices of refraction are stated.
    pub fn at_sodium_line(&self) -> f64 {
        f64::from(self.at(589.3))
    }

    /// Each component, or sample, by itself.
    pub fn map(&self, f: impl Fn(f64) -> f64) -> Self {
        match self {
            Self::Grey(v) => Self::Grey(f(*v)),
            Self::Rgb(c) => Self::Rgb(c.map(f)),
            Self::Curve(l, v) => Self::Curve(l.clone(), v.iter().map(|v| f(f64::from(*v)) as f32).collect()),
        }
    }

    pub fn scaled(&self, k: f64) -> Self {
        if k == 1.0 { self.clone() } else { self.map(|v| v * k) }
    }

    /// Two values, component by component or wavelength by wavelength.
    pub fn with(&self, other: &Self, f: impl Fn(f64, f64) -> f64) -> Self {
        match (self, other) {
            (a, Self::Grey(b)) => a.map(|a| f(a, *b)),
            (Self::Grey(a), b) => b.map(|b| f(*a, b)),
            (Self::Rgb(a), Self::Rgb(b)) => Self::Rgb([0, 1, 2].map(|i| f(a[i], b[i]))),
            (Self::Curve(l, a), Self::Curve(m, b)) if l == m => {
                let both = a.iter().zip(b).map(|(a, b)| f(f64::from(*a), f64::from(*b)) as f32);
                Self::Curve(l.clone(), both.collect())
            }
            (a, b) => Self::computed(|l| f(f64::from(a.at(l)), f64::from(b.at(l))) as f32),
        }
    }

    /// Luminance as emission: ∫s·ȳ/∫ȳ, for RGB relative to a white of one.
    pub fn luminance(&self) -> f64 {
        match self {
            Self::Grey(v) => *v,
            Self::Rgb([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b,
            Self::Curve(l, v) => match Curve::new(l.clone(), v.clone()) {
                Ok(curve) => spectra::Spd::from(curve).to_xyz().y,
                Err(_) => 0.0,
            },
        }
    }

    /// Linear Rec.709 of a quantity that is not emitted.
    pub fn rgb(&self) -> [f64; 3] {
        match self {
            Self::Grey(v) => [*v; 3],
            Self::Rgb(c) => *c,
            Self::Curve(l, v) => self.curve(l, v, |s| s.to_rgb_reflectance()),
        }
    }

    /// Linear Rec.709 of emission.
    pub fn emitted_rgb(&self) -> [f64; 3] {
        match self {
            Self::Rgb(c) => *c,
            Self::Grey(v) => {
                let flat = Self::Curve(vec![360.0, 830.0], vec![*v as f32; 2]);
                flat.emitted_rgb()
            }
            Self::Curve(l, v) => self.curve(l, v, |s| s.to_rgb()),
        }
    }

    fn curve(&self, l: &[f32], v: &[f32], rgb: impl Fn(&spectra::Spd) -> Vec3) -> [f64; 3] {
        match Curve::new(l.to_vec(), v.to_vec()) {
            Ok(curve) => rgb(&spectra::Spd::Curve(curve.into())).to_array().map(f64::from),
            Err(_) => [0.0; 3],
        }
    }

    /// One number that stands for all.
    pub fn mean(&self) -> f64 {
        let c = self.rgb();
        0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]
    }

    pub fn is_black(&self) -> bool {
        match self {
            Self::Grey(v) => *v == 0.0,
            Self::Rgb(c) => *c == [0.0; 3],
            Self::Curve(_, v) => v.iter().all(|v| *v == 0.0),
        }
    }
}
