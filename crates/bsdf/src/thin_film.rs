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

use std::sync::LazyLock;
use steradian_math::{
    DVec3, Spectrum, Vec4,
    color::space::REC709,
    elementary::sin_cos_turns,
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
        let base = Complex { re: eta.0, im: k.0 };
        let bottom = amplitudes(self.eta, cos2, base, base.refracted_cosine(sin2));
        // Amplitudes at the top, perpendicular and parallel, each with that at the bottom.
        let pairs = [
            ((cos1 - self.eta * cos2) / (cos1 + self.eta * cos2).max(1e-12), bottom[0]),
            ((self.eta * cos1 - cos2) / (self.eta * cos1 + cos2).max(1e-12), bottom[1]),
        ];
        let sum = if self.lambda[0] > 0.0 {
            let phase = Complex::phase(self.lambda.map(|l| path / l));
            pairs.map(|(top, bottom)| airy(top, bottom, phase))
        } else {
            series(pairs, path)
        };
        let mean = 0.5 * (sum[0] + sum[1]);
        let sound = Vec4::select(mean.is_finite_mask(), mean.clamp(Vec4::ZERO, Vec4::ONE), Vec4::ONE);
        Spectrum(if self.lambda[0] > 0.0 { sound } else { sound.with_w(0.0) })
    }
}

/// A complex number in each lane, of which only what is needed here exists.
#[derive(Clone, Copy, Debug)]
struct Complex {
    re: Vec4,
    im: Vec4,
}

impl Complex {
    /// `exp(2πi turns)`.
    fn phase(turns: [f32; 4]) -> Self {
        let parts = turns.map(sin_cos_turns);
        Self { re: Vec4::from_array(parts.map(|p| p.1)), im: Vec4::from_array(parts.map(|p| p.0)) }
    }

    #[inline]
    fn mul(self, b: Self) -> Self {
        Self { re: self.re * b.re - self.im * b.im, im: self.re * b.im + self.im * b.re }
    }

    #[inline]
    fn scaled(self, k: f32) -> Self {
        Self { re: self.re * k, im: self.im * k }
    }

    #[inline]
    fn sub(self, b: Self) -> Self {
        Self { re: self.re - b.re, im: self.im - b.im }
    }

    #[inline]
    fn add(self, b: Self) -> Self {
        Self { re: self.re + b.re, im: self.im + b.im }
    }

    #[inline]
    fn div(self, b: Self) -> Self {
        let d = (b.re * b.re + b.im * b.im).max(Vec4::splat(1e-30));
        Self { re: (self.re * b.re + self.im * b.im) / d, im: (self.im * b.re - self.re * b.im) / d }
    }

    #[inline]
    fn sqrt(self) -> Self {
        let m = self.norm();
        let root = |v: Vec4| (0.5 * v).max(Vec4::ZERO).sqrt();
        Self { re: root(m + self.re), im: root(m - self.re).copysign(self.im) }
    }

    #[inline]
    fn norm(self) -> Vec4 {
        (self.re * self.re + self.im * self.im).sqrt()
    }

    /// The number as a length and a direction of length one (or zero).
    #[inline]
    fn polar(self) -> (Vec4, Self) {
        let norm = self.norm();
        let inverse = norm.max(Vec4::splat(1e-30)).recip();
        (norm, Self { re: self.re * inverse, im: self.im * inverse })
    }

    /// `cosθ₃` in the base of this index `η + ik` for the squared sine in the medium above. Fields decay into the base.
    fn refracted_cosine(self, sin2: f32) -> Self {
        let real = |re: f32| Self { re: Vec4::splat(re), im: Vec4::ZERO };
        let c = real(1.0).sub(real(sin2).div(self.mul(self))).sqrt();
        // n cosθ must have a positive imaginary part.
        let grows = self.mul(c).im.cmplt(Vec4::ZERO);
        Self { re: Vec4::select(grows, -c.re, c.re), im: Vec4::select(grows, -c.im, c.im) }
    }
}

/// Amplitudes of reflection where light in the film meets the base, perpendicular and parallel.
fn amplitudes(film: f32, cos2: f32, base: Complex, cos3: Complex) -> [Complex; 2] {
    let real = |re: f32| Complex { re: Vec4::splat(re), im: Vec4::ZERO };
    let of = |a: Complex, b: Complex| a.sub(b).div(a.add(b));
    [of(real(film * cos2), base.mul(cos3)), of(base.scaled(cos2), cos3.scaled(film))]
}

/// Airy's sum at the phase `e^{2iβ}`.
fn airy(r12: f32, r23: Complex, phase: Complex) -> Vec4 {
    let b2 = r23.re * r23.re + r23.im * r23.im;
    let twice = 2.0 * r12 * r23.mul(phase).re;
    (Vec4::splat(r12 * r12) + b2 + twice) / (Vec4::ONE + r12 * r12 * b2 + twice).max(Vec4::splat(1e-12))
}

/// Airy's sums of both polarisations as a series, averaged over the channels of RGB.
fn series(pairs: [(f32, Complex); 2], path: f32) -> [Vec4; 2] {
    let responses: [Complex; TERMS] = std::array::from_fn(|m| response((m + 1) as f32 * path));
    pairs.map(|(r12, r23)| {
        let (norm, direction) = r23.polar();
        let b = norm.min(Vec4::ONE);
        let q = (r12 * b).clamp(Vec4::splat(-0.9999), Vec4::splat(0.9999));
        let mean = (1.0 - r12 * r12) * (Vec4::ONE - b * b) / (Vec4::ONE - q * q);
        // (−q e^{iφ})^m by repeated multiplication.
        let factor = Complex { re: -q * direction.re, im: -q * direction.im };
        let (mut power, mut sum) = (factor, Vec4::ONE);
        for response in responses {
            sum += 2.0 * power.mul(response).re;
            power = power.mul(factor);
        }
        Vec4::ONE - mean * sum
    })
}

/// The mean of `exp(2πi·path/λ)` over what the channels of linear Rec.709 see of a white surface under D65.
fn response(path: f32) -> Complex {
    static TABLE: LazyLock<Vec<Complex>> = LazyLock::new(|| {
        let lanes = |of: [[f32; 2]; 3], i: usize| Vec4::new(of[0][i], of[1][i], of[2][i], 0.0);
        let entry = |i: usize| {
            let mean = mean_phasor(i as f64 * f64::from(STEP));
            Complex { re: lanes(mean, 0), im: lanes(mean, 1) }
        };
        (0..=(LONGEST / STEP) as usize + 1).map(entry).collect()
    });
    let x = path / STEP;
    let i = x as usize;
    let table = &*TABLE;
    if i + 1 >= table.len() {
        return Complex { re: Vec4::ZERO, im: Vec4::ZERO };
    }
    let (a, b, t) = (table[i], table[i + 1], x - i as f32);
    a.add(b.sub(a).scaled(t))
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
    use super::{super::fresnel, *};
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

    /// Newton's colours of a soap film as it grows (M132): white of the first order, then without blue, without green,
    /// and without red.
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
