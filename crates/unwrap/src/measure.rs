//! Measures of distortion.
//!
//! The linear map from texture coordinates to the surface of a triangle has two singular values Γ ≥ γ, the most and the
//! least that it stretches (Sander, Snyder, Gortler and Hoppe, "Texture Mapping Progressive Meshes", 2001). L² stretch
//! is the root of their mean square over the surface, L∞ the largest Γ, both times the root of the atlas's area over
//! the surface's, so that a map which keeps all lengths to one scale has 1. Γ/γ is 1 where the map is conformal.

use steradian_math::{DVec2, DVec3};

/// Measures of an atlas.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Metrics {
    /// Number of charts.
    pub charts: usize,
    /// Triangles without area in space, or too small for the precision of the coordinates: they are in no chart, or have
    /// no area in it.
    pub degenerate: usize,
    /// L² stretch.
    pub stretch_l2: f64,
    /// L∞ stretch.
    pub stretch_max: f64,
    /// Mean of Γ/γ over the surface.
    pub conformal: f64,
    /// Area of the surface.
    pub area: f64,
    /// Length of the edges between triangles that the atlas cuts.
    pub seam_length: f64,
    /// Share of the atlas that charts cover.
    pub utilisation: f64,
    /// Texels per unit of length on the surface.
    pub texels_per_unit: f64,
}

/// Singular values Γ ≥ γ of the map from texture coordinates to a triangle; nothing for coordinates without area.
pub fn stretch(corners: [DVec3; 3], uvs: [DVec2; 3]) -> Option<[f64; 2]> {
    let ([u, v], [p, q]) = ([uvs[1] - uvs[0], uvs[2] - uvs[0]], [corners[1] - corners[0], corners[2] - corners[0]]);
    let twice = u.perp_dot(v);
    if twice == 0.0 {
        return None;
    }
    let (along_s, along_t) = ((p * v.y - q * u.y) / twice, (q * u.x - p * v.x) / twice);
    let (a, b, c) = (along_s.dot(along_s), along_s.dot(along_t), along_t.dot(along_t));
    let root = ((a - c) * (a - c) + 4.0 * b * b).sqrt();
    // The product of both is known more exactly than the difference that the smaller one is.
    let largest = (0.5 * (a + c + root)).sqrt();
    let product = p.cross(q).length() / twice.abs();
    Some([largest, product / largest])
}

/// Sums of measures over triangles.
#[derive(Clone, Copy, Default)]
pub struct Sums {
    area: f64,
    flat: f64,
    squares: f64,
    largest: f64,
    ratios: f64,
}

impl Sums {
    /// Adds a triangle; false for one without area in the plane.
    pub fn add(&mut self, corners: [DVec3; 3], uvs: [DVec2; 3]) -> bool {
        let Some([most, least]) = stretch(corners, uvs) else { return false };
        let area = 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).length();
        self.area += area;
        self.flat += 0.5 * (uvs[1] - uvs[0]).perp_dot(uvs[2] - uvs[0]).abs();
        self.squares += area * 0.5 * (most * most + least * least);
        self.largest = self.largest.max(most);
        self.ratios += area * most / least;
        true
    }

    /// L² and L∞ stretch.
    pub fn stretch(&self) -> [f64; 2] {
        let scale = (self.flat / self.area).sqrt();
        [(self.squares / self.area).sqrt() * scale, self.largest * scale]
    }

    /// Mean of Γ/γ.
    pub fn conformal(&self) -> f64 {
        self.ratios / self.area
    }

    /// Area in the plane.
    pub fn flat(&self) -> f64 {
        self.flat
    }

    /// Area in space.
    pub fn area(&self) -> f64 {
        self.area
    }
}
