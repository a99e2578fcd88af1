//! Elementary functions in single precision that the system's library is slow at, from sums, products and quotients, to
//! be inlined; with the same bits on every machine, which that library does not promise.
//!
//! Exponentials and logarithms are computed in double precision, which needs no second word for what the reduction of
//! the range rounds off, with few terms (Taylor's, of which the first is exact) in pairs, which wait less for each
//! other. Sine, cosine and arctangent are those of the Cephes library (Moshier 1989). Errors are as the tests have it.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};
use std::f64::consts::{LN_2, LOG2_E, SQRT_2};

/// Steps of the table of powers per octave.
const STEPS: usize = 32;

/// `2^(i/32)`.
const POWERS: [f64; STEPS] = [
    1.0,
    1.0218971486541166,
    1.0442737824274138,
    1.0671404006768237,
    1.0905077326652577,
    1.1143867425958924,
    1.1387886347566916,
    1.1637248587775775,
    1.189207115002721,
    1.215247359980469,
    1.241857812073484,
    1.2690509571917332,
    1.2968395546510096,
    1.3252366431597413,
    1.3542555469368927,
    1.383909881963832,
    SQRT_2,
    1.4451808069770467,
    1.4768261459394993,
    1.5091644275934228,
    1.5422108254079407,
    1.5759808451078865,
    1.6104903319492543,
    1.645755478153965,
    1.681792830507429,
    1.718619298122478,
    1.7562521603732995,
    1.7947090750031072,
    1.8340080864093424,
    1.8741676341103,
    1.9152065613971474,
    1.9571441241754002,
];

/// Steps of the table from 1 to e.
const STEPS_TO_E: f64 = STEPS as f64 * LOG2_E;

/// `2^(i/32)` and `2^(r/32) − 1`, of which `2^(s/32)` for `s` steps is the product, with `i` the nearest integer and
/// the second relative to one: for `|s| < 32000`. The error of the second is below 6·10⁻⁸ of it.
#[inline(always)]
fn power_and_rest(steps: f64) -> (f64, f64) {
    // Added and taken away again, this rounds to an integer, which the low bits of the sum hold.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    const LN: f64 = LN_2 / STEPS as f64;
    let shifted = steps + ROUND;
    let r = steps - (shifted - ROUND);
    let n = shifted.to_bits();
    let power = POWERS[n as usize % STEPS].to_bits().wrapping_add((n >> 5) << 52);
    (f64::from_bits(power), r * LN + (r * r) * (0.5 * LN * LN + r * (LN * LN * LN / 6.0)))
}

/// `2^(s/32)` for `s` steps, rounded to single precision.
#[inline(always)]
fn power_of(steps: f64) -> f32 {
    if steps.abs() > 32_000.0 {
        return if steps > 0.0 { f32::INFINITY } else { 0.0 };
    }
    let (power, rest) = power_and_rest(steps);
    (power + power * rest) as f32
}

/// `eˣ`, relative error below 10⁻⁷.
#[inline(always)]
pub fn exp(x: f32) -> f32 {
    power_of(f64::from(x) * STEPS_TO_E)
}

/// `eˣ − 1`, relative error below 2·10⁻⁷, near zero too.
#[inline]
pub fn exp_m1(x: f32) -> f32 {
    if x.abs() > 600.0 {
        return if x > 0.0 { f32::INFINITY } else { -1.0 };
    }
    let (power, rest) = power_and_rest(f64::from(x) * STEPS_TO_E);
    ((power - 1.0) + power * rest) as f32
}

/// Intervals of `m` in `x = 2ᵉ m`, from the one that begins at these bits of a double.
const INTERVALS: usize = 16;
const FIRST: i64 = 0x3fe6_6000_0000_0000;

/// `1/c` and `log₂ c` of a number `c` near the middle of each interval, one in the interval about it.
const MIDDLES: [[f64; 2]; INTERVALS] = [
    [1.39892578125, -0.4843194236442672],
    [1.34033203125, -0.422590433892561],
    [1.286376953125, -0.3633134643734775],
    [1.23681640625, -0.306631361712501],
    [1.190673828125, -0.25177825703586765],
    [1.14794921875, -0.19905882365302136],
    [1.108154296875, -0.14815877293789334],
    [1.071044921875, -0.09901899101923065],
    [1.036376953125, -0.05154883844040085],
    [1.0, 0.0],
    [0.9482421875, 0.07667251458080775],
    [0.89501953125, 0.16000892946011427],
    [0.84765625, 0.2384487675555207],
    [0.804931640625, 0.3130618283296127],
    [0.766357421875, 0.38391068641788484],
    [0.7314453125, 0.45117809154124894],
];

/// `log₂ x` of a positive, normal number, in double precision to 10⁻⁸ of it.
#[inline(always)]
fn log2_of(x: f64) -> f64 {
    let bits = x.to_bits() as i64;
    let from_first = bits.wrapping_sub(FIRST);
    let [inverse, log2] = MIDDLES[(from_first >> 48) as usize % INTERVALS];
    let e = from_first >> 52;
    let m = f64::from_bits(bits.wrapping_sub(e << 52) as u64);
    let r = m * inverse - 1.0;
    let r2 = r * r;
    let series = (r * (LOG2_E / 3.0) - 0.5 * LOG2_E) + r2 * (r * (LOG2_E / 5.0) - 0.25 * LOG2_E);
    ((f64::from(e as i32) + log2) + r * LOG2_E) + r2 * series
}

/// `ln x`, relative error below 10⁻⁷; of the smallest normal number where `x` is not above it.
#[inline]
pub fn ln(x: f32) -> f32 {
    (log2_of(f64::from(x.max(f32::MIN_POSITIVE))) * LN_2) as f32
}

/// `ln(1 + x)`, relative error below 2·10⁻⁷, near zero too; −∞ up to −1.
#[inline(always)]
pub fn ln_1p(x: f32) -> f32 {
    if x <= -1.0 {
        return f32::NEG_INFINITY;
    }
    let x = f64::from(x);
    let near = x - (x * x) * (0.5 - x * (1.0 / 3.0));
    (if x.abs() < 1e-4 { near } else { log2_of(1.0 + x) * LN_2 }) as f32
}

/// `xʸ` for `x ≥ 0`, relative error below 10⁻⁷ (1 + |y ln x|/50); `x` below the smallest normal number counts as that.
#[inline]
pub fn pow(x: f32, y: f32) -> f32 {
    power_of((f64::from(y) * STEPS as f64) * log2_of(f64::from(x.max(f32::MIN_POSITIVE))))
}

/// An exponent of many powers. Where its double is a small integer they are products, with a root at most, which take
/// less time than logarithms.
#[derive(Clone, Copy, Debug)]
pub struct Exponent {
    value: f32,
    /// Its double, if that is an integer within ±255.
    twice: Option<i16>,
}

impl Exponent {
    /// A finite one.
    pub fn new(value: f32) -> Self {
        let twice = 2.0 * value;
        Self { value, twice: (twice.abs() < 256.0 && twice.fract() == 0.0).then_some(twice as i16) }
    }

    /// Its value.
    #[inline]
    pub const fn value(self) -> f32 {
        self.value
    }

    /// The power of a positive, normal number, with the error of [`pow`].
    #[inline(always)]
    pub fn power(self, x: f64) -> f32 {
        let Some(twice) = self.twice else { return power_of((f64::from(self.value) * STEPS as f64) * log2_of(x)) };
        let (n, mut power) = (twice.unsigned_abs(), whole_power(x, twice.unsigned_abs() >> 1));
        if n & 1 == 1 {
            power *= x.sqrt();
        }
        (if twice < 0 { 1.0 / power } else { power }) as f32
    }
}

/// `xⁿ` by multiplication.
#[inline(always)]
fn whole_power(mut x: f64, mut n: u16) -> f64 {
    let mut power = if n & 1 == 1 { x } else { 1.0 };
    while n > 1 {
        n >>= 1;
        x *= x;
        if n & 1 == 1 {
            power *= x;
        }
    }
    power
}

/// `xʸ` for normal `x > 0`, and how much it is above one, with relative errors below 2·10⁻⁷ of each: for
/// `|y ln x| < 690`.
#[inline]
pub fn pow_and_excess(x: f32, y: f32) -> (f32, f32) {
    let (power, rest) = power_and_rest((f64::from(y) * STEPS as f64) * log2_of(f64::from(x)));
    let excess = (power - 1.0) + power * rest;
    ((1.0 + excess) as f32, excess as f32)
}

/// Sine and cosine of `2π turns`, for up to a million turns, absolute error below 2·10⁻⁷: polynomials for a quarter
/// turn to either side, through the roots of Chebyshev's.
#[inline(always)]
pub fn sin_cos_turns(turns: f32) -> (f32, f32) {
    // Added and taken away again, this rounds to an integer, which the low bits of the sum hold.
    const ROUND: f32 = 12_582_912.0;
    let halves = 2.0 * turns;
    let shifted = halves + ROUND;
    let x = halves - (shifted - ROUND);
    let (q, q2) = (x * x, (x * x) * (x * x));
    let series = |c: [f32; 5]| (c[0] + c[1] * q) + q2 * ((c[2] + c[3] * q) + q2 * c[4]);
    let sin = x * series([PI, -5.1677127, 2.550_136, -0.5987049, 0.078539714]);
    let cos = 1.0 + q * series([-4.934802, 4.0587115, -1.33524, 0.23507437, -0.024627112]);
    // After an odd number of half turns both change their signs.
    let sign = shifted.to_bits() << 31;
    (f32::from_bits(sin.to_bits() ^ sign), f32::from_bits(cos.to_bits() ^ sign))
}

/// Sine and cosine of an angle in radians, for up to a million turns; absolute error below 2·10⁻⁷ within some turns.
#[inline]
pub fn sin_cos(angle: f32) -> (f32, f32) {
    sin_cos_turns(angle * (1.0 / TAU))
}

/// The angle whose cosine is `x` in `[0, 1]`, absolute error below 3·10⁻⁷ (Abramowitz & Stegun 1964, 4.4.46).
#[inline]
pub fn acos(x: f32) -> f32 {
    const C: [f32; 8] = [
        -0.001_262_491_1,
        0.006_670_09,
        -0.017_088_126,
        0.030_891_88,
        -0.050_174_303,
        0.088_978_99,
        -0.214_598_8,
        FRAC_PI_2,
    ];
    (1.0 - x).max(0.0).sqrt() * C.into_iter().fold(0.0, |s, c| s * x + c)
}

/// The angle whose sine is `x`, held in `[−1, 1]`.
#[inline]
pub fn asin(x: f32) -> f32 {
    atan2(x, (1.0 - x * x).max(0.0).sqrt())
}

/// Sine and cosine of `¼π x` for `x` within ±1, absolute error below 2·10⁻⁷: polynomials by least squares.
#[inline(always)]
pub fn sin_cos_octant(x: f32) -> (f32, f32) {
    let q = x * x;
    let sin = x * FRAC_PI_4 + (x * q) * ((-0.080_745_43 + q * 0.0024899836) + (q * q) * -0.0000359351);
    let cos = 1.0 + q * ((-0.30842448 + q * 0.015850354) + (q * q) * -0.0003191315);
    (sin, cos)
}

/// The angle of the vector `(x, y)` with `y ≥ 0`, in `[0, π]`; zero for the zero vector. Error below 4·10⁻¹⁶ of it
/// (Cephes).
#[inline(always)]
pub fn angle_f64(y: f64, x: f64) -> f64 {
    const P: [f64; 5] = [
        -8.750_608_600_031_904e-1,
        -1.615_753_718_733_365e1,
        -7.500_855_792_314_705e1,
        -1.228_866_684_490_136_2e2,
        -6.485_021_904_942_025e1,
    ];
    const Q: [f64; 6] = [
        1.0,
        2.485_846_490_142_306_2e1,
        1.650_270_098_316_988_5e2,
        4.328_810_604_912_903e2,
        4.853_903_996_359_137e2,
        1.945_506_571_482_614e2,
    ];
    // Of the angle to the nearer axis, beyond 0.66 of which an eighth of the circle is taken off.
    let ax = x.abs();
    let is_high = y > ax;
    let (low, high) = if is_high { (ax, y) } else { (y, ax) };
    let is_far = low > 0.66 * high;
    let (above, below) = if is_far { (low - high, low + high) } else { (low, high) };
    let t = above / if below == 0.0 { 1.0 } else { below };
    let q = t * t;
    let p = P[4] + q * (P[3] + q * (P[2] + q * (P[1] + q * P[0])));
    let r = Q[5] + q * (Q[4] + q * (Q[3] + q * (Q[2] + q * (Q[1] + q * Q[0]))));
    let angle = if is_far { std::f64::consts::FRAC_PI_4 } else { 0.0 } + (t + t * (q * p / r));
    let angle = if is_high { std::f64::consts::FRAC_PI_2 - angle } else { angle };
    if x < 0.0 { std::f64::consts::PI - angle } else { angle }
}

/// Sine and cosine of an angle in radians, within some turns; absolute error below 10⁻¹⁵ (the series of fdlibm).
#[inline(always)]
pub fn sin_cos_f64(x: f64) -> (f64, f64) {
    // Added and taken away again, this rounds to an integer, which the low bits of the sum hold.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    let shifted = x * std::f64::consts::FRAC_2_PI + ROUND;
    let quarters = shifted - ROUND;
    // π/2 in two parts.
    let r = (x - quarters * 1.570_796_326_734_125_6) - quarters * 6.077_100_506_506_192e-11;
    let q = r * r;
    let sin = r
        + (r * q)
            * (-0.166_666_666_666_666_32
                + q * (8.333_333_333_322_49e-3
                    + q * (-1.984_126_982_985_795e-4
                        + q * (2.755_731_370_707_007e-6
                            + q * (-2.505_076_025_340_686_3e-8 + q * 1.589_690_995_211_55e-10)))));
    let cos = (1.0 - 0.5 * q)
        + (q * q)
            * (4.166_666_666_666_66e-2
                + q * (-1.388_888_888_887_411e-3
                    + q * (2.480_158_728_947_673e-5
                        + q * (-2.755_731_435_139_066_3e-7
                            + q * (2.087_572_321_298_175e-9 - q * 1.135_964_755_778_819_5e-11)))));
    let n = shifted.to_bits();
    let (a, b) = if n & 1 == 1 { (cos, sin) } else { (sin, cos) };
    let (flip_sin, flip_cos) = ((n & 2) << 62, ((n + 1) & 2) << 62);
    (f64::from_bits(a.to_bits() ^ flip_sin), f64::from_bits(b.to_bits() ^ flip_cos))
}

/// The angle of the vector `(x, y)` in `[−π, π]`; zero for the zero vector.
#[inline]
pub fn atan2(y: f32, x: f32) -> f32 {
    let (ax, ay) = (x.abs(), y.abs());
    let (lo, hi) = if ax < ay { (ax, ay) } else { (ay, ax) };
    if hi == 0.0 {
        return 0.0;
    }
    // Beyond tan(π/8) an eighth of the circle is taken off.
    let (t, offset) = if lo > 0.414_213_56 * hi { ((lo - hi) / (lo + hi), FRAC_PI_4) } else { (lo / hi, 0.0) };
    let q = t * t;
    let series = [8.053_745e-2, -1.387_768_6e-1, 1.997_771e-1, -3.333_295e-1].into_iter().fold(0.0, |s, c| s * q + c);
    let angle = offset + (series * q * t + t);
    let angle = if ax < ay { FRAC_PI_2 - angle } else { angle };
    let angle = if x < 0.0 { PI - angle } else { angle };
    angle.copysign(y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_in_double_precision_are_those_of_the_library() {
        let n = 100_000;
        for k in 0..=n {
            let x = f64::from(k) / f64::from(n);
            let angle = (x - 0.5) * 25.0;
            let ((s, c), (sin, cos)) = (sin_cos_f64(angle), angle.sin_cos());
            assert!((s - sin).abs() < 1e-15 && (c - cos).abs() < 1e-15, "{angle}");
            let (y, x) = ((x * std::f64::consts::PI).sin(), (x * std::f64::consts::PI).cos());
            assert!((angle_f64(y, x) - y.atan2(x)).abs() < 4e-16 * (1.0 + y.atan2(x)), "{y} {x}");
        }
        assert_eq!(
            [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0)].map(|(y, x)| angle_f64(y, x)),
            [0.0, 0.0, std::f64::consts::FRAC_PI_2]
        );
        assert_eq!(angle_f64(0.0, -1.0), std::f64::consts::PI);
    }

    /// The largest relative error against double precision, of numbers spread over a range.
    fn worst(range: (f32, f32), f: fn(f32) -> f32, truth: fn(f64) -> f64) -> f64 {
        let n = 200_000;
        (0..=n)
            .map(|i| range.0 + (range.1 - range.0) * i as f32 / n as f32)
            .map(|x| {
                let t = truth(f64::from(x));
                if t == 0.0 { f64::from(f(x)).abs() } else { (f64::from(f(x)) / t - 1.0).abs() }
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn exponentials_and_logarithms_are_right_to_the_last_digits() {
        for range in [(-1e-3, 1e-3), (-1.0, 1.0), (-20.0, 20.0)] {
            assert!(worst(range, exp_m1, f64::exp_m1) < 2e-7, "{range:?}: {}", worst(range, exp_m1, f64::exp_m1));
        }
        for range in [(-1e-4, 1e-4), (-0.99, 3.0), (0.0, 1e6)] {
            assert!(worst(range, ln_1p, f64::ln_1p) < 2e-7, "{range:?}: {}", worst(range, ln_1p, f64::ln_1p));
        }
        assert_eq!((exp_m1(-200.0), exp_m1(200.0), ln_1p(-1.0)), (-1.0, f32::INFINITY, f32::NEG_INFINITY));
        assert!(exp_m1(f32::NAN).is_nan());
    }

    #[test]
    fn powers_are_right_to_the_last_digits() {
        for range in [(-1e-3, 1e-3), (-1.0, 1.0), (-20.0, 20.0), (-87.3, 88.7)] {
            assert!(worst(range, exp, f64::exp) < 1e-7, "{range:?}: {}", worst(range, exp, f64::exp));
        }
        for range in [(1e-6, 0.9), (0.9, 1.1), (1.1, 3.0), (1.0, 1e30)] {
            assert!(worst(range, ln, f64::ln) < 1e-7, "{range:?}: {}", worst(range, ln, f64::ln));
        }
        for y in [1.0f32, 30.0, 1e6] {
            for x in [1e-8f32, -1e-8, 1e-6, -1e-5, 1e-3, -0.3, 0.7] {
                let exponent = f64::from(y) * f64::from(x).ln_1p();
                let error = (f64::from(Exponent::new(y).power(1.0 + f64::from(x))) / exponent.exp() - 1.0).abs();
                assert!(exponent.abs() > 87.0 || error < 1e-7 * (1.0 + exponent.abs() / 50.0), "{x}, {y}: {error}");
            }
        }
        for y in [0.0f32, 0.5, 1.0, -3.0, -2.5, 0.7, 30.0, 16383.5, 1e6] {
            for x in [1.0f64, 1.0 - 1e-8, 0.9999, 1.02, 0.5, 1e-4] {
                let truth = x.powf(f64::from(y));
                let error = (f64::from(Exponent::new(y).power(x)) / truth - 1.0).abs();
                assert!(!(1e-35..1e38).contains(&truth) || error < 2e-7, "{x} to the {y}: {error}");
            }
        }
        for (x, y) in [(0.5f32, 1e-6f32), (0.999, 1e-3), (0.1, 0.3), (1e-7, -2.0), (1.0 - 6e-8, 0.1)] {
            let ((power, excess), ln) = (pow_and_excess(x, y), f64::from(y) * f64::from(x).ln());
            assert!((f64::from(power) / ln.exp() - 1.0).abs() < 2e-7, "{x} to the {y}: {power}");
            assert!((f64::from(excess) / ln.exp_m1() - 1.0).abs() < 2e-7, "{x} to the {y}, less one: {excess}");
        }
        for y in [-1.0f32, 0.1, 1.0, 5.0, 80.0, 1e5] {
            for i in 1..=20_000 {
                let x = i as f32 / 20_000.0;
                let (exponent, truth) = (f64::from(y) * f64::from(x).ln(), f64::from(x).powf(f64::from(y)));
                let error = (f64::from(pow(x, y)) / truth - 1.0).abs();
                assert!(exponent < -87.0 || error < 1e-7 * (1.0 + exponent.abs() / 50.0), "{x} to the {y}: {error}");
            }
        }
        assert_eq!((exp(-200.0), exp(0.0), exp(200.0), ln(1.0), pow(0.0, 2.0)), (0.0, 1.0, f32::INFINITY, 0.0, 0.0));
        assert_eq!((exp(-1e30), exp(1e30), exp_m1(-1e30)), (0.0, f32::INFINITY, -1.0));
        assert!(exp(f32::NAN).is_nan() && ln(0.0) < -87.0);
        for i in -1000..=1000 {
            let x = i as f32 * 1e-3;
            assert!((f64::from(asin(x)) - f64::from(x).asin()).abs() < 5e-7, "{x}");
            assert!(x < 0.0 || (f64::from(acos(x)) - f64::from(x).acos()).abs() < 3e-7, "{x}");
        }
    }

    #[test]
    fn angles_are_right_to_the_last_digits() {
        for i in -4000..=4000 {
            let x = i as f32 * 1e-3;
            let (s, c) = sin_cos_turns(x);
            let (t, u) = (f64::from(x) * std::f64::consts::TAU).sin_cos();
            assert!((f64::from(s) - t).abs() < 2e-7 && (f64::from(c) - u).abs() < 2e-7, "{x} turns: {s} {c}");
            let y = (i % 37) as f32 * 0.1 - 1.8;
            let (found, truth) = (f64::from(atan2(y, x)), f64::from(y).atan2(f64::from(x)));
            assert!((found - truth).abs() < 5e-7, "({x}, {y}): {found} {truth}");
        }
        let (s, c) = sin_cos_octant(1.0);
        assert!((s - c).abs() < 2e-7 && (s * s + c * c - 1.0).abs() < 2e-7);
        assert_eq!(atan2(0.0, 0.0), 0.0);
    }
}
