//! Colours of interreflection inside a coat, which RGB arithmetic gets wrong: a spectrum of colour `ρ = 1` in red is
//! below one over part of the red wavelengths, and the powers of it that the series `Σ ρⁿ⁺¹Kⁿ` sums fade, while powers
//! of one do not. In RGB mode the series is therefore taken over the smooth spectrum that the RGB value stands for, and
//! its colour tabulated over RGB.

use std::sync::LazyLock;
use steradian_math::{
    DVec3, Spectrum, Vec3,
    color::{
        space::REC709,
        upsample::{RgbAlbedo, RgbSigmoid},
    },
    spectra::{cie, d65},
};

/// Points of the table along each component, evenly over [0, 1].
const GRID: usize = 16;
/// Wavelengths between two terms of the integrals, nm.
const STEP: usize = 5;

/// The spectra of the colours of the table: each solved for by itself, since the tables of all spectra would be filled
/// for their sake.
static SPECTRA: LazyLock<Box<[RgbAlbedo]>> = LazyLock::new(|| {
    let at = |i: usize| (i % GRID) as f32 / (GRID - 1) as f32;
    let rgb = |i: usize| Vec3::new(at(i / (GRID * GRID)), at(i / GRID), at(i));
    (0..GRID * GRID * GRID).map(|i| RgbAlbedo(RgbSigmoid::solved(&REC709, rgb(i)))).collect()
});

/// The colour of all orders but the first, over the linear Rec.709 albedo of the base.
#[derive(Clone, Debug)]
pub(super) struct CoatColors {
    /// By red, green, blue, the last fastest.
    grid: Box<[Vec3]>,
}

impl CoatColors {
    /// Tabulates `series`, the light that leaves a base of the given albedo per light that reaches it. Some
    /// milliseconds.
    pub fn new(series: impl Fn(f32) -> f32) -> Self {
        let color = |l: f32| {
            let xyz = DVec3::from_array(cie::matching(l).map(f64::from)) * f64::from(d65().eval(l));
            (REC709.rgb_from_xyz() * xyz).as_vec3()
        };
        let colors: Vec<(f32, Vec3)> = cie::lambdas().step_by(STEP).map(|l| (l, color(l))).collect();
        // A constant spectrum keeps its value.
        let white: Vec3 = colors.iter().map(|c| c.1).sum();
        let grid = SPECTRA.iter().map(|rho| {
            let sum: Vec3 = colors
                .iter()
                .map(|&(l, color)| {
                    let rho = rho.eval(l);
                    color * (series(rho) - rho)
                })
                .sum();
            (sum / white).max(Vec3::ZERO)
        });
        Self { grid: grid.collect() }
    }

    /// The light of all orders that leaves a base of linear Rec.709 albedo `rho` in [0, 1].
    pub fn multiply_scattered(&self, rho: Spectrum) -> Spectrum {
        let x = rho.to_rgb().map(|v| v * (GRID - 1) as f32);
        let cell = x.map(|v| (v as usize).min(GRID - 2));
        // Within a cell from corner to corner along the axes, largest fraction first: so greys stay on the diagonal.
        let mut steps: [(f32, usize); 3] = std::array::from_fn(|c| (x[c] - cell[c] as f32, [GRID * GRID, GRID, 1][c]));
        steps.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
        let mut corner = (cell[0] * GRID + cell[1]) * GRID + cell[2];
        let mut higher = self.grid[corner];
        for (fraction, step) in steps {
            higher += (self.grid[corner + step] - self.grid[corner]) * fraction;
            corner += step;
        }
        rho + Spectrum::rgb(higher.x, higher.y, higher.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const K: f32 = 0.57;

    fn series(rho: f32) -> f32 {
        rho / (1.0 - rho * K)
    }

    #[test]
    fn greys_are_as_in_any_lane() {
        let colors = CoatColors::new(series);
        for rho in [0.0, 0.2, 0.51, 0.93, 1.0_f32] {
            let of = colors.multiply_scattered(Spectrum::rgb(rho, rho, rho)).to_rgb();
            assert!(of.iter().all(|v| (v - series(rho)).abs() <= 0.012 * series(rho)), "{rho}: {of:?}");
        }
    }

    /// The table against the integral over all wavelengths, between its points.
    #[test]
    fn colours_are_those_of_the_spectrum() {
        let colors = CoatColors::new(series);
        for rgb in [[1.0, 0.378676, 0.013473], [0.3, 0.71, 0.22], [0.1, 0.2, 0.87], [0.55, 0.04, 0.61_f32]] {
            let spectrum = RgbAlbedo::new(&REC709, rgb.into());
            let color = |f: &dyn Fn(f32) -> f32| {
                (REC709.rgb_from_xyz() * cie::to_xyz(|l| f(spectrum.eval(l)) * d65().eval(l))).as_vec3()
            };
            let exact = Vec3::from(rgb) + (color(&series) - color(&|v| v)).max(Vec3::ZERO);
            let table = Vec3::from(colors.multiply_scattered(Spectrum::rgb(rgb[0], rgb[1], rgb[2])).to_rgb());
            assert!((table - exact).abs().max_element() < 0.01 * exact.max_element(), "{rgb:?}: {table} {exact}");
        }
        // What RGB arithmetic makes of it is far brighter.
        let red = colors.multiply_scattered(Spectrum::rgb(1.0, 0.378676, 0.013473)).to_rgb()[0];
        assert!(red < 0.92 * series(1.0), "{red}");
    }
}
