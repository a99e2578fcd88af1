//! Backward walks at random, whose collisions and directions are drawn and each of which adds what comes from the sun
//! straight: nothing is shared with the tables but densities and phase functions.

use super::{super::medium::TOP, *};
use rayon::prelude::*;
use std::f64::consts::PI;
use steradian_math::{DVec3, hash::HashRng};

struct Walker<'a> {
    medium: &'a Medium,
    band: usize,
    sun: DVec3,
    /// Orders that count: of `1..`.
    first: usize,
}

/// Two vectors across a direction.
fn across(w: DVec3) -> (DVec3, DVec3) {
    let u = w.any_orthonormal_vector();
    (u, w.cross(u))
}

fn around(w: DVec3, cos: f64, turn: f64) -> DVec3 {
    let ((u, v), sin, phi) = (across(w), (1.0 - cos * cos).max(0.0).sqrt(), 2.0 * PI * turn);
    (u * phi.cos() + v * phi.sin()) * sin + w * cos
}

impl Walker<'_> {
    /// Extinction of air, aerosols and ozone per km.
    fn extinction(&self, height: f64) -> [f64; 3] {
        let (d, o) = (self.medium.densities(height), &self.medium.optics);
        [
            f64::from(o.rayleigh[self.band]) * d[0],
            f64::from(o.aerosol[self.band]) * d[1],
            f64::from(o.ozone[self.band]) * d[2],
        ]
    }

    fn hits(&self, p: DVec3, w: DVec3) -> Option<f64> {
        let b = p.dot(w);
        let d = b * b - p.length_squared() + self.medium.radius.powi(2);
        (b < 0.0 && d > 0.0).then(|| -b - d.sqrt()).filter(|t| *t > 1e-6)
    }

    /// Transmittance from the sun to a point, by Simpson's rule on either side of the lowest point of the path.
    fn sunlight(&self, p: DVec3) -> f64 {
        if self.hits(p, self.sun).is_some() {
            return 0.0;
        }
        let (b, top) = (p.dot(self.sun), self.medium.radius + TOP);
        let end = -b + (b * b - p.length_squared() + top * top).max(0.0).sqrt();
        let lowest = (-b).clamp(0.0, end);
        let mut tau = 0.0;
        for length in [-lowest, end - lowest] {
            const N: u32 = 40;
            for i in 0..=N {
                let u = f64::from(i) / f64::from(N);
                let weight = if i == 0 || i == N {
                    1.0
                } else if i % 2 == 1 {
                    4.0
                } else {
                    2.0
                } / (3.0 * f64::from(N));
                let height = (p + self.sun * (lowest + length * u * u)).length() - self.medium.radius;
                tau += weight * 2.0 * u * length.abs() * self.extinction(height.max(0.0)).iter().sum::<f64>();
            }
        }
        (-tau).exp()
    }

    fn walk(&self, mut p: DVec3, mut w: DVec3, rng: &mut HashRng) -> f64 {
        let mut next = || f64::from(rng.next_f32());
        let most: f64 =
            self.extinction(0.0)[..2].iter().sum::<f64>() + f64::from(self.medium.optics.ozone[self.band]) * 0.06;
        let ground = f64::from(self.medium.optics.ground[self.band]);
        let (a, b) = self.medium.molecules(self.band);
        let (g, albedo) = (
            f64::from(self.medium.g),
            f64::from(self.medium.optics.scattering[self.band] / self.medium.optics.aerosol[self.band].max(1e-9)),
        );
        let (mut light, mut weight, mut order) = (0.0, 1.0, 0);
        loop {
            let t = -(1.0 - next()).ln() / most;
            if let Some(at) = self.hits(p, w).filter(|at| *at < t) {
                p += w * at;
                let up = p.normalize();
                p = up * self.medium.radius;
                weight *= ground;
                order += 1;
                if order >= self.first {
                    light += weight / PI * up.dot(self.sun).max(0.0) * self.sunlight(p);
                }
                w = around(up, next().sqrt(), next());
                if weight == 0.0 {
                    return light;
                }
                continue;
            }
            p += w * t;
            let height = p.length() - self.medium.radius;
            if height > TOP {
                return light;
            }
            let [air, dust, ozone] = self.extinction(height.max(0.0));
            assert!(air + dust + ozone <= most * (1.0 + 1e-9));
            if next() * most > air + dust + ozone {
                continue;
            }
            let scattered = air + albedo * dust;
            weight *= scattered / (air + dust + ozone);
            order += 1;
            let nu = w.dot(self.sun);
            if order >= self.first {
                let phase = air * (f64::from(a) + f64::from(b) * nu * nu)
                    + albedo * dust * f64::from(aerosols(self.medium.g, nu as f32));
                light += weight * phase / scattered * self.sunlight(p);
            }
            if weight < 0.05 {
                if next() < 0.5 {
                    return light;
                }
                weight *= 2.0;
            }
            let cos = if next() * scattered < air {
                // By rejection.
                loop {
                    let c = 2.0 * next() - 1.0;
                    if next() * f64::from(a + b) <= f64::from(a) + f64::from(b) * c * c {
                        break c;
                    }
                }
            } else if g.abs() < 1e-3 {
                2.0 * next() - 1.0
            } else {
                let s = (1.0 - g * g) / (1.0 - g + 2.0 * g * next());
                (1.0 + g * g - s * s) / (2.0 * g)
            };
            w = around(w, cos.clamp(-1.0, 1.0), next());
        }
    }
}

/// The mean of walks along a way and its standard error.
pub(super) fn walked(medium: &Medium, band: usize, way: &Way, first: usize, walks: usize) -> (f64, f64) {
    let sun = DVec3::new((1.0 - way.mu_sun * way.mu_sun).sqrt(), 0.0, way.mu_sun);
    let x = (way.nu - way.mu * way.mu_sun) / sun.x.max(1e-9);
    let w = DVec3::new(x, (1.0 - x * x - way.mu * way.mu).max(0.0).sqrt(), way.mu);
    let walker = Walker { medium, band, sun, first };
    const PARTS: usize = 64;
    let sums: Vec<(f64, f64)> = (0..PARTS)
        .into_par_iter()
        .map(|part| {
            let mut rng = HashRng::new(part as u64 + 1);
            let p = DVec3::new(0.0, 0.0, medium.radius + way.height.max(1e-4));
            (0..walks / PARTS).map(|_| walker.walk(p, w, &mut rng)).fold((0.0, 0.0), |s, l| (s.0 + l, s.1 + l * l))
        })
        .collect();
    let n = (walks / PARTS * PARTS) as f64;
    let (sum, squares) = sums.into_iter().fold((0.0, 0.0), |s, l| (s.0 + l.0, s.1 + l.1));
    let mean = sum / n;
    (mean, ((squares / n - mean * mean) / n).sqrt())
}

/// Clear skies with the sun at 5° and above are within 1 % of walks without aerosols, and 4.5 % with them.
#[test]
fn several_orders() {
    let check = |dust: f64, sun: f64, tolerance: f64, ways: &[(f64, f64, usize)]| {
        let medium = Medium::new(&Contents { aerosol: dust, ..Contents::CLEAR }, [0.3; BANDS]);
        let eye = Eye::new(&medium, sun.to_radians().sin(), true);
        for &(to, azimuth, band) in ways {
            let way = way(0.0, sun, to, azimuth);
            let (mean, error) = walked(&medium, band, &way, 1, 30_000);
            let found = f64::from(seen(&eye, &medium, &way)[band]);
            let allowed = 4.0 * error + tolerance * mean;
            assert!(
                (found - mean).abs() < allowed && error < 0.02 * mean,
                "{dust} {sun} {to} {band}: {found} {mean} ± {error}"
            );
        }
    };
    check(0.0, 60.0, 0.01, &[(90.0, 0.0, 4), (30.0, 180.0, 4), (5.0, 60.0, 18), (1.0, 120.0, 28)]);
    check(0.0, 10.0, 0.01, &[(90.0, 0.0, 4), (30.0, 180.0, 4), (5.0, 60.0, 18), (1.0, 120.0, 28)]);
    check(0.1, 40.0, 0.03, &[(90.0, 0.0, 4), (45.0, 0.0, 18), (1.0, 120.0, 28)]);
    check(0.1, 5.0, 0.045, &[(90.0, 0.0, 4), (10.0, 0.0, 18), (30.0, 180.0, 18), (1.0, 120.0, 28)]);
}

/// Light scattered at least twice, taken alone, agrees with random walks at the zenith and near the horizon.
#[test]
fn second_and_higher_orders() {
    let medium = Medium::new(&Contents { aerosol: 0.0, ..Contents::CLEAR }, [0.3; BANDS]);
    for (sun, to, azimuth) in [(60.0f64, 90.0, 0.0), (15.0, 8.0, 150.0)] {
        let way = way(0.0, sun, to, azimuth);
        let all = seen(&Eye::new(&medium, sun.to_radians().sin(), true), &medium, &way);
        let once = seen(&Eye::new(&medium, sun.to_radians().sin(), false), &medium, &way);
        for band in [4, 14] {
            let (mean, error) = walked(&medium, band, &way, 2, 40_000);
            let found = f64::from(all[band] - once[band]);
            assert!((found - mean).abs() < 4.0 * error + 0.02 * mean, "{sun} {to} {band}: {found} {mean} ± {error}");
        }
    }
}

/// Prints errors by direction, with as many walks as `WALKS` says.
#[test]
#[ignore = "a survey of minutes"]
#[expect(clippy::print_stdout, reason = "output of the program or test")]
fn survey() {
    let number = |name: &str, or: f64| std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(or);
    let walks = number("WALKS", 200_000.0) as usize;
    for (dust, ground) in [(0.0, 0.3), (0.1, 0.3), (0.4, 0.3)] {
        let medium = Medium::new(&Contents { aerosol: dust, ..Contents::CLEAR }, [ground; BANDS]);
        for sun in [60.0f64, 20.0, 5.0, 0.0, -3.0] {
            let clock = std::time::Instant::now();
            let eye = Eye::new(&medium, sun.to_radians().sin(), true);
            println!("dust {dust} ground {ground} sun {sun}: {:?}", clock.elapsed());
            for (to, azimuth) in
                [(90.0, 0.0), (30.0, 0.0), (30.0, 180.0), (5.0, 60.0), (1.0, 120.0), (sun.max(5.0) + 5.0, 0.0)]
            {
                let way = way(0.0, sun, to, azimuth);
                let found = seen(&eye, &medium, &way);
                print!("    {to:5} {azimuth:5}:");
                for band in [4, 18, 28] {
                    let (mean, error) = walked(&medium, band, &way, 1, walks);
                    print!("  {:+6.2} ± {:.2} %", 100.0 * (f64::from(found[band]) / mean - 1.0), 100.0 * error / mean);
                }
                println!();
            }
        }
    }
}
