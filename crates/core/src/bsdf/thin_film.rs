//! Interference in a thin transparent film on a dielectric or a metal (Airy summation; Born & Wolf 1999, 7.6 and 14.4).
//!
//! With the amplitudes `r₁₂` at the top of the film, `r₂₃ = |r₂₃| e^{iφ}` at its bottom and the phase `2β = 2π·2 n₂ d
//! cosθ₂/λ` of one way down and up, every polarisation is reflected in the ratio
//!
//! ```text
//! R = |(r₁₂ + r₂₃ e^{2iβ}) / (1 + r₁₂ r₂₃ e^{2iβ})|² = 1 − T Σ'_m (−q)^m cos m(2β + φ)
//! ```
//!
//! with `q = r₁₂|r₂₃|`, `T = (1 − r₁₂²)(1 − |r₂₃|²)/(1 − q²)`, and every term but the first (`m = 0`) counted twice. At
//! given wavelengths the closed form is used. For RGB the series is: `e^{2iβ}` of each term is averaged over the
//! channel's response to D65 (a table over the optical path), the rest taken at the channel. Indices are relative to
//! the medium above. Beyond the angle where the film itself reflects totally (a film of lower index) everything is
//! reflected.

use glam::DVec3;
use std::f32::consts::TAU;
use std::sync::LazyLock;
use steradian_math::{
    Spectrum,
    color::space::REC709,
    spectra::{LAMBDA_COUNT, LAMBDA_MIN, cie, d65},
};

/// A film on a base. The base's index `η − ik` is given beside it.
#[derive(Clone, Copy, Debug)]
pub struct ThinFilm {
    /// Index of the film, real, relative to the medium above.
    eta: f32,
    /// Thickness in nm.
    thickness: f32,
    /// The wavelengths in nm of the four lanes; zero in RGB.
    lambda: [f32; 4],
}

/// Largest optical path of the table of responses, nm, and its step. Beyond, the fringes of a channel cancel.
const LONGEST: f32 = 60_000.0;
const STEP: f32 = 20.0;
/// Terms of the series for RGB: `q` is below 0.7 but at grazing angles on metals.
const TERMS: usize = 8;

impl ThinFilm {
    /// A film of index `eta` (held in `[1, 5]` relative to the medium above) and thickness in nm (`[0, 100 000]`) seen
    /// at `lambda`, or in linear RGB.
    pub fn new(eta: f32, thickness: f32, lambda: Option<[f32; 4]>) -> Self {
        let thickness = if thickness > 0.0 { thickness.min(1e5) } else { 0.0 };
        let eta = if eta.is_nan() { 1.0 } else { eta.clamp(1.0, 5.0) };
        Self { eta, thickness, lambda: lambda.unwrap_or_default() }
    }

    /// The reflectance for unpolarised light at `cos_i` from above a base of index `eta − ik`.
    pub fn reflectance(&self, cos_i: f32, eta: Spectrum, k: Spectrum) -> Spectrum {
        let cos1 = cos_i.abs().min(1.0);
        let sin2 = 1.0 - cos1 * cos1;
        let cos2 = (1.0 - sin2 / (self.eta * self.eta)).max(0.0).sqrt();
        let path = 2.0 * self.eta * self.thickness * cos2;
        // Amplitudes at the top, perpendicular and parallel.
        let top = [
            (cos1 - self.eta * cos2) / (cos1 + self.eta * cos2).max(1e-12),
            (self.eta * cos1 - cos2) / (self.eta * cos1 + cos2).max(1e-12),
        ];
        let mut lanes = [0.0; 4];
        for (i, lane) in lanes.iter_mut().enumerate() {
            let base = Complex { re: eta[i], im: k[i] };
            let cos3 = base.refracted_cosine(sin2);
            let bottom = amplitudes(self.eta, cos2, base, cos3);
            let lambda = self.lambda[i];
            let of = |r12: f32, r23: Complex| match (lambda > 0.0, i) {
                (true, _) => airy(r12, r23, TAU * path / lambda),
                (false, 3) => 0.0,
                (false, _) => series(r12, r23, path, i),
            };
            let mean = 0.5 * (of(top[0], bottom[0]) + of(top[1], bottom[1]));
            *lane = if mean.is_finite() { mean.clamp(0.0, 1.0) } else { 1.0 };
        }
        Spectrum::new(lanes)
    }
}

/// A complex number of which only what is needed here exists.
#[derive(Clone, Copy, Debug)]
struct Complex {
    re: f32,
    im: f32,
}

impl Complex {
    fn mul(self, b: Self) -> Self {
        Self { re: self.re * b.re - self.im * b.im, im: self.re * b.im + self.im * b.re }
    }

    fn scaled(self, k: f32) -> Self {
        Self { re: self.re * k, im: self.im * k }
    }

    fn sub(self, b: Self) -> Self {
        Self { re: self.re - b.re, im: self.im - b.im }
    }

    fn add(self, b: Self) -> Self {
        Self { re: self.re + b.re, im: self.im + b.im }
    }

    fn div(self, b: Self) -> Self {
        let d = (b.re * b.re + b.im * b.im).max(1e-30);
        Self { re: (self.re * b.re + self.im * b.im) / d, im: (self.im * b.re - self.re * b.im) / d }
    }

    fn sqrt(self) -> Self {
        let m = self.re.hypot(self.im);
        Self { re: (0.5 * (m + self.re)).max(0.0).sqrt(), im: (0.5 * (m - self.re)).max(0.0).sqrt().copysign(self.im) }
    }

    fn norm(self) -> f32 {
        self.re.hypot(self.im)
    }

    fn argument(self) -> f32 {
        self.im.atan2(self.re)
    }

    /// `cosθ₃` in the base of this index `η + ik` for the squared sine in the medium above. Fields decay into the base.
    fn refracted_cosine(self, sin2: f32) -> Self {
        let n2 = self.mul(self);
        let c = Self { re: 1.0, im: 0.0 }.sub(Self { re: sin2, im: 0.0 }.div(n2)).sqrt();
        // n cosθ must have a positive imaginary part.
        if self.mul(c).im < 0.0 { c.scaled(-1.0) } else { c }
    }
}

/// Amplitudes of reflection where light in the film meets the base, perpendicular and parallel.
fn amplitudes(film: f32, cos2: f32, base: Complex, cos3: Complex) -> [Complex; 2] {
    let real = |re: f32| Complex { re, im: 0.0 };
    let of = |a: Complex, b: Complex| a.sub(b).div(a.add(b));
    [of(real(film * cos2), base.mul(cos3)), of(base.scaled(cos2), cos3.scaled(film))]
}

/// Airy's sum at the phase `2β`.
fn airy(r12: f32, r23: Complex, phase: f32) -> f32 {
    let (b, q) = (r23.norm(), r12 * r23.norm());
    let twice = 2.0 * q * (phase + r23.argument()).cos();
    (r12 * r12 + b * b + twice) / (1.0 + q * q + twice).max(1e-12)
}

/// The same sum as a series, averaged over a channel of RGB.
fn series(r12: f32, r23: Complex, path: f32, channel: usize) -> f32 {
    let (b, shift) = (r23.norm().min(1.0), r23.argument());
    let q = (r12 * b).clamp(-0.9999, 0.9999);
    let mean = (1.0 - r12 * r12) * (1.0 - b * b) / (1.0 - q * q);
    let (mut sum, mut power) = (1.0, 1.0);
    for m in 1..=TERMS {
        power *= -q;
        let order = m as f32;
        let (sin, cos) = (order * shift).sin_cos();
        let [re, im] = response(order * path, channel);
        sum += 2.0 * power * (re * cos - im * sin);
    }
    1.0 - mean * sum
}

/// The mean of `exp(2πi·path/λ)` over what a channel of linear Rec.709 sees of a white surface under D65.
fn response(path: f32, channel: usize) -> [f32; 2] {
    static TABLE: LazyLock<Vec<[[f32; 2]; 3]>> = LazyLock::new(|| {
        (0..=(LONGEST / STEP) as usize + 1).map(|i| mean_phasor(i as f64 * f64::from(STEP))).collect()
    });
    let x = path / STEP;
    let i = x as usize;
    if i + 1 >= TABLE.len() {
        return [0.0; 2];
    }
    let (a, b, t) = (TABLE[i][channel], TABLE[i + 1][channel], x - i as f32);
    [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t]
}

fn observer(lambda: f64) -> DVec3 {
    DVec3::from(cie::matching(lambda as f32).map(f64::from))
}

fn mean_phasor(path: f64) -> [[f32; 2]; 3] {
    let to_rgb = REC709.rgb_from_xyz();
    let lambda = |i: usize| f64::from(LAMBDA_MIN) + i as f64;
    let mut sums = [[0.0f64; 3]; 3];
    for i in 0..LAMBDA_COUNT {
        let white = f64::from(d65().values()[i]);
        let rgb = to_rgb * (observer(lambda(i)) * white);
        let (sin, cos) = (std::f64::consts::TAU * path / lambda(i)).sin_cos();
        for (s, w) in sums.iter_mut().zip(rgb.to_array()) {
            s[0] += w * cos;
            s[1] += w * sin;
            s[2] += w;
        }
    }
    sums.map(|s| [(s[0] / s[2]) as f32, (s[1] / s[2]) as f32])
}

#[cfg(test)]
mod tests {
    use super::super::fresnel;
    use super::*;
    use steradian_math::Vec3;

    fn splat(v: f32) -> Spectrum {
        Spectrum::splat(v)
    }

    #[test]
    fn no_film_and_a_film_like_the_base_reflect_as_the_base() {
        let gold = (splat(0.37), splat(2.82));
        for cos in [1.0, 0.7, 0.3, 0.05] {
            for lambda in [None, Some([450.0, 550.0, 600.0, 650.0])] {
                let film = ThinFilm::new(1.4, 0.0, lambda).reflectance(cos, gold.0, gold.1);
                let bare = fresnel::conductor(cos, gold.0, gold.1);
                assert!((0..3).all(|i| (film[i] - bare[i]).abs() < 3e-3), "{cos}: {film:?} is not {bare:?}");
                let glass = ThinFilm::new(1.5, 300.0, lambda).reflectance(cos, splat(1.5), Spectrum::ZERO);
                assert!((0..3).all(|i| (glass[i] - fresnel::dielectric(cos, 1.5)).abs() < 1e-4));
            }
        }
    }

    /// A quarter of a wavelength of index √n makes glass reflect nothing; half a wavelength does nothing.
    #[test]
    fn quarter_and_half_wave_coatings_do_what_they_are_made_for() {
        let n = 2.25f32;
        let at = |thickness| {
            let lambda = Some([550.0; 4]);
            ThinFilm::new(n.sqrt(), thickness, lambda).reflectance(1.0, splat(n), Spectrum::ZERO)[0]
        };
        let wave = 550.0 / n.sqrt();
        assert!(at(0.25 * wave) < 1e-6, "{}", at(0.25 * wave));
        assert!((at(0.5 * wave) - fresnel::f0_from_eta(n)).abs() < 1e-6);
        assert!(at(0.25 * wave + 30.0) > 1e-3);
    }

    /// Newton's colours of a soap film as it grows (M132): white of the first order, then without blue, without green, and without red.
    #[test]
    fn colours_of_a_growing_film_come_in_their_order() {
        let seen =
            |thickness| ThinFilm::new(1.33, thickness, None).reflectance(1.0, Spectrum::ONE, Spectrum::ZERO).to_rgb();
        let black = seen(5.0);
        assert!(black.iter().all(|v| *v < 2e-3), "thinner than light is black: {black:?}");
        let [white, amber, magenta, blue] = [100.0, 165.0, 205.0, 250.0].map(seen);
        let least = |c: [f32; 3]| (0..3).min_by(|a, b| c[*a].total_cmp(&c[*b]));
        assert!(white.iter().all(|v| *v > 0.75 * white[1]), "{white:?}");
        assert_eq!(
            (least(amber), least(magenta), least(blue)),
            (Some(2), Some(1), Some(0)),
            "{amber:?} {magenta:?} {blue:?}"
        );
    }

    /// RGB is the average of the spectral sum under the response of each channel.
    #[test]
    fn the_series_for_rgb_is_the_average_over_wavelengths() {
        let to_rgb = REC709.rgb_from_xyz();
        for (base, k, thickness) in [(1.5, 0.0, 400.0), (0.4, 2.8, 250.0), (2.0, 0.5, 1500.0)] {
            for cos in [1.0f32, 0.5] {
                let (mut sum, mut white) = (DVec3::ZERO, DVec3::ZERO);
                for i in 0..LAMBDA_COUNT {
                    let lambda = LAMBDA_MIN + i as f32;
                    let r =
                        ThinFilm::new(1.33, thickness, Some([lambda; 4])).reflectance(cos, splat(base), splat(k))[0];
                    let w = to_rgb * (observer(f64::from(lambda)) * f64::from(d65().values()[i]));
                    sum += w * f64::from(r);
                    white += w;
                }
                let exact = (sum / white).as_vec3().clamp(Vec3::ZERO, Vec3::ONE);
                let rgb = ThinFilm::new(1.33, thickness, None).reflectance(cos, splat(base), splat(k));
                let rgb = Vec3::from(rgb.to_rgb());
                assert!(
                    (rgb - exact).abs().max_element() < 3e-3,
                    "{base}, {thickness} nm, {cos}: {rgb} is not {exact}"
                );
            }
        }
    }
}
