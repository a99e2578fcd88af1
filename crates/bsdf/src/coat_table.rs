//! Transmission of a dielectric coat to its base, and internal reflection back at the base, as tables over angle and
//! roughness.
//!
//! Over a Lambertian base the light inside a coat is isotropic after the first scattering, so three functions say
//! everything (with the absorption `exp(−t/cosθ)` of a crossing of the coat, `t` its optical thickness):
//!
//! ```text
//! R(μ)   fraction reflected by the interface, from outside
//! T(μ)   fraction that reaches the base, from outside:   ∫ f_t(μ, ω) |cosθ| exp(−t/|cosθ|) dω
//! K      fraction of the base's light that comes back:   2 ∫₀¹ μ exp(−t/μ) ∫ f_r(μ, ω) cosθ exp(−t/cosθ) dω dμ
//! ```
//!
//! For a smooth interface they are Fresnel's equations; for a rough one they are integrated over visible normals.

use super::{Microfacet, NormalDistribution, Shadowing, coat_colors::CoatColors, fresnel};
use steradian_math::{Spectrum, Vec2, Vec3, cell, elementary::exp};

/// Interreflection of light between the coat and the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CoatSeries {
    /// The random walk of pbrt-v4's layered materials with a medium that only absorbs, in closed form.
    Layered {
        /// Optical thickness of the coat for a vertical crossing (≥ 0).
        thickness: f32,
        /// The walk meets at most this many interfaces, so the base at most half as often (rounded up); `u32::MAX` for
        /// no limit.
        max_depth: u32,
    },
    /// Mitsuba's plastic: no absorption, all orders of scattering.
    Plastic {
        /// True if the base tints each order of scattering (physical), false if the sum once.
        nonlinear: bool,
    },
}

impl CoatSeries {
    /// The light that leaves a base of albedo `rho` per light that reaches it, where the coat throws the fraction `k`
    /// back.
    #[inline]
    fn sum(self, rho: f32, k: f32) -> f32 {
        match self {
            Self::Layered { max_depth, .. } => {
                let orders = max_depth.div_ceil(2).min(i32::MAX as u32) as i32;
                // Σ (ρK)ⁿ for n < orders.
                rho * (1.0 - (rho * k).powi(orders)) / (1.0 - rho * k).max(1e-4)
            }
            Self::Plastic { nonlinear: true } => rho / (1.0 - rho * k).max(1e-4),
            Self::Plastic { nonlinear: false } => rho / (1.0 - k).max(1e-4),
        }
    }
}

/// Angles per row, at `μ = (i/(ANGLES − 1))²`: most of the change is near grazing.
const ANGLES: usize = 64;
/// Rows of a table whose roughness varies.
const ROWS: usize = 17;
/// Quadrature points over visible normals, seen from outside; and from inside, where total reflection begins abruptly.
/// Fibonacci's numbers: at these, multiples of the golden ratio are spread most evenly (the error from outside is
/// 3.3e-4 at α = 0.02 and 6e-5 from 0.1 on).
const NORMALS: (usize, usize) = (987, 1597);

/// One roughness.
#[derive(Clone, Debug)]
struct Row {
    /// `R` and `T` at each angle.
    interface: [[f32; 2]; ANGLES],
    internal: f32,
    mean_transmitted: f32,
    /// In tables for RGB whose base has a spectrum.
    colors: Option<CoatColors>,
}

/// The tables of one coat.
#[derive(Clone, Debug)]
pub struct CoatTable {
    eta: f32,
    series: CoatSeries,
    distribution: NormalDistribution,
    shadowing: Shadowing,
    /// Square root of the roughness of the first and the last row.
    sqrt_alpha: (f32, f32),
    rows: Vec<Row>,
    smooth_internal: f32,
    smooth_mean_transmitted: f32,
    smooth_colors: Option<CoatColors>,
}

/// A place between two rows of a [`CoatTable`].
#[derive(Clone, Copy, Debug)]
pub(super) struct RowPlace {
    row: u16,
    /// Weight of the next row, or negative for the smooth coat.
    next: f32,
}

impl CoatTable {
    /// Integrates the tables of a coat with index `eta` relative to the outside, for roughness values in `alpha`
    /// (smallest, largest). Deterministic; some 5 ms per row, one row for constant roughness and 17 for varying.
    ///
    /// Values out of range are clamped: `eta` to `[0.05, 20]`, thickness to `≥ 0`; NaN counts as index 1, thickness 0.
    pub fn new(
        distribution: NormalDistribution,
        shadowing: Shadowing,
        eta: f32,
        alpha: (f32, f32),
        series: CoatSeries,
    ) -> Self {
        let eta = if eta.is_nan() { 1.0 } else { eta.clamp(0.05, 20.0) };
        let series = match series {
            CoatSeries::Layered { thickness, max_depth } => {
                CoatSeries::Layered { thickness: thickness.max(0.0), max_depth }
            }
            plastic => plastic,
        };
        let sqrt_of = |a: f32| if a > 0.0 { a.min(16.0).sqrt() } else { 0.0 };
        let sqrt_alpha = (sqrt_of(alpha.0.min(alpha.1)), sqrt_of(alpha.1.max(alpha.0)));
        let mut table = Self {
            eta,
            series,
            distribution,
            shadowing,
            sqrt_alpha,
            rows: Vec::new(),
            smooth_internal: 0.0,
            smooth_mean_transmitted: 0.0,
            smooth_colors: None,
        };
        table.smooth_internal = match series {
            CoatSeries::Layered { .. } => {
                fresnel::dielectric_cosine_mean(1.0 / eta, |mu, _| f64::from(table.crossing(mu as f32)).powi(2))
            }
            // Mitsuba's own approximation, so that its pictures are met.
            CoatSeries::Plastic { .. } => fresnel::dielectric_diffuse_fit(1.0 / eta).clamp(0.0, 0.9999),
        };
        table.smooth_mean_transmitted = cosine_mean(eta, |mu| table.smooth_transmittance(mu));
        let span = sqrt_alpha.1 - sqrt_alpha.0;
        let count = if span < 1e-3 { 1 } else { ROWS };
        table.rows = (0..count)
            .map(|i| {
                let s = sqrt_alpha.0 + span * (i as f32 / (ROWS - 1) as f32);
                table.integrate_row(s * s)
            })
            .collect();
        table
    }

    /// Table for RGB lanes that stand for smooth spectra: powers of the albedo are taken over the spectra.
    #[must_use]
    pub fn over_rgb_spectra(mut self) -> Self {
        let series = self.series;
        let colors = |k: f32| Some(CoatColors::new(|rho| series.sum(rho, k)));
        self.smooth_colors = colors(self.smooth_internal);
        self.rows.iter_mut().for_each(|row| row.colors = colors(row.internal));
        self
    }

    /// Index of the coat relative to the outside.
    pub fn eta(&self) -> f32 {
        self.eta
    }

    /// The microfacets of the interface at the given roughness.
    pub(super) fn microfacet(&self, alpha_x: f32, alpha_y: f32) -> Microfacet {
        Microfacet::new(self.distribution, self.shadowing, alpha_x, alpha_y)
    }

    /// The rows that stand for a surface. Anisotropic coats use their mean roughness here.
    pub(super) fn place(&self, surface: &Microfacet) -> RowPlace {
        if surface.is_smooth() {
            return RowPlace { row: 0, next: -1.0 };
        }
        let last = self.rows.len() - 1;
        let span = self.sqrt_alpha.1 - self.sqrt_alpha.0;
        if last == 0 || span <= 0.0 {
            return RowPlace { row: 0, next: 0.0 };
        }
        let x = (surface.mean_alpha().sqrt() - self.sqrt_alpha.0) / span * last as f32;
        let x = x.clamp(0.0, last as f32);
        let row = (x as usize).min(last - 1);
        RowPlace { row: row as u16, next: x - row as f32 }
    }

    /// `R(μ)` and `T(μ)` for light from outside at `cos > 0`.
    #[inline]
    pub(super) fn interface(&self, place: RowPlace, cos: f32) -> (f32, f32) {
        if place.next < 0.0 {
            return self.smooth_interface(cos);
        }
        let (i, f) = cell(cos.min(1.0).sqrt() * (ANGLES - 1) as f32, ANGLES - 1);
        let at = |row: &Row| Vec2::from(row.interface[i]).lerp(Vec2::from(row.interface[i + 1]), f);
        let mut both = at(&self.rows[usize::from(place.row)]);
        if place.next != 0.0 {
            both = both.lerp(at(&self.rows[usize::from(place.row) + 1]), place.next);
        }
        both.into()
    }

    /// `2∫ T(μ) μ dμ`: the fraction of diffuse light from outside that reaches the base.
    pub(super) fn mean_transmitted(&self, place: RowPlace) -> f32 {
        self.between_rows(place, self.smooth_mean_transmitted, |r| r.mean_transmitted)
    }

    fn between_rows(&self, place: RowPlace, smooth: f32, of: impl Fn(&Row) -> f32) -> f32 {
        let row = usize::from(place.row);
        match place.next {
            n if n < 0.0 => smooth,
            0.0 => of(&self.rows[row]),
            n => of(&self.rows[row]) * (1.0 - n) + of(&self.rows[row + 1]) * n,
        }
    }

    /// The light that leaves a base of albedo `rho` per light that reaches it, with all that is thrown back at it
    /// summed up.
    pub(super) fn multiply_scattered(&self, place: RowPlace, rho: Spectrum) -> Spectrum {
        if let Some(smooth) = &self.smooth_colors {
            let of = |row: usize| self.rows[row].colors.as_ref().unwrap_or(smooth).multiply_scattered(rho);
            let row = usize::from(place.row);
            return match place.next {
                n if n < 0.0 => smooth.multiply_scattered(rho),
                0.0 => of(row),
                n => of(row) * (1.0 - n) + of(row + 1) * n,
            };
        }
        let k = self.between_rows(place, self.smooth_internal, |r| r.internal);
        rho.map(|rho| self.series.sum(rho, k))
    }

    /// Transmittance of the coat's medium for a crossing at cosine `mu`.
    #[inline]
    fn crossing(&self, mu: f32) -> f32 {
        match self.series {
            CoatSeries::Layered { thickness, .. } if thickness > 0.0 => exp(-thickness / mu.abs()),
            _ => 1.0,
        }
    }

    /// `R(μ)` and `T(μ)` of a smooth interface.
    #[inline]
    fn smooth_interface(&self, cos: f32) -> (f32, f32) {
        let at = fresnel::Crossing::new(cos, self.eta);
        let r = at.reflectance;
        let passes = match self.series {
            CoatSeries::Layered { thickness, .. } if thickness > 0.0 && r < 1.0 => {
                exp(-(thickness * at.eta) / at.refracted)
            }
            _ => 1.0,
        };
        (r, (1.0 - r) * passes)
    }

    /// `T(μ)` of a smooth interface.
    fn smooth_transmittance(&self, cos: f32) -> f32 {
        self.smooth_interface(cos).1
    }

    fn integrate_row(&self, alpha: f32) -> Row {
        let surface = self.microfacet(alpha, alpha);
        let mu = |i: usize| (i as f32 / (ANGLES - 1) as f32).powi(2).max(1e-6);
        if surface.is_smooth() {
            return Row {
                interface: std::array::from_fn(|i| self.smooth_interface(mu(i)).into()),
                internal: self.smooth_internal,
                mean_transmitted: self.smooth_mean_transmitted,
                colors: None,
            };
        }
        let interface: [[f32; 2]; ANGLES] = std::array::from_fn(|i| {
            let wo = direction(mu(i));
            over_normals(NORMALS.0, &surface, wo, |m| {
                [reflected(&surface, wo, m, self.eta), self.transmitted_to_base(&surface, wo, m)]
            })
        });
        let inside = |mu: f32| {
            let wo = direction(mu);
            let [sum] = over_normals(NORMALS.1, &surface, wo, |m| {
                let up = fresnel::reflect(wo, m).z;
                [if up > 0.0 { reflected(&surface, wo, m, 1.0 / self.eta) * self.crossing(up) } else { 0.0 }]
            });
            sum
        };
        let internal = match self.series {
            CoatSeries::Layered { .. } => cosine_mean(1.0 / self.eta, |mu| self.crossing(mu) * inside(mu)),
            // Mitsuba averages 64 equidistant cosines with both ends, which is 1.5 % below the integral: kept, so that
            // its pictures are met.
            CoatSeries::Plastic { .. } => {
                (0..64).map(|i| (i as f32 / 63.0).max(1e-6)).map(|mu| mu * inside(mu)).sum::<f32>() / 32.0
            }
        };
        let row = Row { interface, internal: internal.clamp(0.0, 0.9999), mean_transmitted: 0.0, colors: None };
        let mean_transmitted = cosine_mean(self.eta, |mu| {
            let (i, f) = cell(mu.sqrt() * (ANGLES - 1) as f32, ANGLES - 1);
            let [a, b] = [row.interface[i][1], row.interface[i + 1][1]];
            a + (b - a) * f
        });
        Row { mean_transmitted, ..row }
    }

    /// Transmission from `wo` outside to the base through a visible normal `m`.
    fn transmitted_to_base(&self, surface: &Microfacet, wo: Vec3, m: Vec3) -> f32 {
        let Some((wi, _)) = fresnel::refract(wo, m, self.eta) else { return 0.0 };
        if wi.z >= 0.0 {
            return 0.0;
        }
        let f = fresnel::dielectric(wo.dot(m), self.eta);
        (1.0 - f) * surface.sampled_weight(wo, wi, m) * self.crossing(wi.z)
    }
}

/// Reflection from a visible normal `m`, with `eta` the index beyond the interface.
fn reflected(surface: &Microfacet, wo: Vec3, m: Vec3, eta: f32) -> f32 {
    let wi = fresnel::reflect(wo, m);
    if wi.z <= 0.0 {
        return 0.0;
    }
    fresnel::dielectric(wo.dot(m), eta) * surface.sampled_weight(wo, wi, m)
}

fn direction(mu: f32) -> Vec3 {
    Vec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu)
}

/// The mean over the visible normals of `wo`, by the points of a lattice (multiples of the golden ratio).
fn over_normals<const N: usize>(
    count: usize,
    surface: &Microfacet,
    wo: Vec3,
    of: impl Fn(Vec3) -> [f32; N],
) -> [f32; N] {
    let mut sum = [0.0; N];
    for i in 0..count {
        let i = i as f64 + 0.5;
        let u = Vec2::new((i * 0.618_033_988_749_894_9).fract() as f32, (i / count as f64) as f32);
        for (s, v) in sum.iter_mut().zip(of(surface.sample_visible(wo, u))) {
            *s += v;
        }
    }
    sum.map(|s| s / count as f32)
}

/// `2∫₀¹ f(μ) μ dμ` for light that meets the relative index `eta`, by the midpoint rule: below the critical cosine
/// evenly, above it in the square root of the distance, where reflection changes evenly.
fn cosine_mean(eta: f32, f: impl Fn(f32) -> f32) -> f32 {
    const N: usize = 32;
    let critical = (1.0 - eta * eta).max(0.0).sqrt();
    let x = |i: usize| (i as f32 + 0.5) / N as f32;
    let below: f32 =
        if critical > 0.0 { (0..N).map(|i| critical * x(i)).map(|mu| 2.0 * f(mu) * mu * critical).sum() } else { 0.0 };
    let above: f32 = (0..N)
        .map(|i| {
            let mu = critical + (1.0 - critical) * x(i) * x(i);
            4.0 * f(mu) * mu * (1.0 - critical) * x(i)
        })
        .sum();
    (below + above) / N as f32
}
