//! Light that is scattered more than once: order by order, the moments of each order's radiance give the next one's
//! source (successive orders of scattering in spherical air).
//!
//! Moments are tabulated over height and the sun's angle from the zenith, for a sun without extent whose irradiance is
//! one. Of the series that remains after the last order all are taken to follow the ratio of the last two.

use super::{
    data::BANDS,
    medium::{Medium, Optics},
    moments::{self, Factors, Harmonics},
    path::{Step, Sunward, Way, horizon},
};
use rayon::prelude::*;
use std::f64::consts::PI;
use steradian_math::{elementary, quadrature::gauss_legendre};

/// One of how many bands the table has.
pub(super) const SPARSE: usize = 3;
pub(super) const FEW: usize = BANDS / SPARSE;
type Few = [f32; FEW];

const HEIGHTS: usize = 15;
const HIGHEST: f64 = 80.0;
/// Directions above and below the horizon, and over half a turn.
const UP: usize = 8;
const DOWN: usize = 6;
const AROUND: usize = 7;
/// Pieces of ways on either side of the place nearest to the ground.
const PIECES: usize = 12;
const ORDERS: usize = 4;

/// The light at places: its moments, and the irradiance of the ground.
#[derive(Clone, Debug)]
struct Field {
    /// By height, then by the sun's angle, then by harmonic.
    moments: Vec<Few>,
    /// By the sun's angle.
    ground: Vec<Few>,
}

/// All orders from the first on, as the source of all from the second on.
#[derive(Clone, Debug)]
pub(super) struct Orders {
    angles: Angles,
    harmonics: Harmonics,
    molecules: Factors,
    aerosols: Factors,
    optics: Optics<FEW>,
    field: Field,
}

/// The sun's angles from the zenith: the first, from one to the next, and how many.
#[derive(Clone, Copy, Debug)]
struct Angles {
    first: f64,
    step: f64,
    count: usize,
}

/// Number of parts of each step between angles at which light is gathered.
const FINE: usize = 4;

impl Angles {
    /// Around an angle: where the sun is low, closer, and farther towards the day.
    fn around(zenith: f64) -> Self {
        let degrees = zenith.to_degrees();
        let (first, last, step) =
            if degrees < 75.0 { (degrees - 12.0, degrees + 12.0, 4.0) } else { (degrees - 16.0, degrees + 10.0, 2.0) };
        let first: f64 = first.max(0.0);
        let count = ((last - first) / step).round() as usize + 1;
        Self { first: first.to_radians(), step: f64::to_radians(step), count }
    }

    /// With those between.
    fn fine(&self) -> Self {
        Self { step: self.step / FINE as f64, count: (self.count - 1) * FINE + 1, ..*self }
    }

    /// The angle below, and how far it is to the next.
    fn place(&self, mu: f64) -> (usize, f32) {
        let x = ((mu.clamp(-1.0, 1.0).acos() - self.first) / self.step).clamp(0.0, (self.count - 1) as f64);
        let i = (x as usize).min(self.count - 2);
        (i, (x - i as f64) as f32)
    }

    fn angle(&self, i: usize) -> f64 {
        self.first + self.step * i as f64
    }

    /// Lists by angle with those between, by Catmull's and Rom's curves.
    fn refined(&self, lists: &[Few], size: usize) -> Vec<Few> {
        // Refine the table over the sun's angle by cubic interpolation.
        let at = |i: i64, k: usize| &lists[i.clamp(0, self.count as i64 - 1) as usize * size + k];
        let mut out = Vec::with_capacity(self.fine().count * size);
        for fine in 0..self.fine().count {
            let (i, t) = ((fine / FINE) as i64, (fine % FINE) as f32 / FINE as f32);
            let (t2, t3) = (t * t, t * t * t);
            let w = [-t + 2.0 * t2 - t3, 2.0 - 5.0 * t2 + 3.0 * t3, t + 4.0 * t2 - 3.0 * t3, t3 - t2].map(|w| 0.5 * w);
            for k in 0..size {
                let p = [at(i - 1, k), at(i, k), at(i + 1, k), at(i + 2, k)];
                out.push(std::array::from_fn(|b| (0..4).map(|j| w[j] * p[j][b]).sum()));
            }
        }
        out
    }
}

/// Adds a multiple.
#[inline]
fn add(sum: &mut Few, factor: f32, values: &Few) {
    for b in 0..FEW {
        sum[b] += factor * values[b];
    }
}

fn height(i: usize) -> f64 {
    // Heights spaced by squares, dense near the ground.
    HIGHEST * (i as f64 / (HEIGHTS - 1) as f64).powi(2)
}

/// Transmittance of a path segment, and its mean over the segment.
#[inline]
fn dimming(tau: f32) -> (f32, f32) {
    // Mean transmittance over a segment of depth τ is (1 − e^−τ)/τ, by its series where τ is small.
    let left = elementary::exp(-tau);
    (left, if tau < 0.01 { 1.0 - tau * (0.5 - tau / 6.0) } else { (1.0 - left) / tau })
}

/// Dims by a piece of a way; calls `add` with each band and the weight of what the piece emits on all of it.
#[inline]
pub(super) fn pass<const N: usize>(
    optics: &Optics<N>,
    amounts: &[f32; 3],
    through: &mut [f32; N],
    mut add: impl FnMut(usize, f32),
) {
    for (b, through) in through.iter_mut().enumerate() {
        // τ = Σ depth per unit column · amount, over molecules, aerosols and ozone.
        let tau = optics.rayleigh[b] * amounts[0] + optics.aerosol[b] * amounts[1] + optics.ozone[b] * amounts[2];
        let (left, mean) = dimming(tau);
        add(b, *through * mean);
        *through *= left;
    }
}

/// The part of sunlight that passes columns.
pub(super) fn passed<const N: usize>(optics: &Optics<N>, columns: &[f32; 3]) -> [f32; N] {
    std::array::from_fn(|b| {
        let tau = optics.rayleigh[b] * columns[0] + optics.aerosol[b] * columns[1] + optics.ozone[b] * columns[2];
        elementary::exp(-tau)
    })
}

impl Field {
    fn add(&mut self, other: &Self) {
        let add = |a: &mut Few, b: &Few| a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        let lists = self.moments.iter_mut().zip(&other.moments);
        lists.chain(self.ground.iter_mut().zip(&other.ground)).for_each(|(a, b)| add(a, b));
    }

    /// All that follows this order, each the one before times the ratio of this to its own.
    fn rest(&self, before: &Self, count: usize) -> Self {
        // Geometric series of the remaining orders: r/(1 − r), with r the ratio of the last two.
        let series = |now: f32, before: f32| {
            let ratio = if before > 0.0 { (now / before).clamp(0.0, 0.97) } else { 0.0 };
            ratio / (1.0 - ratio)
        };
        let mut rest = self.clone();
        for (now, before) in rest.moments.chunks_mut(count).zip(before.moments.chunks(count)) {
            let factor: Few = std::array::from_fn(|b| series(now[0][b], before[0][b]));
            now.iter_mut().for_each(|m| m.iter_mut().zip(&factor).for_each(|(m, f)| *m *= f));
        }
        for (now, before) in rest.ground.iter_mut().zip(&before.ground) {
            now.iter_mut().zip(before).for_each(|(n, b)| *n *= series(*n, *b));
        }
        rest
    }
}

impl Orders {
    /// Around an angle of the sun from the zenith. The medium's aerosols are without what goes straight on.
    pub(super) fn new(medium: &Medium, zenith: f64, sunward: &Sunward) -> Self {
        let angles = Angles::around(zenith);
        let optics: Optics<FEW> = medium.optics.thinned();
        let mut all = Self {
            angles,
            harmonics: Harmonics::new(optics.scattering[0] > 0.0),
            molecules: moments::of_molecules(medium.gamma[20]),
            aerosols: moments::of_aerosols(medium.g).1,
            optics,
            field: Field { moments: Vec::new(), ground: Vec::new() },
        };
        // First order: sunlight, scattered once. Each further order scatters the one before.
        all.field = all.next(medium, None, sunward);
        let mut last = all.clone();
        for order in 2..=ORDERS {
            let next = all.next(medium, Some(&last), sunward);
            all.field.add(&next);
            if order == ORDERS {
                all.field.add(&next.rest(&last.field, all.harmonics.count));
            }
            last.field = next;
        }
        all
    }

    /// The light that a source makes, or the sun.
    fn next(&self, medium: &Medium, source: Option<&Self>, sunward: &Sunward) -> Field {
        let (angles, count) = (self.angles, self.harmonics.count);
        // Gather at every height and angle of the sun in parallel.
        let nodes: Vec<(Vec<Few>, Few)> = (0..HEIGHTS * angles.count)
            .into_par_iter()
            .map(|i| self.gather(medium, source, sunward, height(i / angles.count), i % angles.count))
            .collect();
        let ground: Vec<Few> = nodes[..angles.count].iter().map(|n| n.1).collect();
        let moments: Vec<Few> = nodes.into_iter().flat_map(|n| n.0).collect();
        // Catmull–Rom curves fill in the angles between those that were gathered.
        let rows = moments.chunks(angles.count * count).flat_map(|row| angles.refined(row, count));
        Field { moments: rows.collect(), ground: angles.refined(&ground, 1) }
    }

    /// The moments of light at a height, and the irradiance from above.
    fn gather(
        &self,
        medium: &Medium,
        source: Option<&Self>,
        sunward: &Sunward,
        height: f64,
        angle: usize,
    ) -> (Vec<Few>, Few) {
        let (sin_sun, mu_sun) = self.angles.angle(angle).sin_cos();
        let lowest = horizon(medium.radius, height);
        let (mut moments, mut irradiance) = (vec![[0.0; FEW]; self.harmonics.count], [0.0; FEW]);
        // Gauss–Legendre quadrature above and below the horizon, midpoints in azimuth.
        for (from, to, count) in [(lowest, 1.0, UP), (-1.0, lowest, DOWN)] {
            for (x, weight) in gauss_legendre(count) {
                let mu = 0.5 * (from + to) + 0.5 * (to - from) * x;
                let sin = (1.0 - mu * mu).max(0.0).sqrt();
                for k in 0..AROUND {
                    let across = sin * (PI * (k as f64 + 0.5) / AROUND as f64).cos();
                    let nu = across * sin_sun + mu * mu_sun;
                    let way = Way { height, mu, mu_sun, nu, can_hit: to < 1.0 };
                    let light = self.light(medium, source, sunward, &way);
                    // Solid angle of the quadrature node.
                    let w = (weight * 0.5 * (to - from) * 2.0 * PI / AROUND as f64) as f32;
                    // Project the radiance onto the harmonics: L_lm = ∫ L(ω) Y_lm(ω) dω.
                    let y = self.harmonics.at(across as f32, mu as f32).map(|y| y * w);
                    for (m, y) in moments.iter_mut().zip(y) {
                        add(m, y, &light);
                    }
                    add(&mut irradiance, w * mu.max(0.0) as f32, &light);
                }
            }
        }
        (moments, irradiance)
    }

    /// The radiance that comes along a way from a source, or from the sun by one scattering.
    pub(super) fn light(&self, medium: &Medium, source: Option<&Self>, sunward: &Sunward, way: &Way) -> Few {
        let (steps, ground) = way.steps(medium, PIECES);
        let (mut through, mut light) = ([1.0; FEW], [0.0; FEW]);
        // March along the way: emission of each piece times the transmittance before it.
        for step in &steps {
            let emitted = match source {
                Some(source) => source.scattered(step, way.nu),
                None => match sunward.columns(step.height, step.mu_sun) {
                    Some(columns) => self.scattered_once(&passed(&self.optics, &columns), step, way.nu as f32),
                    None => [0.0; FEW],
                },
            };
            pass(&self.optics, &step.amounts, &mut through, |b, weight| light[b] += weight * emitted[b]);
        }
        // Lambertian ground: L = ρ·E/π at the end of the way.
        if let Some(mu_sun) = ground {
            let irradiance = match source {
                Some(source) => source.on_ground(mu_sun),
                None => sunward
                    .columns(0.0, mu_sun)
                    .map_or([0.0; FEW], |columns| passed(&self.optics, &columns).map(|p| p * mu_sun.max(0.0) as f32)),
            };
            for b in 0..FEW {
                light[b] += through[b] * self.optics.ground[b] * irradiance[b] / std::f32::consts::PI;
            }
        }
        light
    }

    /// Single scattering of sunlight on a path segment. Phase functions end at the degree of the moments.
    fn scattered_once(&self, sunlight: &Few, step: &Step, nu: f32) -> Few {
        let molecules = step.amounts[0] * self.harmonics.phase(&self.molecules, nu);
        let aerosols = step.amounts[1] * self.harmonics.phase(&self.aerosols, nu);
        std::array::from_fn(|b| {
            sunlight[b] * (self.optics.rayleigh[b] * molecules + self.optics.scattering[b] * aerosols)
        })
    }

    /// Scattering on a path segment of the light that arrives from all sides.
    fn scattered(&self, step: &Step, nu: f64) -> Few {
        let (molecules, aerosols) = self.arriving(step, nu);
        let (air, dust) = (step.amounts[0], step.amounts[1]);
        std::array::from_fn(|b| {
            self.optics.rayleigh[b] * air * molecules[b] + self.optics.scattering[b] * dust * aerosols[b]
        })
    }

    /// The light that comes to a piece of a way, weighted by the phase functions of molecules and of aerosols.
    pub(super) fn arriving(&self, step: &Step, nu: f64) -> (Few, Few) {
        // Recover azimuth from the three cosines to evaluate the harmonics.
        let sin_sun = (1.0 - step.mu_sun * step.mu_sun).max(0.0).sqrt();
        let sin = (1.0 - step.mu * step.mu).max(0.0).sqrt();
        let along = if sin_sun > 1e-6 { (nu - step.mu * step.mu_sun) / sin_sun } else { 0.0 };
        let y = self.harmonics.at(along.clamp(-sin, sin) as f32, step.mu as f32);
        // Bilinear interpolation over height and the sun's angle.
        let x = (step.height / HIGHEST).clamp(0.0, 1.0).sqrt() * (HEIGHTS - 1) as f64;
        let i = (x as usize).min(HEIGHTS - 2);
        // Linear over height between two of them.
        let s = ((step.height - height(i)) / (height(i + 1) - height(i))).clamp(0.0, 1.0) as f32;
        let angles = self.angles.fine();
        let (j, t) = angles.place(step.mu_sun);
        let corner = i * angles.count + j;
        let corners = [
            (corner, (1.0 - s) * (1.0 - t)),
            (corner + 1, (1.0 - s) * t),
            (corner + angles.count, s * (1.0 - t)),
            (corner + angles.count + 1, s * t),
        ];
        let (mut molecules, mut aerosols) = ([0.0; FEW], [0.0; FEW]);
        let is_dusty = self.harmonics.degree > 2 && step.amounts[1] > 1e-5;
        // Convolve with the phase functions: multiply every moment by the factor of its degree.
        for (at, weight) in corners {
            let moments = &self.field.moments[at * self.harmonics.count..][..self.harmonics.count];
            for (k, m) in moments.iter().enumerate() {
                let degree = self.harmonics.degrees[k];
                let y = weight * y[k];
                if degree == 0 || degree == 2 {
                    let a = y * self.molecules[degree];
                    add(&mut molecules, a, m);
                }
                if is_dusty {
                    let a = y * self.aerosols[degree];
                    add(&mut aerosols, a, m);
                }
            }
        }
        (molecules, aerosols)
    }

    /// The irradiance of the ground where the sun has a cosine with the vertical.
    fn on_ground(&self, mu_sun: f64) -> Few {
        let (j, t) = self.angles.fine().place(mu_sun);
        std::array::from_fn(|b| self.field.ground[j][b] * (1.0 - t) + self.field.ground[j + 1][b] * t)
    }
}
