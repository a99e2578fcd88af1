//! Fresnel equations: reflection and refraction at an interface.
//!
//! The amplitude coefficients of the field perpendicular (`s`, senkrecht) and parallel (`p`) to the plane of incidence
//! are (Born & Wolf 1999, 1.5.2)
//!
//! ```text
//! r_s = (η_i cosθ_i − η_t cosθ_t) / (η_i cosθ_i + η_t cosθ_t)
//! r_p = (η_t cosθ_i − η_i cosθ_t) / (η_t cosθ_i + η_i cosθ_t)
//! ```
//!
//! and unpolarised light is reflected in the ratio `F = (r_s² + r_p²)/2`. Relative indices are `η = η_below/η_above`,
//! where a positive cosine means light from above; a negative cosine turns the interface around.

use steradian_math::{Spectrum, Vec3};

/// Amplitudes and refraction at a dielectric interface that light passes.
#[derive(Clone, Copy, Debug)]
pub struct Amplitudes {
    /// `r_s`, the field perpendicular to the plane of incidence.
    pub s: f32,
    /// `r_p`, the field in the plane of incidence.
    pub p: f32,
    /// `cosθ_t > 0` of the refracted ray, by Snell's law.
    pub cos_t: f32,
}

/// The index that light meets, relative to the one it comes from, and its cosine made positive.
#[inline]
fn oriented(cos_i: f32, eta: f32) -> (f32, f32) {
    if cos_i < 0.0 { (-cos_i, 1.0 / eta) } else { (cos_i, eta) }
}

/// The amplitudes of reflection at a dielectric; `None` under total internal reflection.
#[inline]
pub fn dielectric_amplitudes(cos_i: f32, eta: f32) -> Option<Amplitudes> {
    let (cos_i, eta) = oriented(cos_i.clamp(-1.0, 1.0), eta);
    let sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
    if sin2_t >= 1.0 {
        return None;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    Some(Amplitudes {
        s: (cos_i - eta * cos_t) / (cos_i + eta * cos_t),
        p: (eta * cos_i - cos_t) / (eta * cos_i + cos_t),
        cos_t,
    })
}

/// A dielectric interface that light meets.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    /// The part of unpolarised light that is reflected; 1 under total internal reflection.
    pub reflectance: f32,
    /// `|cosθ_i|`.
    pub cos_i: f32,
    /// `η cosθ_t = √(η² − sin²θ_i)`, 0 under total internal reflection.
    pub refracted: f32,
    /// `η_t/η_i`.
    pub eta: f32,
}

impl Crossing {
    /// Crossing of light from the side given by the sign of the cosine.
    #[inline(always)]
    pub fn new(cos_i: f32, eta: f32) -> Self {
        let (cos_i, eta) = oriented(cos_i.clamp(-1.0, 1.0), eta);
        Self::with_square(cos_i, cos_i * cos_i, eta)
    }

    /// By the square of the cosine, of light that meets the index `eta`.
    #[inline(always)]
    pub fn by_square(cos2: f32, eta: f32) -> Self {
        let cos2 = cos2.min(1.0);
        Self::with_square(cos2.sqrt(), cos2, eta)
    }

    #[inline(always)]
    fn with_square(cos_i: f32, cos2: f32, eta: f32) -> Self {
        let sin2 = 1.0 - cos2;
        let refracted = (eta * eta - sin2).max(0.0).sqrt();
        // r_p = r_s (x − sin²θ_i)/(x + sin²θ_i) with x = η cosθ_i cosθ_t, and the mean of both squares with one
        // division.
        let (difference, sum, x) = (cos_i - refracted, cos_i + refracted, cos_i * refracted);
        let below = sum * (x + sin2);
        let reflectance = difference * difference * (x * x + sin2 * sin2) / (below * below);
        Self { reflectance: if refracted > 0.0 { reflectance } else { 1.0 }, cos_i, refracted, eta }
    }

    /// Result of [`refract`] for a direction `w` whose product with the normal is `cos`.
    #[inline(always)]
    pub fn refract(&self, w: Vec3, n: Vec3, cos: f32) -> Option<(Vec3, f32)> {
        let along = (self.cos_i - self.refracted) * 1f32.copysign(cos);
        (self.refracted > 0.0).then(|| ((along * n - w) * (1.0 / self.eta), self.eta))
    }
}

/// Reflectance of a dielectric for unpolarised light; 1 under total internal reflection.
#[inline]
pub fn dielectric(cos_i: f32, eta: f32) -> f32 {
    Crossing::new(cos_i, eta).reflectance
}

/// Reflectance of a conductor with index `η − ik`, relative to the medium above, for unpolarised light.
///
/// The exact complex equations in real arithmetic: with `a² + b² = √((η² − k² − sin²θ)² + 4η²k²)` and
/// `2a² = a² + b² + η² − k² − sin²θ` (Born & Wolf 1999, 14.2). A purely imaginary index (`η = 0`) reflects everything.
#[inline]
pub fn conductor(cos_i: f32, eta: Spectrum, k: Spectrum) -> Spectrum {
    conductor_by_square(cos_i * cos_i, eta, k)
}

/// Reflectance of a conductor as by [`conductor`], by the square of the cosine.
#[inline(always)]
pub fn conductor_by_square(cos2: f32, eta: Spectrum, k: Spectrum) -> Spectrum {
    use steradian_math::Vec4;
    let cos2 = cos2.min(1.0);
    let sin2 = 1.0 - cos2;
    let (eta2, k2) = (eta.0 * eta.0, k.0 * k.0);
    let t = eta2 - k2 - Vec4::splat(sin2);
    let sqrt = |v: Vec4| v.max(Vec4::ZERO).sqrt();
    let a2_plus_b2 = sqrt(t * t + 4.0 * eta2 * k2);
    // R_s = (x_s − y_s)/(x_s + y_s), R_p = R_s (x_p − y_p)/(x_p + y_p), and their mean with one division; y_s = 2a
    // cosθ.
    let (xs, ys) = (a2_plus_b2 + Vec4::splat(cos2), sqrt((2.0 * cos2) * (a2_plus_b2 + t)));
    let (xp, yp) = (a2_plus_b2 * cos2 + Vec4::splat(sin2 * sin2), ys * sin2);
    Spectrum((xs - ys) * xp / ((xs + ys) * (xp + yp)).max(Vec4::splat(f32::MIN_POSITIVE)))
}

/// The approximation for metals with large `k`: with `m = η² + k²` and `c = cosθ`, the mean of
/// `(m c² − 2ηc + 1)/(m c² + 2ηc + 1)` and `(m − 2ηc + c²)/(m + 2ηc + c²)` for the parallel and the perpendicular
/// field; the lectures print it as if it were exact. At normal incidence it is; copper's reflectance at 70° is too
/// large by 0.0068.
pub fn conductor_approximate(cos_i: f32, eta: f32, k: f32) -> f32 {
    let c = cos_i.clamp(0.0, 1.0);
    let m = eta * eta + k * k;
    let part = |a: f32| (a - 2.0 * eta * c) / (a + 2.0 * eta * c).max(f32::MIN_POSITIVE);
    0.5 * (part(m * c * c + 1.0) + part(m + c * c))
}

/// Schlick's approximation `F₀ + (1 − F₀)(1 − cosθ)⁵` (Schlick 1994); for models that are defined by it.
#[inline]
pub fn schlick(cos_i: f32, f0: Spectrum) -> Spectrum {
    let m = (1.0 - cos_i.clamp(0.0, 1.0)).powi(5);
    f0 + (Spectrum::ONE - f0) * m
}

/// Reflectance at normal incidence of a dielectric, `((η − 1)/(η + 1))²`.
pub fn f0_from_eta(eta: f32) -> f32 {
    ((eta - 1.0) / (eta + 1.0)).powi(2)
}

/// Reflectance of a dielectric under diffuse light, `F_dr = 2∫₀¹ F(μ) μ dμ`; `eta` as seen from the side of the light.
///
/// The integrand has a kink at the critical angle when `η < 1`, so the interval is split there and each part is
/// integrated in a variable that is smooth at its end. Accurate to 10⁻⁶.
pub fn dielectric_diffuse(eta: f32) -> f32 {
    dielectric_cosine_mean(eta, |_, _| 1.0)
}

/// `2∫₀¹ F(μ) μ g(μ, μ_t) dμ`, with the refracted cosine `μ_t` (0 under total internal reflection), in double
/// precision.
pub(super) fn dielectric_cosine_mean(eta: f32, g: impl Fn(f64, f64) -> f64) -> f32 {
    let eta = f64::from(eta);
    let reflectance = |mu: f64| {
        let sin2_t = (1.0 - mu * mu) / (eta * eta);
        if sin2_t >= 1.0 {
            return (1.0, 0.0);
        }
        let c = (1.0 - sin2_t).sqrt();
        let (s, p) = ((mu - eta * c) / (mu + eta * c), (eta * mu - c) / (eta * mu + c));
        (0.5 * (s * s + p * p), c)
    };
    let critical = if eta < 1.0 { (1.0 - eta * eta).sqrt() } else { 0.0 };
    const N: usize = 512;
    let mut sum = 0.0;
    for i in 0..N {
        let x = (i as f64 + 0.5) / N as f64;
        // Totally reflected part.
        if critical > 0.0 {
            let mu = x * critical;
            let (f, c) = reflectance(mu);
            sum += 2.0 * f * mu * g(mu, c) * critical;
        }
        // Above the critical angle, μ = critical + (1 − critical)·x² removes the square-root end.
        let mu = critical + (1.0 - critical) * x * x;
        let (f, c) = reflectance(mu);
        sum += 2.0 * f * mu * g(mu, c) * (1.0 - critical) * 2.0 * x;
    }
    (sum / N as f64) as f32
}

/// The fit of [`dielectric_diffuse`] that Mitsuba's smooth plastic uses: Egan & Hilgeman (1973) for `η < 1`, d'Eon &
/// Irving (2011) for `η ≥ 1`. Within 0.1 % of the integral for common glasses.
pub fn dielectric_diffuse_fit(eta: f32) -> f32 {
    let inv = 1.0 / eta;
    if eta < 1.0 {
        -1.4399 * eta * eta + 0.7099 * eta + 0.6681 + 0.0636 * inv
    } else {
        // d'Eon & Irving's polynomial in 1/η, by Horner's rule.
        [-1.36881, 4.98554, -7.80989, 6.75335, -3.4793, 0.919317].iter().fold(0.0, |acc, c| acc * inv + c)
    }
}

/// Mirrors `w` in the plane orthogonal to the unit vector `n`: `2(w·n)n − w`. Both point away from the surface.
#[inline]
pub fn reflect(w: Vec3, n: Vec3) -> Vec3 {
    2.0 * w.dot(n) * n - w
}

/// Refracts `w`, which points away from the surface, at a plane with unit normal `n`: the transmitted direction, also
/// away from the surface, and the relative index `η_t/η_i` on its way. `None` under total internal reflection.
///
/// `eta` is the index on the side that `−n` points to, relative to the side of `n`; `w` may lie on either side.
#[inline(always)]
pub fn refract(w: Vec3, n: Vec3, eta: f32) -> Option<(Vec3, f32)> {
    let c = w.dot(n);
    let n = if c < 0.0 { -n } else { n };
    let (cos_i, eta) = oriented(c, eta);
    let inverse = 1.0 / eta;
    let sin2_t = (1.0 - cos_i * cos_i).max(0.0) / (eta * eta);
    if sin2_t >= 1.0 {
        return None;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    Some((w * -inverse + (cos_i * inverse - cos_t) * n, eta))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(degrees: f32) -> f32 {
        degrees.to_radians().cos()
    }

    #[track_caller]
    fn near(a: f32, b: f32, eps: f32) {
        assert!((a - b).abs() <= eps, "{a} is not {b} within {eps}");
    }

    #[test]
    fn glass_has_the_tabulated_reflectances() {
        near(dielectric(1.0, 1.5), 0.04, 1e-7);
        near(dielectric(at(60.0), 1.5), 0.089187, 1e-6);
        near(dielectric(at(85.0), 1.5), 0.612800, 2e-6);
        // Brewster's angle atan(1.5) = 56.3099°: the parallel field is not reflected.
        let brewster = 1.5f32.atan();
        near(brewster.to_degrees(), 56.3099, 1e-4);
        let a = dielectric_amplitudes(brewster.cos(), 1.5).unwrap();
        near(a.p, 0.0, 1e-6);
        near(dielectric(brewster.cos(), 1.5), 0.5 * a.s * a.s, 1e-7);
        near(dielectric(brewster.cos(), 1.5), 0.0740, 5e-5);
        // The amplitudes of E6: at normal incidence r_s = (1−η)/(1+η), r_p = −r_s.
        let a = dielectric_amplitudes(1.0, 1.5).unwrap();
        near(a.s, -0.2, 1e-7);
        near(a.p, 0.2, 1e-7);
    }

    #[test]
    fn both_sides_agree_along_the_refracted_ray() {
        for degrees in [0.0, 20.0, 45.0, 70.0, 88.0] {
            let above = dielectric_amplitudes(at(degrees), 1.5).unwrap();
            near(dielectric(at(degrees), 1.5), dielectric(-above.cos_t, 1.5), 3e-5);
        }
        // Total internal reflection beyond 41.8103° for 1.5 → 1, from below.
        assert!(dielectric(-at(41.80), 1.5) < 1.0);
        assert_eq!(dielectric(-at(41.82), 1.5), 1.0);
        near((1.0f32 / 1.5).asin().to_degrees(), 41.8103, 1e-4);
        assert_eq!(dielectric(-0.0, 1.5), 1.0);
        assert_eq!(dielectric(0.0, 1.5), 1.0);
        near(dielectric(0.3, 1.0), 0.0, 1e-12);
    }

    #[test]
    fn diffuse_averages_match_the_table() {
        near(dielectric_diffuse(1.5), 0.091778, 2e-6);
        near(dielectric_diffuse(1.0 / 1.5), 0.596346, 2e-6);
        near(dielectric_diffuse_fit(1.0 / 1.5), 0.596346, 1e-3);
        near(dielectric_diffuse_fit(1.5), 0.091778, 1e-3);
        near(dielectric_diffuse(1.0), 0.0, 1e-7);
        // Reciprocity of the interface under diffuse light: 1 − F(1/η) = (1 − F(η))/η².
        for eta in [1.1f32, 1.33, 1.8, 2.4] {
            near(1.0 - dielectric_diffuse(1.0 / eta), (1.0 - dielectric_diffuse(eta)) / (eta * eta), 3e-6);
        }
    }

    #[test]
    fn gold_matches_the_exact_complex_equations() {
        // Complex arithmetic in f64, straight from the definition.
        let complex = |cos_i: f64, n: f64, k: f64| {
            type C = (f64, f64);
            let mul = |a: C, b: C| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
            let div = |a: C, b: C| {
                let d = b.0 * b.0 + b.1 * b.1;
                ((a.0 * b.0 + a.1 * b.1) / d, (a.1 * b.0 - a.0 * b.1) / d)
            };
            let sqrt = |a: C| {
                let m = a.0.hypot(a.1);
                (((m + a.0) / 2.0).max(0.0).sqrt(), ((m - a.0) / 2.0).max(0.0).sqrt().copysign(a.1))
            };
            let eta: C = (n, k);
            let s2 = 1.0 - cos_i * cos_i;
            let q = div((s2, 0.0), mul(eta, eta));
            let ct = sqrt((1.0 - q.0, -q.1));
            let (ec, ect) = ((eta.0 * cos_i, eta.1 * cos_i), mul(eta, ct));
            let p = div((ec.0 - ct.0, ec.1 - ct.1), (ec.0 + ct.0, ec.1 + ct.1));
            let s = div((cos_i - ect.0, -ect.1), (cos_i + ect.0, ect.1));
            0.5 * (p.0 * p.0 + p.1 * p.1 + s.0 * s.0 + s.1 * s.1)
        };
        // The lectures' index of gold.
        let gold = |d| conductor(at(d), Spectrum::splat(0.37), Spectrum::splat(2.82))[0];
        near(gold(0.0), 0.84943, 1e-5);
        near(gold(80.0), 0.88740, 1e-5);
        for (n, k) in [(0.37, 2.82), (0.2, 3.91), (1.5, 0.0), (2.0, 0.1), (0.05, 4.0)] {
            for degrees in [0.0f32, 15.0, 45.0, 70.0, 85.0, 89.5] {
                let f = conductor(at(degrees), Spectrum::splat(n), Spectrum::splat(k))[0];
                near(f, complex(f64::from(at(degrees)), f64::from(n), f64::from(k)) as f32, 2e-5);
            }
        }
        // Without absorption the conductor is a dielectric.
        near(conductor(at(50.0), Spectrum::splat(1.5), Spectrum::ZERO)[0], dielectric(at(50.0), 1.5), 1e-6);
        // A purely imaginary index reflects everything; the empty fourth lane of RGB stays finite.
        assert_eq!(conductor(0.37, Spectrum::ZERO, Spectrum::ONE), Spectrum::ONE);
        assert!(conductor(1.0, Spectrum::ZERO, Spectrum::ZERO).is_finite());
    }

    /// Light through a prism of apex 60° is turned least by `2 asin(n sin 30°) − 60°` (M130), and more in the blue:
    /// glass spreads colours.
    #[test]
    fn a_prism_deviates_least_as_the_formula_says() {
        let half = 30f32.to_radians();
        let face = |side: f32| Vec3::new(side * half.cos(), half.sin(), 0.0);
        let deviation = |n: f32, degrees: f32| {
            // Light comes from the left and below, at an angle from the normal of the left face.
            let (sin, cos) = degrees.to_radians().sin_cos();
            let n_left = face(-1.0);
            let w = Vec3::new(n_left.x * cos - n_left.y * sin, n_left.y * cos + n_left.x * sin, 0.0);
            let (inside, _) = refract(w, face(-1.0), n)?;
            // The index below the right face is the glass's, where the light comes from.
            let (out, _) = refract(-inside, face(1.0), n)?;
            Some((-w).angle_between(out))
        };
        for n in [1.5224f32, 1.5143] {
            let least = (0..900).filter_map(|i| deviation(n, 0.1 * i as f32)).fold(f32::MAX, f32::min);
            near(least, 2.0 * (n * half.sin()).asin() - 2.0 * half, 2e-4);
        }
    }

    /// The primary rainbow stands 42.4° from the shadow of one's head in red light and lower in violet (M129): the most
    /// that one reflection inside a drop turns light back by.
    #[test]
    fn the_rainbow_stands_at_its_angle() {
        let bow = |n: f32| {
            let angle = |b: f32| {
                let (w, start) = (Vec3::X, Vec3::new((1.0 - b * b).sqrt(), b, 0.0));
                let (inside, _) = refract(w, start, n)?;
                let chord = |p: Vec3, d: Vec3| p - 2.0 * p.dot(d) * d;
                let back = chord(start, inside);
                let again = reflect(-inside, -back);
                let exit = chord(back, again);
                // Towards the drop's inside as the light sees it.
                let (out, _) = refract(-again, exit, n)?;
                Some(out.angle_between(w).to_degrees())
            };
            (1..2000).filter_map(|i| angle(i as f32 / 2000.0)).fold(0.0, f32::max)
        };
        near(bow(1.3311), 42.4, 0.06);
        near(bow(1.3435), 40.6, 0.1);
    }

    #[test]
    fn approximations_are_what_they_are_named() {
        near(f0_from_eta(2.417), 0.1724, 1e-3);
        near(schlick(at(80.0), Spectrum::splat(0.04))[0], 0.4099, 2e-4);
        near(dielectric(at(80.0), 1.5), 0.3877, 2e-4);
        // E12: the large-k form is exact at normal incidence, and off for copper (the lectures' index) elsewhere.
        let copper = |d| {
            conductor_approximate(at(d), 0.617, 2.63)
                - conductor(at(d), Spectrum::splat(0.617), Spectrum::splat(2.63))[0]
        };
        near(copper(0.0), 0.0, 1e-6);
        near(copper(60.0), 0.005837, 1e-5);
        near(copper(70.0), 0.006816, 1e-5);
    }

    #[test]
    fn mirrored_and_refracted_rays_obey_their_laws() {
        let n = Vec3::new(0.2, -0.1, 0.97).normalize();
        for w in [Vec3::new(0.5, 0.3, 0.8), Vec3::new(-0.9, 0.1, 0.2), Vec3::new(0.3, 0.2, -0.9)].map(Vec3::normalize) {
            let r = reflect(w, n);
            assert!((reflect(r, n) - w).length() < 1e-6);
            near(r.dot(n), w.dot(n), 1e-6);
            let Some((t, eta)) = refract(w, n, 1.5) else { continue };
            near(t.length(), 1.0, 1e-6);
            near(w.cross(n).length(), eta * t.cross(n).length(), 1e-6);
            assert!(t.dot(n) * w.dot(n) < 0.0, "crosses the surface");
            near(t.dot(w.cross(n)), 0.0, 1e-6);
            let (back, _) = refract(t, n, 1.5).unwrap();
            assert!((back - w).length() < 5e-5);
        }
        let grazing_inside = Vec3::new(0.7, 0.0, -(1.0f32 - 0.49).sqrt());
        assert!(refract(grazing_inside, Vec3::Z, 1.5).is_none());
    }
}
