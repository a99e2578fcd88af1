//! Directions of a sky by a table of its luminance.

use std::f32::consts::PI;
use steradian_math::{Frame, Vec2, Vec3, distribution::Piecewise2D, warp};

/// Cells over the azimuth from the sun's and over the angle from the zenith.
const COLUMNS: usize = 256;
const ROWS: usize = 128;

/// Luminance in cells from the zenith down to a horizon.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    /// `z` up, the sun's azimuth along `x`.
    frame: Frame,
    /// The part of the angle from zenith to nadir that is sky: a half where the horizon is level.
    share: f32,
    distribution: Piecewise2D,
    fluence: f32,
}

impl Cells {
    /// The cells of a luminance by world direction, down to an angle below the horizontal, in radians.
    pub(super) fn new(frame: Frame, dip: f32, luminance: impl Fn(Vec3) -> f32) -> Self {
        let (share, distribution) = (0.5 + dip / PI, Piecewise2D::new(&[1.0], 1, 1));
        let mut cells = Self { frame, share, distribution, fluence: 0.0 };
        let mut values = Vec::with_capacity(COLUMNS * ROWS);
        for row in 0..ROWS {
            for column in 0..COLUMNS {
                let uv = Vec2::new((column as f32 + 0.5) / COLUMNS as f32, (row as f32 + 0.5) / ROWS as f32);
                // Weight each cell by its luminance times its solid angle.
                let (w, density) = cells.direction(uv);
                values.push(luminance(w).max(0.0) / density);
            }
        }
        cells.fluence = values.iter().sum::<f32>() / values.len() as f32;
        // Every cell can be found, black at its middle or not.
        let (mean, all) = (cells.fluence, values.iter_mut());
        all.for_each(|v| *v = v.max(1e-3 * mean));
        cells.distribution = Piecewise2D::new(&values, COLUMNS, ROWS);
        cells
    }

    /// The world direction of a place on the table, and the density of directions per unit of its area.
    fn direction(&self, uv: Vec2) -> (Vec3, f32) {
        let (d, sin) = warp::direction_from_latlong(Vec2::new(uv.x, self.share * uv.y));
        (self.frame.to_world(d), 1.0 / (PI * PI * (2.0 * self.share) * sin))
    }

    /// A direction, and its density per solid angle.
    pub(super) fn sample(&self, u: Vec2) -> (Vec3, f32) {
        // Draw a place on the table and convert its density to solid angle.
        let (uv, pdf) = self.distribution.sample(u);
        let (w, density) = self.direction(uv);
        (w, pdf * density)
    }

    /// The density of [`Cells::sample`].
    pub(super) fn pdf(&self, w: Vec3) -> f32 {
        // Invert the mapping: azimuth and zenith angle over the part that is sky.
        let d = self.frame.to_local(w);
        let sin = d.x.hypot(d.y);
        let uv = warp::latlong_from_direction(d) * Vec2::new(1.0, 1.0 / self.share);
        let is_below = if self.share == 0.5 { d.z <= 0.0 } else { uv.y >= 1.0 };
        if is_below || sin <= 0.0 {
            return 0.0;
        }
        self.distribution.pdf(uv) / (PI * PI * (2.0 * self.share) * sin)
    }

    /// `∫ Y dω`.
    pub(super) fn fluence(&self) -> f32 {
        self.fluence
    }

    /// Bytes of the table.
    pub(super) fn bytes(&self) -> usize {
        self.distribution.size().into_iter().product::<usize>() * 3 * size_of::<f32>()
    }
}
