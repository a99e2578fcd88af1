//! The random microfacet surface: a Gaussian height field, whose facets are held against the analytic distributions.
//!
//! Heights are a sum of plane waves with random phases and Gaussian wave vectors, so that slopes are Gaussian: the
//! surface that Beckmann's distribution of roughness `α = √2 × slope` describes. Where `α` is small light meets it once
//! and its reflection is `D G / (4 cosθ cosθ')`.

use steradian_math::{Vec3, hash::HashRng};
use steradian_scene::Mesh;

/// A height field over a square.
#[derive(Clone, Debug)]
pub struct Microsurface {
    /// Points along each side.
    pub size: usize,
    /// Side of the square.
    pub side: f32,
    heights: Vec<f32>,
}

/// Waves that are summed.
const WAVES: usize = 400;

impl Microsurface {
    /// A surface of a Beckmann roughness; the correlation length is one, the square has a side of so many of them,
    /// eight points to each.
    pub fn new(alpha: f32, lengths: usize, seed: u64) -> Self {
        let size = lengths * 8;
        let side = lengths as f32;
        let mut rng = HashRng::new(seed);
        let mut normal = || {
            let (u, v) = (f64::from(rng.next_f32()).max(1e-12), f64::from(rng.next_f32()));
            ((-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos(), v)
        };
        // Wave vectors of variance 2 per axis: the correlation is exp(−r²). Slopes then have the variance α²/2 per axis
        // for this amplitude.
        let waves: Vec<[f64; 3]> = (0..WAVES)
            .map(|_| {
                let ((x, _), (y, phase)) = (normal(), normal());
                [x * 2f64.sqrt(), y * 2f64.sqrt(), phase * std::f64::consts::TAU * 7.0]
            })
            .collect();
        let mean_k2: f64 = waves.iter().map(|w| (w[0] * w[0] + w[1] * w[1]) / 2.0).sum::<f64>() / WAVES as f64;
        let amplitude = f64::from(alpha) / (WAVES as f64 * mean_k2).sqrt();
        let step = f64::from(side) / (size - 1) as f64;
        let height = |i: usize| {
            let (x, y) = ((i % size) as f64 * step, (i / size) as f64 * step);
            (amplitude * waves.iter().map(|w| (w[0] * x + w[1] * y + w[2]).cos()).sum::<f64>()) as f32
        };
        Self { size, side, heights: (0..size * size).map(height).collect() }
    }

    /// As triangles, up along +z, with flat facets.
    pub fn mesh(&self) -> Mesh {
        let (n, step) = (self.size as u32, self.side / (self.size - 1) as f32);
        let at = |i: u32| [(i % n) as f32 * step, (i / n) as f32 * step, self.heights[i as usize]];
        let quads = (0..n - 1).flat_map(|y| (0..n - 1).map(move |x| y * n + x));
        Mesh {
            positions: (0..n * n).map(at).collect(),
            triangles: quads.flat_map(|a| [[a, a + 1, a + n + 1], [a, a + n + 1, a + n]]).collect(),
            ..Mesh::default()
        }
    }

    /// The normals of all facets, longer where the facet is larger: each is its area times its normal over the
    /// projected area.
    pub fn facets(&self) -> Vec<Vec3> {
        let mesh = self.mesh();
        let corner = |i: u32| Vec3::from(mesh.positions[i as usize]);
        let facet = |t: &[u32; 3]| {
            let n = (corner(t[1]) - corner(t[0])).cross(corner(t[2]) - corner(t[0]));
            n / n.z
        };
        mesh.triangles.iter().map(facet).collect()
    }
}
