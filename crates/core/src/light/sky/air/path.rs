//! Straight ways through air: what is on them, and what is on the way from them to the sun. Lengths are in km.

use super::medium::{Medium, TOP};

/// A piece of a way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub height: f64,
    /// Cosines of the way and of the sun with the vertical in the middle of the piece.
    pub mu: f64,
    pub mu_sun: f64,
    /// Air, aerosols and ozone on the piece, of vertical columns of one.
    pub amounts: [f32; 3],
}

/// A way from a place in a direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    /// Height of its start, and the cosine of its direction with the vertical there.
    pub height: f64,
    pub mu: f64,
    /// Cosine of the sun with the vertical at the start, and with the direction.
    pub mu_sun: f64,
    pub nu: f64,
    /// True if the path may end at the ground.
    pub can_hit: bool,
}

impl Way {
    /// Length of the path, and true if it ends at the ground.
    pub(super) fn end(&self, radius: f64) -> (f64, bool) {
        // Intersect with the ground sphere: r² sin² θ against R².
        let (r, mu) = (radius + self.height, self.mu);
        let above = r * r * mu * mu - self.height * (r + radius);
        if self.can_hit && mu < 0.0 && above >= 0.0 {
            return ((-r * mu - above.sqrt()).max(0.0), true);
        }
        // Otherwise the way ends at the top of the atmosphere.
        let room = ((radius + TOP - r) * (radius + TOP + r)).max(0.0);
        ((-r * mu + (room + r * r * mu * mu).sqrt()).max(0.0), false)
    }

    /// Height and the two cosines after a length.
    pub(super) fn after(&self, radius: f64, t: f64) -> (f64, f64, f64) {
        // Law of cosines for the distance from the globe's centre.
        let r = radius + self.height;
        let there = (r * r + 2.0 * r * self.mu * t + t * t).sqrt();
        // Without the loss of digits of `there − radius`.
        let rise = (self.height * (r + radius) + 2.0 * r * self.mu * t + t * t) / (there + radius);
        (rise.max(0.0), (r * self.mu + t) / there, (r * self.mu_sun + t * self.nu) / there)
    }

    /// The pieces, dense where the way is nearest to the ground, and cut where the globe's shadow begins or ends; then
    /// the cosine of the sun with the vertical at the ground, where the way ends there.
    pub(super) fn steps(&self, medium: &Medium, count: usize) -> (Vec<Step>, Option<f64>) {
        let radius = medium.radius;
        let (length, hits) = self.end(radius);
        let r = radius + self.height;
        // The point nearest to the ground: sample densely on both sides of it.
        let nearest = (-r * self.mu).clamp(0.0, length);
        let mut ends = Vec::with_capacity(2 * count + 3);
        if nearest > 0.0 {
            ends.extend((0..=count).rev().map(|i| nearest - nearest * (i as f64 / count as f64).powi(2)));
        }
        if length > nearest {
            ends.extend((0..=count).map(|i| nearest + (length - nearest) * (i as f64 / count as f64).powi(2)));
        }
        // Where the way crosses the cylinder of shadow: |p|² − (p·s)² = R².
        let a = (1.0 - self.nu * self.nu).max(1e-12);
        let b = r * (self.mu - self.mu_sun * self.nu);
        let c = self.height * (r + radius) - (r * self.mu_sun).powi(2);
        let root = (b * b - a * c).max(0.0).sqrt();
        ends.extend([(-b - root) / a, (-b + root) / a].into_iter().filter(|t| *t > 0.0 && *t < length));
        ends.sort_by(f64::total_cmp);
        let pieces = ends.windows(2).filter(|w| w[1] > w[0]).map(|w| {
            let (height, mu, mu_sun) = self.after(radius, 0.5 * (w[0] + w[1]));
            // The rule of Gauss with two points.
            let (middle, half) = (0.5 * (w[0] + w[1]), 0.5 * (w[1] - w[0]));
            let mut amounts = [0.0; 3];
            for x in [-0.577_350_269_189_6, 0.577_350_269_189_6] {
                let densities = medium.densities(self.after(radius, middle + half * x).0);
                (0..3).for_each(|k| amounts[k] += (densities[k] * half) as f32);
            }
            Step { height, mu, mu_sun, amounts }
        });
        (pieces.collect(), hits.then(|| self.after(radius, length).2))
    }

    /// All on the way; `None` where it ends at the ground.
    pub(super) fn columns(&self, medium: &Medium, count: usize) -> Option<[f32; 3]> {
        let (steps, ground) = self.steps(medium, count);
        let sum = |k: usize| steps.iter().map(|s| f64::from(s.amounts[k])).sum::<f64>() as f32;
        ground.is_none().then(|| std::array::from_fn(sum))
    }
}

/// Cosine of the horizon with the vertical at a height.
pub(super) fn horizon(radius: f64, height: f64) -> f64 {
    -(height * (2.0 * radius + height)).max(0.0).sqrt() / (radius + height)
}

const HEIGHTS: usize = 64;
const COSINES: usize = 160;

/// Columns between a point and the sun, by height and the cosine of the sun's zenith angle.
#[derive(Clone, Debug)]
pub(super) struct Sunward {
    radius: f64,
    table: Vec<[f32; 3]>,
}

impl Sunward {
    pub(super) fn new(medium: &Medium) -> Self {
        let radius = medium.radius;
        let mut table = Vec::with_capacity(HEIGHTS * COSINES);
        // Spacing by squares, dense at low heights and near the horizon.
        for i in 0..HEIGHTS {
            let height = TOP * (i as f64 / (HEIGHTS - 1) as f64).powi(2);
            let lowest = horizon(radius, height);
            for j in 0..COSINES {
                let mu = lowest + (1.0 - lowest) * (j as f64 / (COSINES - 1) as f64).powi(2);
                let way = Way { height, mu, mu_sun: mu, nu: 1.0, can_hit: false };
                table.push(way.columns(medium, 32).unwrap_or_default());
            }
        }
        Self { radius, table }
    }

    /// The columns of air, aerosols and ozone; `None` in the shadow.
    pub(super) fn columns(&self, height: f64, mu: f64) -> Option<[f32; 3]> {
        let lowest = horizon(self.radius, height);
        if mu < lowest {
            return None;
        }
        // Invert the spacing and interpolate bilinearly.
        let x = (height / TOP).clamp(0.0, 1.0).sqrt() * (HEIGHTS - 1) as f64;
        let y = ((mu - lowest) / (1.0 - lowest)).clamp(0.0, 1.0).sqrt() * (COSINES - 1) as f64;
        let (i, j) = ((x as usize).min(HEIGHTS - 2), (y as usize).min(COSINES - 2));
        let (s, t) = ((x - i as f64) as f32, (y - j as f64) as f32);
        let at = |i: usize, j: usize| self.table[i * COSINES + j];
        let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)];
        Some(std::array::from_fn(|k| (a[k] * (1.0 - t) + b[k] * t) * (1.0 - s) + (c[k] * (1.0 - t) + d[k] * t) * s))
    }
}

#[cfg(test)]
mod tests {
    use super::{super::Contents, *};

    fn earth() -> Medium {
        Medium::new(&Contents::CLEAR, [0.0; 48])
    }

    fn slant(medium: &Medium, zenith: f64) -> f64 {
        let mu = zenith.to_radians().cos();
        let way = Way { height: 0.0, mu, mu_sun: mu, nu: 1.0, can_hit: false };
        f64::from(way.columns(medium, 48).unwrap()[0])
    }

    /// Relative air mass: Kasten and Young, "Revised optical air mass tables" (1989), whose air refracts; the secant on
    /// a globe so large that it is flat.
    #[test]
    fn air_mass() {
        let kasten_young = |z: f64| 1.0 / (z.to_radians().cos() + 0.505_72 * (96.079_95 - z).powf(-1.6364));
        let medium = earth();
        for (zenith, tolerance) in [(0.0, 1e-3), (60.0, 2e-3), (80.0, 5e-3), (85.0, 0.012), (88.0, 0.04), (90.0, 0.09)]
        {
            let (found, published) = (slant(&medium, zenith), kasten_young(zenith));
            assert!((found / published - 1.0).abs() < tolerance, "{zenith}: {found} {published}");
        }
        let mut flat = medium;
        flat.radius = 6.371e6;
        assert!((slant(&flat, 60.0) - 2.0).abs() < 1e-3, "{}", slant(&flat, 60.0));
    }

    /// Air that thins exponentially, towards the horizon: Chapman's function `√(πX/2)(1 + 3/(8X))` of `X = R/H`, and
    /// without its second term where the way passes the ground midway, seen from above all air.
    #[test]
    fn chapman() {
        for scale in [8.0, 5.0] {
            let medium = earth().with_air(|h| (-h / scale).exp());
            let x = medium.radius / scale;
            let published = (std::f64::consts::PI * x / 2.0).sqrt() * (1.0 + 3.0 / (8.0 * x));
            let found = slant(&medium, 90.0);
            assert!((found / published - 1.0).abs() < 2e-3, "{scale}: {found} {published}");
            let mu = horizon(medium.radius, 90.0);
            let way = Way { height: 90.0, mu, mu_sun: mu, nu: 1.0, can_hit: false };
            let through = f64::from(way.columns(&medium, 48).unwrap()[0]);
            assert!((through / (2.0 * published) - 1.0).abs() < 2e-3, "{scale}: {through} {published}");
        }
    }

    /// The table holds what is on ways to the sun, and where the globe's shadow is.
    #[test]
    fn the_table_is_that_of_ways() {
        let medium = earth();
        let table = Sunward::new(&medium);
        for height in [0.0, 0.3, 2.0, 7.0, 23.0, 61.0] {
            let lowest = horizon(medium.radius, height);
            assert!(table.columns(height, lowest - 1e-6).is_none());
            for above in [1e-5, 0.003, 0.02, 0.1, 0.5, 0.9] {
                let mu = lowest + above * (1.0 - lowest);
                let way = Way { height, mu, mu_sun: mu, nu: 1.0, can_hit: false };
                let (exact, found) = (way.columns(&medium, 200).unwrap(), table.columns(height, mu).unwrap());
                for k in 0..3 {
                    let error = (found[k] - exact[k]).abs();
                    let tolerance = if k == 1 { 0.05 } else { 0.02 };
                    assert!(error < tolerance * exact[k] + 1e-4, "{height} {mu} {k}: {found:?} {exact:?}");
                }
            }
        }
    }
}
