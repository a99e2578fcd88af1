//! Sampling for tabulated reflection: half vectors by a histogram over their angle, mixed with cosine-distributed
//! directions.

use std::f64::consts::{FRAC_PI_2, PI};
use steradian_math::{Vec2, Vec3, warp};

/// Bins of the histogram, narrow around the normal where mirrors have their peak.
const BINS: usize = 90;
/// Share of the cosine-distributed directions.
const COSINE: f32 = 0.4;
/// Angles of the viewer over which the histogram is averaged, as cosines.
const VIEWS: [f64; 6] = [0.98, 0.9, 0.75, 0.55, 0.35, 0.15];
const AZIMUTHS: u32 = 24;

/// A density of directions.
#[derive(Clone, Debug)]
pub struct HalfVectors {
    /// Bounds of the bins as `1 − cosθ`, which keeps its precision at the normal.
    edges: [f32; BINS + 1],
    /// Sum of the shares of all bins before.
    cdf: [f32; BINS + 1],
}

impl HalfVectors {
    /// Fits the histogram to the power that `f_cos(wo, wi)`, the luminance of `f·cosθ_i`, scatters through each bin.
    pub fn fit(f_cos: impl Fn(Vec3, Vec3) -> f32) -> Self {
        let edge = |b: usize| {
            // Edges by the square of the index in angle, dense at the mirror peak; 1 − cos θ = 2 sin²(θ/2).
            let theta = (b as f64 / BINS as f64).powi(2) * FRAC_PI_2;
            2.0 * (theta / 2.0).sin().powi(2)
        };
        let edges: [f64; BINS + 1] = std::array::from_fn(edge);
        let mut power = [0.0f64; BINS];
        // Average over views, each normalised, so that grazing ones do not dominate.
        for mu in VIEWS {
            let wo = Vec3::new((1.0 - mu * mu).sqrt() as f32, 0.0, mu as f32);
            let mut seen = [0.0f64; BINS];
            for (b, seen) in seen.iter_mut().enumerate() {
                // Half vectors in the middle of the bin, over the azimuth.
                let t = 0.5 * (edges[b] + edges[b + 1]);
                let (cos, sin) = (1.0 - t, (t * (2.0 - t)).sqrt());
                for a in 0..AZIMUTHS {
                    let phi = (f64::from(a) + 0.5) / f64::from(AZIMUTHS) * 2.0 * PI;
                    let h = Vec3::new((sin * phi.cos()) as f32, (sin * phi.sin()) as f32, cos as f32);
                    let d = wo.dot(h);
                    let wi = 2.0 * d * h - wo;
                    if d > 0.0 && wi.z > 0.0 {
                        // Power through the bin: f·cos θ_i times the Jacobian 4 (wo·h), up to a constant.
                        *seen += f64::from(f_cos(wo, wi).max(0.0) * d);
                    }
                }
                *seen *= edges[b + 1] - edges[b];
            }
            let total: f64 = seen.iter().sum();
            if total.is_finite() && total > 0.0 {
                power.iter_mut().zip(seen).for_each(|(p, s)| *p += s / total);
            }
        }
        // Every bin keeps a little, so that nothing that scatters is never drawn with too small a density.
        let floor = 1e-3 / BINS as f64 * power.iter().sum::<f64>().max(1e-6);
        let total: f64 = power.iter().map(|p| p + floor).sum();
        let mut cdf = [0.0f32; BINS + 1];
        let mut sum = 0.0;
        for b in 0..BINS {
            sum += (power[b] + floor) / total;
            cdf[b + 1] = sum as f32;
        }
        cdf[BINS] = 1.0;
        Self { edges: edges.map(|e| e as f32), cdf }
    }

    /// Density with which [`HalfVectors::sample`] draws `wi`, per steradian.
    #[inline]
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let cosine = warp::cosine_hemisphere_pdf(wi.z);
        let Some(h) = (wo + wi).try_normalize() else { return COSINE * cosine };
        // 1 − cos θ_h = sin²θ_h/(1 + cos θ_h), without cancellation.
        let t = (h.x * h.x + h.y * h.y) / (1.0 + h.z);
        let b = self.edges.partition_point(|e| *e <= t).clamp(1, BINS) - 1;
        let share = (self.cdf[b + 1] - self.cdf[b]) / (self.edges[b + 1] - self.edges[b]);
        // Density of half vectors, uniform within the bin, over the Jacobian 4 (wo·h) of reflection.
        let density = share / std::f32::consts::TAU / (4.0 * wo.dot(h)).max(1e-6);
        COSINE * cosine + (1.0 - COSINE) * density
    }

    /// A direction above the surface; `None` for those that fall below.
    #[inline]
    pub fn sample(&self, wo: Vec3, u: f32, u2: Vec2) -> Option<Vec3> {
        let wi = if u < COSINE {
            warp::cosine_hemisphere(u2)
        } else {
            // Choose a bin by inversion, then 1 − cos θ_h uniformly within it.
            let b = self.cdf.partition_point(|c| *c <= u2.x).clamp(1, BINS) - 1;
            let within = ((u2.x - self.cdf[b]) / (self.cdf[b + 1] - self.cdf[b])).clamp(0.0, 1.0);
            let t = self.edges[b] + within * (self.edges[b + 1] - self.edges[b]);
            let (sin, phi) = ((t * (2.0 - t)).max(0.0).sqrt(), std::f32::consts::TAU * u2.y);
            let h = Vec3::new(sin * phi.cos(), sin * phi.sin(), 1.0 - t);
            let d = wo.dot(h);
            if d <= 0.0 {
                return None;
            }
            // Reflect about the half vector.
            (2.0 * d * h - wo).normalize()
        };
        (wi.z > 0.0).then_some(wi)
    }
}
