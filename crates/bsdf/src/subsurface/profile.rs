//! Diffusion profiles in a table: how much light leaves at a distance from where it entered, by albedo and distance in
//! mean free paths. Between radii `2π r R(r)` is linear, and so are both its value and the density of samples between
//! albedos, so samples follow the value exactly where all wavelengths are alike.

use crate::fresnel;
use steradian_math::Spectrum;

/// Rows of the table.
const ALBEDOS: usize = 64;
/// Radii of a row.
const RADII: usize = 128;
/// From one radius to the next.
const RATIO: f32 = 1.095;
/// The first radius above zero, in mean free paths.
const FIRST: f32 = 2.5e-3;

/// Below this radius, in mean free paths, a profile is taken for even.
const LEAST: f32 = 1e-3 * FIRST;
/// Rings that bring less than this part of what is within them end a row.
const DARK: f64 = 1e-7;

/// A radially symmetric profile `R(r)` for a range of albedos.
#[derive(Clone, Debug)]
pub struct ProfileTable {
    radii: Vec<f32>,
    albedos: Vec<f32>,
    /// `2π r R(r)` by albedo and radius, lengths in mean free paths.
    rings: Vec<f32>,
    /// Its integral up to each radius.
    sums: Vec<f32>,
}

/// Interpolation between the rows of a profile table, for the albedo of one lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    /// The first of two rows.
    low: usize,
    /// The weight of the second.
    t: f32,
}

impl ProfileTable {
    /// The table of a profile: `ring(albedo, r)` is `2π r R(r)` for a mean free path of one, at `r = 0` its limit.
    /// Albedos at which more light would leave than entered are scaled to give all of it back.
    pub fn new(ring: impl Fn(f64, f64) -> f64) -> Self {
        let radii: Vec<f32> =
            std::iter::once(0.0).chain((0..RADII - 1).map(|i| FIRST * RATIO.powi(i as i32))).collect();
        // Denser near one, where the profile changes most.
        let from_one = |i: usize| 1.0 - i as f32 / (ALBEDOS - 1) as f32;
        let albedos: Vec<f32> = (0..ALBEDOS).map(|i| 1.0 - from_one(i).powi(3)).collect();
        let (mut rings, mut sums) = (Vec::with_capacity(ALBEDOS * RADII), Vec::with_capacity(ALBEDOS * RADII));
        for &a in &albedos {
            let (mut sum, mut is_dark) = (0.0, false);
            for (j, &r) in radii.iter().enumerate() {
                // What is left further out is not seen.
                let value = if is_dark { 0.0 } else { ring(f64::from(a), f64::from(r)) };
                is_dark |= r > 1.0 && value * f64::from(r) <= DARK * sum;
                rings.push(if value.is_finite() { value.max(0.0) as f32 } else { 0.0 });
                if j > 0 {
                    // Trapezoids between radii: the integral of the piecewise linear ring.
                    let [a, b] = [rings[rings.len() - 2], rings[rings.len() - 1]];
                    sum += f64::from(a + b) * 0.5 * f64::from(r - radii[j - 1]);
                }
                sums.push(sum as f32);
            }
            // Diffusion is approximate: next to albedo one it may find more light than entered.
            let excess = (sum as f32).max(1.0);
            let row = rings.len() - RADII;
            rings[row..].iter_mut().chain(&mut sums[row..]).for_each(|v| *v /= excess);
        }
        Self { radii, albedos, rings, sums }
    }

    /// The largest radius of the table, in mean free paths.
    fn end(&self) -> f32 {
        self.radii[RADII - 1]
    }

    pub(super) fn row(&self, albedo: f32) -> Row {
        let low = self.albedos.partition_point(|a| *a <= albedo).clamp(1, ALBEDOS - 1) - 1;
        let [a, b] = [self.albedos[low], self.albedos[low + 1]];
        Row { low, t: ((albedo - a) / (b - a)).clamp(0.0, 1.0) }
    }

    fn total(&self, row: usize) -> f32 {
        self.sums[row * RADII + RADII - 1]
    }

    fn between(row: Row, of: impl Fn(usize) -> f32) -> f32 {
        (1.0 - row.t) * of(row.low) + row.t * of(row.low + 1)
    }

    /// The part of the light that leaves again, wherever, of that which entered.
    pub fn albedo(&self, albedo: f32) -> f32 {
        Self::between(self.row(albedo), |row| self.total(row))
    }

    /// The albedo of single scattering by which so much of the light leaves again, as near as the table has it.
    pub fn single_scattering_albedo(&self, albedo: f32) -> f32 {
        // Totals grow with the albedo.
        let high = (1..ALBEDOS - 1).find(|row| self.total(*row) >= albedo).unwrap_or(ALBEDOS - 1);
        let [below, above] = [self.total(high - 1), self.total(high)];
        let t = if above > below { ((albedo - below) / (above - below)).clamp(0.0, 1.0) } else { 0.0 };
        self.albedos[high - 1] + t * (self.albedos[high] - self.albedos[high - 1])
    }

    /// `2π r R(r)` at a radius in mean free paths.
    fn ring(&self, row: Row, r: f32) -> f32 {
        if r >= self.end() {
            return 0.0;
        }
        // The ring of the radius, and linear interpolation in both radius and albedo.
        let j = self.radii.partition_point(|x| *x <= r).clamp(1, RADII - 1) - 1;
        let t = (r - self.radii[j]) / (self.radii[j + 1] - self.radii[j]);
        Self::between(row, |row| {
            let [a, b] = [self.rings[row * RADII + j], self.rings[row * RADII + j + 1]];
            a + t * (b - a)
        })
    }

    /// A radius in mean free paths whose density is proportional to the ring's light, by a number in `[0, 1)`.
    pub(super) fn sample(&self, row: Row, u: f32) -> f32 {
        // One of the two rows, in proportion to what it has of all.
        let [a, b] = [(1.0 - row.t) * self.total(row.low), row.t * self.total(row.low + 1)];
        let p = if a + b > 0.0 { a / (a + b) } else { 1.0 };
        let (row, u) = if u < p { (row.low, u / p) } else { (row.low + 1, (u - p) / (1.0 - p)) };
        // Invert the cumulative ring: find the piece, then the place within it.
        let sums = &self.sums[row * RADII..][..RADII];
        let target = u * sums[RADII - 1];
        let j = sums.partition_point(|s| *s <= target).clamp(1, RADII - 1) - 1;
        let [f, g] = [self.rings[row * RADII + j], self.rings[row * RADII + j + 1]];
        let width = self.radii[j + 1] - self.radii[j];
        // Within the piece the integral is f x + (g − f) x²/2 over its width; its inverse, written so that nothing
        // cancels.
        let part = (target - sums[j]).max(0.0) / width;
        let root = (f * f + 2.0 * (g - f) * part).max(0.0).sqrt();
        let x = if f + root > 0.0 { (2.0 * part / (f + root)).clamp(0.0, 1.0) } else { 0.0 };
        (self.radii[j] + x * width).min(self.end())
    }

    /// The radius, in mean free paths, beyond which no more than this part of the light leaves.
    fn quantile(&self, row: Row, share: f32) -> f32 {
        let within = |j: usize| Self::between(row, |row| self.sums[row * RADII + j]);
        let all = within(RADII - 1);
        let j = (0..RADII).find(|j| within(*j) >= (1.0 - share) * all).unwrap_or(RADII - 1);
        self.radii[j]
    }
}

/// A profile at a point of a surface: a table with the albedos and extinctions of all lanes.
#[derive(Clone, Copy, Debug)]
pub struct Profile<'a> {
    table: &'a ProfileTable,
    rows: [Row; 4],
    sigma_t: Spectrum,
    lanes: usize,
}

/// Beyond the radius within which all but this part of the light leaves none is found.
const LEFT_OUT: f32 = 5e-4;

impl<'a> Profile<'a> {
    /// Profile of a medium, given its extinction (1/length) and its albedo of single scattering in `lanes` lanes.
    pub fn new(table: &'a ProfileTable, sigma_t: Spectrum, albedo: Spectrum, lanes: usize) -> Self {
        Self { table, rows: albedo.to_array().map(|a| table.row(a)), sigma_t, lanes }
    }

    /// Light that leaves per area at a distance from where light entered, as part of it.
    pub fn value(&self, r: f32) -> Spectrum {
        Spectrum::new(std::array::from_fn(|lane| if lane < self.lanes { self.per_area(lane, r) } else { 0.0 }))
    }

    /// The density per area of points whose distances in the plane are drawn by [`Profile::sample`].
    pub fn pdf(&self, r: f32) -> f32 {
        let of = |lane: usize| {
            let total = ProfileTable::between(self.rows[lane], |row| self.table.total(row));
            // Density averages over the lanes, since a lane is drawn evenly.
            if total > 0.0 { self.per_area(lane, r) / total } else { 0.0 }
        };
        (0..self.lanes).map(of).sum::<f32>() / self.lanes as f32
    }

    /// `R(r)` of a lane, from the ring's light; towards r = 0 it is that at the least radius.
    fn per_area(&self, lane: usize, r: f32) -> f32 {
        // From lengths in mean free paths to the world: per area goes with the square of the extinction.
        let rate = self.sigma_t[lane];
        let r = (r * rate).max(LEAST);
        self.table.ring(self.rows[lane], r) * rate * rate / (std::f32::consts::TAU * r)
    }

    /// A distance, by a number for the lane and one for the distance; none where that lane lets no light out.
    pub fn sample(&self, u: f32, v: f32) -> Option<f32> {
        // Draw a lane, then a radius by its profile.
        let lane = ((u * self.lanes as f32) as usize).min(self.lanes - 1);
        let (row, rate) = (self.rows[lane], self.sigma_t[lane]);
        let total = ProfileTable::between(row, |row| self.table.total(row));
        (rate > 0.0 && total > 0.0).then(|| self.table.sample(row, v) / rate)
    }

    /// The distance beyond which none is looked for.
    pub fn reach(&self) -> f32 {
        let of = |lane: usize| {
            if self.sigma_t[lane] > 0.0 {
                // The distance within which nearly all of the lane's light leaves.
                self.table.quantile(self.rows[lane], LEFT_OUT) / self.sigma_t[lane]
            } else {
                0.0
            }
        };
        (0..self.lanes).map(of).fold(0.0, f32::max)
    }
}

/// `∫ F(μ) μⁿ dμ` of light that meets the surface from within a medium of this index, by quadrature.
pub(super) fn internal_moment(eta: f64, n: i32) -> f64 {
    moment(1.0 / eta, n)
}

/// `∫ F(μ) μⁿ dμ` over the hemisphere's cosines from outside of a medium of this index.
pub(super) fn moment(eta: f64, n: i32) -> f64 {
    // Midpoints, closer to each other towards grazing and towards the critical angle, where F turns sharply.
    let critical = (1.0 - (eta * eta).min(1.0)).sqrt();
    let part = |from: f64, to: f64| {
        let m = 512;
        (0..m)
            .map(|i| {
                let x = (f64::from(i) + 0.5) / f64::from(m);
                // μ = from + (to − from) x², steep at the lower end.
                let mu = from + (to - from) * x * x;
                let f = f64::from(fresnel::dielectric(mu as f32, eta as f32));
                f * mu.powi(n) * (to - from) * 2.0 * x / f64::from(m)
            })
            .sum::<f64>()
    };
    part(0.0, critical) + part(critical, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::subsurface::{dipole, normalized_diffusion, photon_beam_diffusion};

    /// Photon beam diffusion without absorption tells 1.022 for an index of 1.33 and 1.087 for one of 1.
    #[test]
    fn no_more_light_leaves_than_entered() {
        let beams = [1.0, 1.33, 1.5].map(|eta| photon_beam_diffusion(0.0, eta));
        for table in beams.iter().chain([&dipole(1.3), &normalized_diffusion()]) {
            let total = |i: u16| table.albedo(f32::from(i) / 1000.0);
            assert!((0..=1000).all(|i| total(i) <= 1.0 + 1e-6), "{}", total(1000));
        }
        assert!((beams[1].albedo(1.0) - 1.0).abs() < 1e-6 && (beams[1].albedo(0.99) - 0.6743).abs() < 1e-3);
    }

    /// Straight across an object, where the distance in the plane is none, samples have a density, and no point is
    /// found so rarely that it counts for more than all lanes together would have it.
    #[test]
    fn values_are_bounded_by_densities() {
        let (sigma_t, albedo) = (Spectrum::new([1.0, 4.0, 20.0, 0.0]), Spectrum::new([0.99, 0.8, 0.1, 0.0]));
        for table in [dipole(1.3), normalized_diffusion(), photon_beam_diffusion(0.4, 1.3)] {
            let profile = Profile::new(&table, sigma_t, albedo, 3);
            let reach = profile.reach();
            for r in (0..400).map(|k| reach * (k as f32 / 400.0).powi(4)) {
                let (value, pdf) = (profile.value(r), profile.pdf(r));
                assert!(pdf > 0.0 && pdf.is_finite() && value.is_finite(), "{r}: {value:?} {pdf}");
                assert!(value.max_element() <= 3.001 * pdf, "{r}: {value:?} {pdf}");
            }
        }
    }
}
