//! Arithmetic that expressions are evaluated in: numbers, intervals with outward rounding, and either with a derivative
//! (Moore, Interval analysis, 1966; Mitchell, Robust ray intersection with interval arithmetic, 1990).

use std::f64::consts::{FRAC_PI_2, TAU};

/// Number type that expressions are evaluated in.
pub trait Number: Copy {
    /// The number of a value.
    fn constant(v: f64) -> Self;
    /// Sum.
    fn add(self, b: Self) -> Self;
    /// Difference.
    fn sub(self, b: Self) -> Self;
    /// Product.
    fn mul(self, b: Self) -> Self;
    /// Quotient.
    fn div(self, b: Self) -> Self;
    /// Square.
    fn square(self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Sine.
    fn sin(self) -> Self;
    /// Cosine.
    fn cos(self) -> Self;
    /// Exponential.
    fn exp(self) -> Self;
    /// Natural logarithm.
    fn log(self) -> Self;
    /// Magnitude.
    fn abs(self) -> Self;
    /// The smaller of two; undefined where one is.
    fn min(self, b: Self) -> Self;
    /// The larger of two; undefined where one is.
    fn max(self, b: Self) -> Self;
    /// Largest whole number that is not above it.
    fn floor(self) -> Self;
    /// Slope of `floor`: 0, without bound where it steps.
    fn steps(self) -> Self;
    /// 1 above 0, −1 below.
    fn sign(self) -> Self;
    /// 1 where it is at most `b`, else 0.
    fn is_least(self, b: Self) -> Self;

    /// A whole power, by squaring.
    fn power(self, n: u32) -> Self {
        match n {
            0 => Self::constant(1.0),
            1 => self,
            n if n % 2 == 0 => self.power(n / 2).square(),
            n => self.power(n - 1).mul(self),
        }
    }
}

impl Number for f64 {
    #[inline]
    fn constant(v: f64) -> Self {
        v
    }
    #[inline]
    fn add(self, b: Self) -> Self {
        self + b
    }
    #[inline]
    fn sub(self, b: Self) -> Self {
        self - b
    }
    #[inline]
    fn mul(self, b: Self) -> Self {
        self * b
    }
    #[inline]
    fn div(self, b: Self) -> Self {
        self / b
    }
    #[inline]
    fn square(self) -> Self {
        self * self
    }
    #[inline]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline]
    fn sin(self) -> Self {
        self.sin()
    }
    #[inline]
    fn cos(self) -> Self {
        self.cos()
    }
    #[inline]
    fn exp(self) -> Self {
        self.exp()
    }
    #[inline]
    fn log(self) -> Self {
        self.ln()
    }
    #[inline]
    fn abs(self) -> Self {
        self.abs()
    }
    #[inline]
    fn floor(self) -> Self {
        self.floor()
    }
    #[inline]
    fn steps(self) -> Self {
        0.0
    }
    // What is undefined stays so.
    #[inline]
    fn min(self, b: Self) -> Self {
        if self.is_nan() || self < b { self } else { b }
    }
    #[inline]
    fn max(self, b: Self) -> Self {
        if self.is_nan() || self > b { self } else { b }
    }
    #[inline]
    fn sign(self) -> Self {
        if self < 0.0 { -1.0 } else { 1.0 }
    }
    #[inline]
    fn is_least(self, b: Self) -> Self {
        if self <= b { 1.0 } else { 0.0 }
    }
}

/// All numbers between two, which are among them; NaN where there are none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// By how much of their value the functions of the standard library may be off: four steps of `f64`.
const LOOSE: f64 = 4.0 * f64::EPSILON;

impl Interval {
    const ALL: Self = Self::new(f64::NEG_INFINITY, f64::INFINITY);
    const NONE: Self = Self::new(f64::NAN, f64::NAN);

    /// The interval between two ends.
    pub const fn new(low: f64, high: f64) -> Self {
        Self { low, high }
    }

    /// True if it contains nothing.
    #[inline]
    pub fn is_none(self) -> bool {
        self.low.is_nan() || self.high.is_nan()
    }

    /// True if the interval contains zero; not if it is empty.
    #[inline]
    pub fn has_zero(self) -> bool {
        self.low <= 0.0 && self.high >= 0.0
    }

    /// True if both ends are finite.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    /// A step further on both sides.
    #[inline]
    fn wider(self) -> Self {
        Self::new(self.low.next_down(), self.high.next_up())
    }

    /// By the error of library functions.
    #[inline]
    fn loose(self) -> Self {
        let error = |v: f64| if v.is_finite() { v.abs() * LOOSE + f64::MIN_POSITIVE } else { 0.0 };
        Self::new(self.low - error(self.low), self.high + error(self.high))
    }

    /// The part that is not negative.
    #[inline]
    fn positive(self) -> Self {
        if self.high < 0.0 { Self::NONE } else { Self::new(self.low.max(0.0), self.high) }
    }

    /// Around four numbers, of which 0·∞ is 0.
    #[inline]
    fn around(products: [f64; 4]) -> Self {
        let known = |p: f64| if p.is_nan() { 0.0 } else { p };
        let [a, b, c, d] = products;
        let (a, b, c, d) = (known(a), known(b), known(c), known(d));
        let least = |a: f64, b: f64| if a < b { a } else { b };
        let most = |a: f64, b: f64| if a > b { a } else { b };
        Self::new(least(least(a, b), least(c, d)), most(most(a, b), most(c, d)))
    }
}

impl Number for Interval {
    #[inline]
    fn constant(v: f64) -> Self {
        Self::new(v, v)
    }
    #[inline]
    fn add(self, b: Self) -> Self {
        Self::new(self.low + b.low, self.high + b.high).wider()
    }
    #[inline]
    fn sub(self, b: Self) -> Self {
        Self::new(self.low - b.high, self.high - b.low).wider()
    }
    #[inline]
    fn mul(self, b: Self) -> Self {
        if self.is_none() || b.is_none() {
            return Self::NONE;
        }
        Self::around([self.low * b.low, self.low * b.high, self.high * b.low, self.high * b.high]).wider()
    }
    #[inline]
    fn div(self, b: Self) -> Self {
        if self.is_none() || b.is_none() {
            return Self::NONE;
        }
        if b.has_zero() {
            return Self::ALL;
        }
        Self::around([self.low / b.low, self.low / b.high, self.high / b.low, self.high / b.high]).wider()
    }
    #[inline]
    fn square(self) -> Self {
        let a = self.abs();
        let s = Self::new(a.low * a.low, a.high * a.high).wider();
        Self::new(s.low.max(0.0), s.high)
    }
    #[inline]
    fn sqrt(self) -> Self {
        let a = self.positive();
        if a.is_none() {
            return a;
        }
        let s = Self::new(a.low.sqrt(), a.high.sqrt()).wider();
        Self::new(s.low.max(0.0), s.high)
    }
    #[inline]
    fn sin(self) -> Self {
        self.sub(Self::new(FRAC_PI_2.next_down(), FRAC_PI_2.next_up())).cos()
    }
    #[inline]
    fn cos(self) -> Self {
        if self.is_none() {
            return self;
        }
        let most = self.low.abs().max(self.high.abs());
        if !(self.high - self.low < TAU && most < 1e9) {
            return Self::new(-1.0, 1.0);
        }
        // Extrema are at whole half turns; those that are near the ends count.
        let slack = 1e-15 * (1.0 + most);
        let has = |from: f64| {
            let turn = ((self.low - slack - from) / TAU).ceil();
            turn * TAU + from <= self.high + slack
        };
        let (a, b) = (self.low.cos(), self.high.cos());
        let inner = Self::new(a.min(b), a.max(b)).loose();
        let low = if has(std::f64::consts::PI) { -1.0 } else { inner.low.max(-1.0) };
        Self::new(low, if has(0.0) { 1.0 } else { inner.high.min(1.0) })
    }
    #[inline]
    fn exp(self) -> Self {
        let e = Self::new(self.low.exp(), self.high.exp()).loose();
        Self::new(if e.low < 0.0 { 0.0 } else { e.low }, e.high)
    }
    #[inline]
    fn log(self) -> Self {
        let a = self.positive();
        if a.is_none() || a.high == 0.0 { Self::NONE } else { Self::new(a.low.ln(), a.high.ln()).loose() }
    }
    #[inline]
    fn floor(self) -> Self {
        Self::new(self.low.floor(), self.high.floor())
    }
    #[inline]
    fn steps(self) -> Self {
        Self::new(0.0, if self.low.floor() == self.high.floor() { 0.0 } else { f64::INFINITY })
    }
    #[inline]
    fn abs(self) -> Self {
        let (a, b) = (self.low.abs(), self.high.abs());
        if self.is_none() { self } else { Self::new(if self.has_zero() { 0.0 } else { a.min(b) }, a.max(b)) }
    }
    #[inline]
    fn min(self, b: Self) -> Self {
        Self::new(Number::min(self.low, b.low), Number::min(self.high, b.high))
    }
    #[inline]
    fn max(self, b: Self) -> Self {
        Self::new(Number::max(self.low, b.low), Number::max(self.high, b.high))
    }
    #[inline]
    fn sign(self) -> Self {
        Self::new(if self.low <= 0.0 { -1.0 } else { 1.0 }, if self.high < 0.0 { -1.0 } else { 1.0 })
    }
    #[inline]
    fn is_least(self, b: Self) -> Self {
        Self::new(if self.high <= b.low { 1.0 } else { 0.0 }, if self.low <= b.high { 1.0 } else { 0.0 })
    }
}

/// A value and its derivative.
#[derive(Clone, Copy, Debug)]
pub struct Dual<T> {
    /// The value.
    pub value: T,
    /// Its derivative.
    pub slope: T,
}

impl<T: Number> Dual<T> {
    /// A value with its derivative.
    #[inline]
    pub fn new(value: T, slope: T) -> Self {
        Self { value, slope }
    }

    /// The smaller (or larger) of two: `weight` is 1 where it is this one.
    #[inline]
    fn choose(self, b: Self, value: T, weight: T) -> Self {
        Self::new(value, weight.mul(self.slope).add(T::constant(1.0).sub(weight).mul(b.slope)))
    }
}

impl<T: Number> Number for Dual<T> {
    #[inline]
    fn constant(v: f64) -> Self {
        Self::new(T::constant(v), T::constant(0.0))
    }
    #[inline]
    fn add(self, b: Self) -> Self {
        Self::new(self.value.add(b.value), self.slope.add(b.slope))
    }
    #[inline]
    fn sub(self, b: Self) -> Self {
        Self::new(self.value.sub(b.value), self.slope.sub(b.slope))
    }
    #[inline]
    fn mul(self, b: Self) -> Self {
        Self::new(self.value.mul(b.value), self.slope.mul(b.value).add(self.value.mul(b.slope)))
    }
    #[inline]
    fn div(self, b: Self) -> Self {
        let value = self.value.div(b.value);
        Self::new(value, self.slope.sub(value.mul(b.slope)).div(b.value))
    }
    #[inline]
    fn square(self) -> Self {
        Self::new(self.value.square(), T::constant(2.0).mul(self.value).mul(self.slope))
    }
    #[inline]
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        Self::new(value, self.slope.div(T::constant(2.0).mul(value)))
    }
    #[inline]
    fn sin(self) -> Self {
        Self::new(self.value.sin(), self.value.cos().mul(self.slope))
    }
    #[inline]
    fn cos(self) -> Self {
        Self::new(self.value.cos(), T::constant(0.0).sub(self.value.sin()).mul(self.slope))
    }
    #[inline]
    fn exp(self) -> Self {
        let value = self.value.exp();
        Self::new(value, value.mul(self.slope))
    }
    #[inline]
    fn log(self) -> Self {
        Self::new(self.value.log(), self.slope.div(self.value))
    }
    #[inline]
    fn floor(self) -> Self {
        Self::new(self.value.floor(), self.value.steps().mul(self.slope))
    }
    #[inline]
    fn steps(self) -> Self {
        Self::new(self.value.steps(), T::constant(0.0))
    }
    #[inline]
    fn abs(self) -> Self {
        Self::new(self.value.abs(), self.value.sign().mul(self.slope))
    }
    #[inline]
    fn min(self, b: Self) -> Self {
        self.choose(b, self.value.min(b.value), self.value.is_least(b.value))
    }
    #[inline]
    fn max(self, b: Self) -> Self {
        self.choose(b, self.value.max(b.value), b.value.is_least(self.value))
    }
    #[inline]
    fn sign(self) -> Self {
        Self::new(self.value.sign(), T::constant(0.0))
    }
    #[inline]
    fn is_least(self, b: Self) -> Self {
        Self::new(self.value.is_least(b.value), T::constant(0.0))
    }
}
