//! Transmission of the aperture stop. Positions are in units of the stop's radius.

use std::f64::consts::{E, FRAC_PI_4, PI};

/// The shape of the opening. All are as bright in the mean as the full circle, as in pbrt-v4.
#[derive(Clone, Debug, Default)]
pub enum Stop {
    /// The whole disk.
    #[default]
    Circle,
    /// A polygon within it, by its corners in order, and its factor.
    Polygon(Vec<[f64; 2]>, f64),
    /// `exp(−r²) − exp(−1)`.
    Gaussian,
    /// A picture over the square around it, rows from the top: width, values that are not negative.
    Mask(usize, Vec<f32>),
}

impl Stop {
    /// A built-in shape by name.
    pub fn named(name: &str) -> Option<Self> {
        let corner = |r: f64, turn: f64| [r * turn.cos(), r * turn.sin()];
        Some(match name {
            "circle" => Self::Circle,
            "gaussian" => Self::Gaussian,
            "square" => polygon(vec![[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]),
            // A corner points down.
            "pentagon" => polygon((0..5).map(|k| corner(0.8, PI * (0.4 * f64::from(k) - 0.5))).collect()),
            "star" => {
                let inner = (0.4 * PI).cos() / (0.2 * PI).cos();
                let radius = |k: u32| if k % 2 == 1 { 1.0 } else { inner };
                polygon((0..10).map(|k| corner(radius(k), 0.2 * PI * f64::from(k))).collect())
            }
            _ => return None,
        })
    }

    /// A picture of the opening; `None` where it lets nothing through or its values are not finite.
    pub fn mask(width: usize, values: Vec<f32>) -> Option<Self> {
        let sum: f64 = values.iter().map(|v| f64::from(*v)).sum();
        let is_sound = width > 0 && sum.is_finite() && sum > 0.0 && values.iter().all(|v| *v >= 0.0);
        // Normalise to the mean of the disk: π/4 of the square.
        let scale = FRAC_PI_4 * values.len() as f64 / sum;
        let scaled = || values.iter().map(|v| (f64::from(*v) * scale) as f32).collect();
        is_sound.then(|| Self::Mask(width, scaled()))
    }

    /// The share of light that passes at a place; above 1 where shapes that cover less of the disk make up for it.
    pub(super) fn transmission(&self, x: f64, y: f64) -> f64 {
        match self {
            Self::Circle => 1.0,
            Self::Polygon(corners, factor) => {
                // Even–odd rule: count the edges crossed to the left of the point.
                let ends = corners.iter().zip(corners.iter().cycle().skip(1));
                let crossed = ends
                    .filter(|([ax, ay], [bx, by])| (*ay > y) != (*by > y) && x < ax + (y - ay) * (bx - ax) / (by - ay));
                if crossed.count() % 2 == 1 { *factor } else { 0.0 }
            }
            Self::Gaussian => ((-x * x - y * y).exp() - 1.0 / E).max(0.0) / (1.0 - 2.0 / E),
            Self::Mask(width, values) => bilinear(*width, values, 0.5 + 0.5 * x, 0.5 - 0.5 * y),
        }
    }
}

/// A polygon with the factor that makes it pass as much as the unit disk.
fn polygon(corners: Vec<[f64; 2]>) -> Stop {
    let ends = corners.iter().zip(corners.iter().cycle().skip(1));
    // Shoelace formula.
    let area = 0.5 * ends.map(|([ax, ay], [bx, by])| ax * by - bx * ay).sum::<f64>();
    Stop::Polygon(corners, PI / area)
}

/// The picture at a place in the unit square, black around it.
fn bilinear(width: usize, values: &[f32], s: f64, t: f64) -> f64 {
    let height = values.len() / width;
    let (x, y) = (s * width as f64 - 0.5, t * height as f64 - 0.5);
    let (i, j) = (x.floor(), y.floor());
    let texel = |i: f64, j: f64| {
        let inside = i >= 0.0 && j >= 0.0 && i < width as f64 && j < height as f64;
        if inside { f64::from(values[j as usize * width + i as usize]) } else { 0.0 }
    };
    // Bilinear interpolation, black beyond the border.
    let row = |j: f64| texel(i, j) * (1.0 - (x - i)) + texel(i + 1.0, j) * (x - i);
    row(j) * (1.0 - (y - j)) + row(j + 1.0) * (y - j)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Shapes pass in the mean what the circle does: π of the square of side 2.
    #[test]
    fn shapes_are_as_bright_as_the_circle() {
        const N: usize = 1000;
        let mask = Stop::mask(4, (0..16).map(|k| (k % 3) as f32).collect()).unwrap();
        let named = ["square", "pentagon", "star", "gaussian"].map(|name| Stop::named(name).unwrap());
        for stop in named.iter().chain([&mask]) {
            let mut sum = 0.0;
            for k in 0..N * N {
                let at = |k: usize| (k as f64 + 0.5) / N as f64 * 2.0 - 1.0;
                sum += stop.transmission(at(k % N), at(k / N));
            }
            let mean = sum * 4.0 / (N * N) as f64;
            // A bilinear lookup loses light at the edges of a picture of few texels.
            let (low, high) = if matches!(stop, Stop::Mask(..)) { (0.7, 1.0) } else { (0.997, 1.003) };
            assert!((low * PI..high * PI).contains(&mean), "{stop:?}: {mean}");
        }
        // Of a star of five points, the inner pentagon touches 0.382 of the radius; between points it is dark.
        let star = Stop::named("star").unwrap();
        assert!(star.transmission(-0.9, 0.0) > 0.0 && star.transmission(0.9, 0.0) == 0.0);
        assert!(star.transmission(0.37, 0.0) > 0.0 && star.transmission(0.39, 0.0) == 0.0);
        let pentagon = Stop::named("pentagon").unwrap();
        assert!(pentagon.transmission(0.0, -0.79) > 0.0 && pentagon.transmission(0.0, 0.7) == 0.0);
        assert!(Stop::mask(2, vec![0.0; 4]).is_none() && Stop::mask(1, vec![-1.0, 3.0]).is_none());
    }
}
