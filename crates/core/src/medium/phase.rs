//! Phase functions: the density per solid angle with which light that scatters in a medium goes on in a direction.
//! Their values are the densities of their samples, so that throughput is unchanged.
//!
//! Beside Henyey and Greenstein's there are Rayleigh's, `3(1 + cos²θ)/(16π)` (Rayleigh 1871; PBR 4th ed., 11.3), tables
//! over the cosine of the deflection (Mitsuba 3, plugin documentation: tabphase), Draine's, and weighted sums of all of
//! these.

use super::Draine;
use std::{f32::consts::PI, sync::Arc};
use steradian_math::{
    Frame, Vec2, Vec3, elementary,
    hash::ONE_MINUS_EPSILON,
    warp::{hg_phase, sample_hg},
};

/// A phase function.
#[derive(Clone, Debug)]
pub enum Phase {
    /// Henyey and Greenstein's, with its mean cosine; 0 is isotropic.
    HenyeyGreenstein(f32),
    /// A sum of lobes with their weights, which sum to one.
    Lobes(Arc<[(f32, Lobe)]>),
}

/// One lobe of a phase function.
#[derive(Clone, Debug)]
pub enum Lobe {
    /// Henyey and Greenstein's, with its mean cosine.
    HenyeyGreenstein(f32),
    /// Scattering by particles much smaller than the wavelength.
    Rayleigh,
    /// Draine's.
    Draine(Draine),
    /// Linear between values at even steps of the cosine.
    Table(Table),
}

/// A density over the cosine of the deflection, linear between values at even steps from −1 (back) to 1 (straight on).
#[derive(Clone, Debug)]
pub struct Table {
    /// Densities per unit cosine.
    values: Vec<f32>,
    /// The integral up to each value; the last is 1.
    cumulative: Vec<f32>,
}

impl Phase {
    /// Isotropic scattering: 1/(4π) in all directions.
    pub const ISOTROPIC: Self = Self::HenyeyGreenstein(0.0);

    /// A sum of phase functions with weights that are not negative; isotropic where all are zero.
    pub fn sum(parts: &[(f32, Self)]) -> Self {
        let total: f32 = parts.iter().map(|(weight, _)| weight).sum();
        let mut lobes = Vec::new();
        // Flatten sums of sums, with products of weights.
        for (weight, phase) in parts.iter().filter(|(weight, _)| *weight > 0.0) {
            match phase {
                Self::HenyeyGreenstein(g) => lobes.push((weight / total, Lobe::HenyeyGreenstein(*g))),
                Self::Lobes(inner) => lobes.extend(inner.iter().map(|(w, lobe)| (w * weight / total, lobe.clone()))),
            }
        }
        // A single lobe of Henyey and Greenstein keeps its closed form.
        match &*lobes {
            [] => Self::ISOTROPIC,
            [(_, Lobe::HenyeyGreenstein(g))] => Self::HenyeyGreenstein(*g),
            _ => Self::Lobes(lobes.into()),
        }
    }

    /// One lobe.
    pub fn of(lobe: Lobe) -> Self {
        Self::Lobes([(1.0, lobe)].into())
    }

    /// The mean cosine, where it is Henyey and Greenstein's alone.
    #[inline]
    pub fn henyey_greenstein(&self) -> Option<f32> {
        match self {
            Self::HenyeyGreenstein(g) => Some(*g),
            Self::Lobes(_) => None,
        }
    }

    /// The largest mean cosine of a lobe, forwards or backwards; 1 for a table, which may have any peak.
    pub fn sharpest(&self) -> f32 {
        let of_lobe = |lobe: &Lobe| match lobe {
            Lobe::HenyeyGreenstein(g) => g.abs(),
            Lobe::Rayleigh => 0.0,
            Lobe::Draine(draine) => draine.asymmetry().abs(),
            Lobe::Table(_) => 1.0,
        };
        match self {
            Self::HenyeyGreenstein(g) => g.abs(),
            Self::Lobes(lobes) => lobes.iter().fold(0.0, |most, (_, lobe)| most.max(of_lobe(lobe))),
        }
    }

    /// The value, 1/sr, for `cos = wo·wi` of directions that point away from the point: −1 is straight on.
    #[inline]
    pub fn value(&self, cos: f32) -> f32 {
        match self {
            Self::HenyeyGreenstein(g) => hg_phase(cos, *g),
            Self::Lobes(lobes) => lobes.iter().map(|(weight, lobe)| weight * lobe.value(cos)).sum(),
        }
    }

    /// A direction with density [`Phase::value`], and that density.
    #[inline]
    pub fn sample(&self, wo: Vec3, u: Vec2) -> (Vec3, f32) {
        match self {
            Self::HenyeyGreenstein(g) => sample_hg(wo, *g, u),
            Self::Lobes(lobes) => {
                // The first number chooses the lobe, and is used again within its share.
                let (mut x, mut chosen) = (u.x, None);
                for (weight, lobe) in &**lobes {
                    chosen = Some(lobe);
                    if x < *weight {
                        x /= weight;
                        break;
                    }
                    x -= weight;
                }
                let u = Vec2::new(x.clamp(0.0, ONE_MINUS_EPSILON), u.y);
                let wi = chosen.map_or(-wo, |lobe| lobe.sample(wo, u));
                (wi, self.value(wo.dot(wi)))
            }
        }
    }
}

impl Lobe {
    fn value(&self, cos: f32) -> f32 {
        match self {
            Self::HenyeyGreenstein(g) => hg_phase(cos, *g),
            Self::Rayleigh => 3.0 / (16.0 * PI) * (1.0 + cos * cos),
            Self::Draine(draine) => draine.value(-cos),
            Self::Table(table) => table.density(-cos) / (2.0 * PI),
        }
    }

    fn sample(&self, wo: Vec3, u: Vec2) -> Vec3 {
        let cos = match self {
            Self::HenyeyGreenstein(g) => return sample_hg(wo, *g, u).0,
            // The real root of c³ + 3c = 8u − 4 (Frisvad 2011, "Importance sampling the Rayleigh phase function").
            Self::Rayleigh => {
                let z = f64::from(4.0 * u.x - 2.0);
                let root = (z + (z * z + 1.0).sqrt()).cbrt();
                (root - 1.0 / root) as f32
            }
            Self::Draine(draine) => draine.invert(u.x),
            Self::Table(table) => table.invert(u.x),
        };
        let cos = cos.clamp(-1.0, 1.0);
        // Around the direction straight on: sin θ by factors, which keeps digits near the poles.
        let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
        let (sin_phi, cos_phi) = elementary::sin_cos_turns(u.y);
        Frame::from_z(-wo).to_world(Vec3::new(sin * cos_phi, sin * sin_phi, cos))
    }
}

impl Table {
    /// From two values or more in any scale, none negative; `None` where that is not so, or all are zero.
    pub fn new(values: &[f64]) -> Option<Self> {
        let step = 2.0 / (values.len().checked_sub(1).filter(|steps| *steps > 0)? as f64);
        let is_sound = values.iter().all(|v| (0.0..=f64::from(f32::MAX)).contains(v));
        let mut sums = vec![0.0];
        // Trapezoids between values give the cumulative distribution.
        for pair in values.windows(2) {
            sums.push(sums[sums.len() - 1] + 0.5 * (pair[0] + pair[1]) * step);
        }
        let total = sums[sums.len() - 1];
        (is_sound && total > 0.0).then(|| Self {
            values: values.iter().map(|v| (v / total) as f32).collect(),
            cumulative: sums.iter().map(|s| (s / total) as f32).collect(),
        })
    }

    fn steps(&self) -> usize {
        self.values.len() - 1
    }

    fn density(&self, cos: f32) -> f32 {
        // Linear interpolation over the cosine.
        let x = (0.5 * (cos + 1.0)).clamp(0.0, 1.0) * self.steps() as f32;
        let i = (x as usize).min(self.steps() - 1);
        let [a, b] = [self.values[i], self.values[i + 1]];
        a + (b - a) * (x - i as f32)
    }

    /// The cosine up to which the integral is `u`.
    fn invert(&self, u: f32) -> f32 {
        // Find the interval by binary search, then invert the quadratic within it.
        let i = self.cumulative.partition_point(|c| *c <= u).saturating_sub(1).min(self.steps() - 1);
        let step = 2.0 / self.steps() as f32;
        let ([a, b], rest) = ([self.values[i], self.values[i + 1]], (u - self.cumulative[i]) / step);
        // rest = a t + (b − a) t²/2, solved without cancellation.
        let t = 2.0 * rest / (a + (a * a + 2.0 * (b - a) * rest).max(0.0).sqrt()).max(f32::MIN_POSITIVE);
        -1.0 + step * (i as f32 + t.clamp(0.0, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::hash::HashRng;
    use steradian_testkit::{chi2_test, sidak};

    fn all() -> Vec<(&'static str, Phase)> {
        let table = Table::new(&[3.0, 0.0, 0.5, 0.5, 8.0]).expect("a table");
        let hg = Phase::HenyeyGreenstein(-0.5);
        vec![
            ("Rayleigh", Phase::of(Lobe::Rayleigh)),
            ("Draine", Phase::of(Lobe::Draine(Draine::new(0.5, 20.0)))),
            ("back", Phase::of(Lobe::Draine(Draine::new(-0.3, 1.0)))),
            ("table", Phase::of(Lobe::Table(table.clone()))),
            ("two lobes", Phase::sum(&[(0.7, hg.clone()), (0.3, Phase::ISOTROPIC)])),
            (
                "nested",
                Phase::sum(&[
                    (1.0, Phase::sum(&[(1.0, hg), (1.0, Phase::of(Lobe::Table(table)))])),
                    (3.0, Phase::of(Lobe::Rayleigh)),
                ]),
            ),
        ]
    }

    /// χ² over 40 × 8 cells of cosine and azimuth, against the value at 16 midpoints of each; and each sample comes
    /// with the density that is its value.
    #[test]
    fn samples_follow_the_phase_functions() {
        const CELLS: [usize; 2] = [40, 8];
        let wo = Vec3::new(0.3, -0.5, 0.8).normalize();
        let frame = Frame::from_z(wo);
        for (name, phase) in all() {
            let (mut rng, mut observed) = (HashRng::new(7), vec![0u64; CELLS[0] * CELLS[1]]);
            let samples = 200_000_u32;
            for _ in 0..samples {
                let (wi, pdf) = phase.sample(wo, Vec2::new(rng.next_f32(), rng.next_f32()));
                let (w, value) = (frame.to_local(wi), phase.value(wo.dot(wi)));
                assert!((pdf - value).abs() <= 1e-5 * value && (wi.length() - 1.0).abs() < 1e-5, "{name}");
                let place = [0.5 * (w.z + 1.0), w.y.atan2(w.x) / (2.0 * PI) + 0.5];
                let cell = [0, 1].map(|k| ((place[k] * CELLS[k] as f32) as usize).min(CELLS[k] - 1));
                observed[cell[0] * CELLS[1] + cell[1]] += 1;
            }
            let row = |i: usize| {
                let at = |k: usize| -1.0 + 2.0 * (i as f32 + (k as f32 + 0.5) / 16.0) / CELLS[0] as f32;
                let mean = (0..16).map(|k| f64::from(phase.value(at(k)))).sum::<f64>() / 16.0;
                mean * f64::from(samples) * 4.0 * std::f64::consts::PI / (CELLS[0] * CELLS[1]) as f64
            };
            let expected: Vec<f64> = (0..CELLS[0]).flat_map(|i| [row(i); CELLS[1]]).collect();
            let found = chi2_test(&observed, &expected, samples.into());
            assert!(found.p_value > sidak(0.01, all().len()), "{name}: {found:?}");
        }
    }

    /// Tables are linear, and turned the right way: the last value is straight on.
    #[test]
    fn tables_are_normalised_and_point_forwards() {
        let phase = Phase::of(Lobe::Table(Table::new(&[0.0, 1.0]).expect("a table")));
        assert!((phase.value(-1.0) - 1.0 / (2.0 * PI)).abs() < 1e-6 && phase.value(1.0) == 0.0);
        assert!((phase.value(0.0) - 0.5 / (2.0 * PI)).abs() < 1e-6);
        for wrong in [&[1.0][..], &[], &[0.0, 0.0], &[1.0, -1.0], &[f64::NAN, 1.0]] {
            assert!(Table::new(wrong).is_none(), "{wrong:?}");
        }
    }
}
