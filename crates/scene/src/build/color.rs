//! Colours, textures, and materials' measured constants.

use super::node::{Draft, Part};
use crate::{
    Family,
    node::{ColorSpace, SpectrumValue, Value},
};
use std::path::PathBuf;

/// A spectral value: linear Rec.709, one number for all wavelengths, or a spectrum.
#[derive(Clone, Debug, PartialEq)]
pub struct Color(pub(super) SpectrumValue);

impl Color {
    /// The spectrum of a black body of that temperature in kelvin, its largest value one.
    pub fn blackbody(kelvin: f64) -> Self {
        Self(SpectrumValue::Blackbody(kelvin))
    }
}

impl From<f64> for Color {
    fn from(v: f64) -> Self {
        Self(SpectrumValue::Constant(v))
    }
}

impl From<[f64; 3]> for Color {
    fn from(v: [f64; 3]) -> Self {
        Self(SpectrumValue::Rgb(v, ColorSpace::Srgb))
    }
}

impl From<SpectrumValue> for Color {
    fn from(v: SpectrumValue) -> Self {
        Self(v)
    }
}

/// Value of a parameter that may vary over a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture(pub(super) Part);

impl<C: Into<Color>> From<C> for Texture {
    fn from(c: C) -> Self {
        Self(Part::Value(Value::Spectrum(c.into().0)))
    }
}

/// A picture over the texture coordinates of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Image(Draft);

impl Image {
    /// A picture file: colours, as its kind encodes them.
    pub fn new(file: impl Into<PathBuf>) -> Self {
        Self(Draft::new(Family::Texture, "image").with("file", file.into()))
    }

    /// The file holds numbers, not colours: normals, heights, roughness.
    #[must_use]
    pub fn raw(mut self) -> Self {
        self.0.set("raw", true);
        self
    }

    /// Number of repetitions of the picture along each coordinate.
    #[must_use]
    pub fn repeat(mut self, u: f64, v: f64) -> Self {
        self.0.set("scale_u", u);
        self.0.set("scale_v", v);
        self
    }

    /// A factor of its values.
    #[must_use]
    pub fn scale(mut self, factor: f64) -> Self {
        self.0.set("scale", factor);
        self
    }
}

impl From<Image> for Texture {
    fn from(t: Image) -> Self {
        Self(Part::Node(Box::new(t.0)))
    }
}

/// Squares of two colours or textures.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkerboard(Draft);

impl Checkerboard {
    /// Squares of side one in texture coordinates; `a` where the sum of the squares' numbers is even.
    pub fn new(a: impl Into<Texture>, b: impl Into<Texture>) -> Self {
        Self(Draft::new(Family::Texture, "checkerboard").with("a", a.into().0).with("b", b.into().0))
    }

    /// Squares for each unit of the coordinates.
    #[must_use]
    pub fn repeat(mut self, u: f64, v: f64) -> Self {
        self.0.set("scale_u", u);
        self.0.set("scale_v", v);
        self
    }
}

impl From<Checkerboard> for Texture {
    fn from(t: Checkerboard) -> Self {
        Self(Part::Node(Box::new(t.0)))
    }
}

/// A metal whose index of refraction was measured: one of [`metal`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Metal(pub(super) &'static str);

/// Metals by name.
pub mod metal {
    use super::Metal;
    /// Ag.
    pub const SILVER: Metal = Metal("Ag");
    /// Al.
    pub const ALUMINIUM: Metal = Metal("Al");
    /// Au.
    pub const GOLD: Metal = Metal("Au");
    /// CuZn.
    pub const BRASS: Metal = Metal("CuZn");
    /// Cr.
    pub const CHROMIUM: Metal = Metal("Cr");
    /// Cu.
    pub const COPPER: Metal = Metal("Cu");
    /// W.
    pub const TUNGSTEN: Metal = Metal("W");
}

/// A glass whose index of refraction over wavelength is known: one of [`glass`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Glass(pub(super) &'static str);

/// Optical glasses by name.
pub mod glass {
    use super::Glass;
    /// Schott N-BK7, a borosilicate crown.
    pub const BK7: Glass = Glass("glass-BK7");
    /// A barium flint.
    pub const BAF10: Glass = Glass("glass-BAF10");
    /// A dense lanthanum flint.
    pub const LASF9: Glass = Glass("glass-LASF9");
    /// A dense flint, of strong dispersion.
    pub const SF11: Glass = Glass("glass-SF11");
}

/// Index of refraction of glass: a measured glass, or one number.
impl From<Glass> for Color {
    fn from(g: Glass) -> Self {
        Self(SpectrumValue::Named(g.0.into()))
    }
}
