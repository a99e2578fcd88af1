//! Directional albedos of lobes that have no closed form, tabulated over roughness and angle when they are first asked
//! for.
//!
//! With Schlick's reflectance the albedo of a GGX surface is `E(μ) = f0 A(μ, α) + f90 B(μ, α)` (Karis 2013, "Real
//! Shading in Unreal Engine 4"); [`ggx`] gives both. What a layer leaves to the one below it is `1 − E`, and for a
//! Lambertian base both directions lose it, so that
//!
//! ```text
//! f = ρ/π · (1 − E(wo)) (1 − E(wi)) / (1 − Ē),   Ē = 2 ∫ E μ dμ
//! ```
//!
//! returns all light to the last bit for `ρ = 1` (Kelemen, Szirmay-Kalos 2001, eq. 5).

use super::{Microfacet, sheen};
use std::sync::LazyLock;
use steradian_math::{Vec2, Vec3, cell};

/// Entries over roughness and over the cosine.
const SIZE: usize = 24;

type Grid = [[f32; SIZE]; SIZE];

/// A function of roughness `√α` and cosine, both in [0, 1], linear between entries.
struct Table {
    at: Box<Grid>,
    /// `2 ∫ E μ dμ` of each roughness.
    mean: [f32; SIZE],
}

/// Index of the entry below and the place between it and the next.
#[inline]
fn place(v: f32) -> (usize, f32) {
    cell(v.clamp(0.0, 1.0) * (SIZE - 1) as f32, SIZE - 1)
}

impl Table {
    fn new(f: impl Fn(f32, f32) -> f32) -> Self {
        let step = |i: usize| i as f32 / (SIZE - 1) as f32;
        let mut at = Box::new([[0.0; SIZE]; SIZE]);
        let mut mean = [0.0; SIZE];
        for (i, row) in at.iter_mut().enumerate() {
            for (j, v) in row.iter_mut().enumerate() {
                *v = f(step(i).powi(2), step(j)).clamp(0.0, 1.0);
            }
            // Of the interpolant, exactly: Simpson's rule on each interval, where it is a parabola.
            mean[i] = (0..SIZE - 1)
                .map(|j| {
                    let (a, b, (x, y)) = (step(j), step(j + 1), (row[j], row[j + 1]));
                    (b - a) / 6.0 * (x * a + (x + y) * (a + b) + y * b) * 2.0
                })
                .sum();
        }
        Self { at, mean }
    }

    #[inline]
    fn get(&self, alpha: f32, cos: f32) -> f32 {
        self.at_place(row(alpha), place(cos))
    }

    #[inline]
    fn at_place(&self, (i, s): Row, (j, t): (usize, f32)) -> f32 {
        let row = |i: usize| self.at[i][j] * (1.0 - t) + self.at[i][j + 1] * t;
        row(i) * (1.0 - s) + row(i + 1) * s
    }

    #[inline]
    fn mean(&self, (i, s): Row) -> f32 {
        self.mean[i] * (1.0 - s) + self.mean[i + 1] * s
    }
}

fn at(cos: f32) -> Vec3 {
    Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos)
}

/// Points of the Hammersley set.
fn points(n: u32) -> impl Iterator<Item = Vec2> {
    (0..n).map(move |i| Vec2::new((i as f32 + 0.5) / n as f32, i.reverse_bits() as f32 / 4_294_967_296.0))
}

/// `[A, B]`.
static GGX: LazyLock<[Table; 2]> = LazyLock::new(|| {
    [false, true].map(|grazing| {
        Table::new(|alpha, cos| {
            let (facets, wo) = (Microfacet::ggx(alpha, alpha), at(cos.max(1e-3)));
            let weight = |c: f32| {
                let w = (1.0 - c.clamp(0.0, 1.0)).powi(5);
                if grazing { w } else { 1.0 - w }
            };
            if facets.is_smooth() {
                return weight(cos);
            }
            let n = 256;
            let sum: f32 = points(n)
                .filter_map(|u| {
                    let n = facets.draw(wo, u);
                    let facet = facets.reflecting_by(&n.mirror(), wo, n.mirrored(wo))?;
                    Some(weight(facet.cos_o) * facet.weight)
                })
                .sum();
            sum / n as f32
        })
    })
});

static SHEEN: LazyLock<Table> = LazyLock::new(|| {
    Table::new(|alpha, cos| {
        let (alpha, wo) = (alpha.max(sheen::MIN_ALPHA), at(cos.max(1e-3)));
        let n = 1024;
        let sum: f32 = points(n)
            .map(|u| {
                let (s, c) = (std::f32::consts::TAU * u.y).sin_cos();
                let sin = (1.0 - u.x * u.x).sqrt();
                let wi = Vec3::new(sin * c, sin * s, u.x);
                sheen::value(alpha, wo, wi)
            })
            .sum();
        sum * std::f32::consts::TAU / n as f32
    })
});

/// The factors `A`, `B` of `f0` and `f90` in the albedo of a GGX surface of roughness `alpha` at a cosine.
#[inline]
pub(super) fn ggx(row: Row, cos: f32) -> [f32; 2] {
    let column = place(cos);
    GGX.each_ref().map(|t| t.at_place(row, column))
}

/// A roughness in the tables.
pub(super) type Row = (usize, f32);

/// Position of the roughness `alpha` in the tables.
#[inline]
pub(super) fn row(alpha: f32) -> Row {
    place(alpha.max(0.0).sqrt())
}

/// The factors `A`, `B` of a GGX surface averaged over the hemisphere by the cosine.
#[inline]
pub(super) fn ggx_mean(row: Row) -> [f32; 2] {
    GGX.each_ref().map(|t| t.mean(row))
}

/// The albedo of the white sheen of roughness `alpha` at a cosine.
#[inline]
pub(super) fn sheen(alpha: f32, cos: f32) -> f32 {
    SHEEN.get(alpha, cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_surfaces_reflect_by_schlick_and_all_tables_lie_in_the_unit_interval() {
        for cos in [0.1, 0.5, 1.0f32] {
            let [a, b] = ggx(row(0.0), cos);
            let w = (1.0 - cos).powi(5);
            assert!((a + b - 1.0).abs() < 1e-5 && (b - w).abs() < 6e-3, "{cos}: {a} {b}");
            assert!((0.0..=1.0).contains(&sheen(0.3, cos)));
        }
        // Schlick's mean over the hemisphere: 2∫(1−μ)⁵μ dμ = 1/21.
        assert!((ggx_mean(row(0.0))[1] - 1.0 / 21.0).abs() < 2e-3);
        // At α = 1 and normal incidence half of the facets reflect downwards, and ∫ s/(1 + s) ds is left of the rest.
        let [a, b] = ggx(row(1.0), 1.0);
        assert!((a + b - (1.0 - std::f32::consts::LN_2)).abs() < 4e-3, "{}", a + b);
    }
}
