//! A value per colour lane: three linear Rec.709 components (and an unused fourth), or four sampled wavelengths.

use crate::{Vec4, elementary};
use std::ops::{Add, AddAssign, Div, Index, Mul, MulAssign, Neg, Sub};

/// Four lanes of radiance, reflectance, density, … Arithmetic is lane by lane; what the lanes mean is known by whoever
/// made the value (RGB mode: R, G, B and a fourth lane equal to zero or ignored; spectral mode: four wavelengths).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(transparent)]
pub struct Spectrum(pub Vec4);

impl Spectrum {
    /// All lanes zero.
    pub const ZERO: Self = Self(Vec4::ZERO);
    /// All lanes one.
    pub const ONE: Self = Self(Vec4::ONE);

    /// Broadcasts one value to all lanes.
    #[inline]
    pub const fn splat(v: f32) -> Self {
        Self(Vec4::splat(v))
    }

    /// From four lane values.
    #[inline]
    pub const fn new(v: [f32; 4]) -> Self {
        Self(Vec4::from_array(v))
    }

    /// Three linear Rec.709 components; the fourth lane is zero.
    #[inline]
    pub const fn rgb(r: f32, g: f32, b: f32) -> Self {
        Self(Vec4::new(r, g, b, 0.0))
    }

    /// The first three lanes.
    #[inline]
    pub fn to_rgb(self) -> [f32; 3] {
        [self.0.x, self.0.y, self.0.z]
    }

    /// All lanes.
    #[inline]
    pub fn to_array(self) -> [f32; 4] {
        self.0.to_array()
    }

    /// True if every lane is zero.
    #[inline]
    pub fn is_black(self) -> bool {
        self.0 == Vec4::ZERO
    }

    /// True if every lane is finite.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.0.is_finite()
    }

    /// The largest lane.
    #[inline]
    pub fn max_element(self) -> f32 {
        self.0.max_element()
    }

    /// The mean of the four lanes (spectral mode).
    #[inline]
    pub fn mean(self) -> f32 {
        self.0.element_sum() * 0.25
    }

    /// `exp` of each lane.
    #[inline]
    pub fn exp(self) -> Self {
        self.map(elementary::exp)
    }

    /// Square root of each lane, negative lanes as zero.
    #[inline]
    pub fn sqrt(self) -> Self {
        Self(self.0.max(Vec4::ZERO).sqrt())
    }

    /// A function of each lane.
    #[inline]
    pub fn map(self, f: impl Fn(f32) -> f32) -> Self {
        let a = self.0.to_array();
        Self::new([f(a[0]), f(a[1]), f(a[2]), f(a[3])])
    }

    /// Lane-wise maximum with a number.
    #[inline]
    pub fn max(self, v: f32) -> Self {
        Self(self.0.max(Vec4::splat(v)))
    }

    /// Lane-wise clamp.
    #[inline]
    pub fn clamp(self, lo: f32, hi: f32) -> Self {
        Self(self.0.clamp(Vec4::splat(lo), Vec4::splat(hi)))
    }

    /// `a·(1 − t) + b·t`.
    #[inline]
    pub fn lerp(self, b: Self, t: f32) -> Self {
        Self(self.0 * (1.0 - t) + b.0 * t)
    }

    /// Lane-wise quotient, zero where the divisor is zero.
    #[inline]
    pub fn safe_div(self, d: Self) -> Self {
        Self(Vec4::select(d.0.cmpeq(Vec4::ZERO), Vec4::ZERO, self.0 / d.0))
    }
}

impl Index<usize> for Spectrum {
    type Output = f32;
    #[inline]
    fn index(&self, i: usize) -> &f32 {
        &self.0[i]
    }
}

macro_rules! lanes {
    ($($trait:ident $method:ident),*) => {$(
        impl $trait for Spectrum {
            type Output = Self;
            #[inline]
            fn $method(self, o: Self) -> Self {
                Self($trait::$method(self.0, o.0))
            }
        }
    )*};
}
lanes!(Add add, Sub sub, Mul mul, Div div);

impl Mul<f32> for Spectrum {
    type Output = Self;
    #[inline]
    fn mul(self, k: f32) -> Self {
        Self(self.0 * k)
    }
}

impl Mul<Spectrum> for f32 {
    type Output = Spectrum;
    #[inline]
    fn mul(self, s: Spectrum) -> Spectrum {
        s * self
    }
}

impl Div<f32> for Spectrum {
    type Output = Self;
    #[inline]
    fn div(self, k: f32) -> Self {
        Self(self.0 / k)
    }
}

impl Neg for Spectrum {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl AddAssign for Spectrum {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        self.0 += o.0;
    }
}

impl MulAssign for Spectrum {
    #[inline]
    fn mul_assign(&mut self, o: Self) {
        self.0 *= o.0;
    }
}

impl MulAssign<f32> for Spectrum {
    #[inline]
    fn mul_assign(&mut self, k: f32) {
        self.0 *= k;
    }
}
