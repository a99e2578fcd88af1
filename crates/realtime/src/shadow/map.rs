//! One shadow map: distances along the axis of a light's view (Williams 1978, "Casting Curved Shadows on Curved
//! Surfaces").

use rayon::prelude::*;
use steradian_core::Scene;
use steradian_math::{Vec2, Vec3};
use steradian_raster::glam::UVec2;

use crate::{Error, draw_list::DrawList, options::BiasBy, projection::Projected, spread, visibility::Visibility};

/// Slopes are taken to be no steeper than this.
pub const STEEPEST: f32 = 100.0;

/// Comparison with shadow maps.
#[derive(Clone, Debug)]
pub struct Filter {
    /// In texels.
    pub bias: f32,
    pub bias_by: BiasBy,
    /// Texels along each axis.
    pub pcf: u32,
    /// Offsets of the texels that are compared, from the first of the square.
    taps: Vec<Vec2>,
}

impl Filter {
    /// Comparison with all texels of a square of `pcf²`, or with `samples` of them, spread evenly.
    pub fn new((bias, bias_by): (f32, BiasBy), pcf: u32, samples: u32) -> Self {
        let all = (0..pcf * pcf).map(|k| UVec2::new(k / pcf, k % pcf));
        let mut cells: Vec<UVec2> = Vec::new();
        if samples == 0 || samples >= pcf * pcf {
            cells.extend(all);
        } else {
            // Cells in the order in which the R2 sequence (Roberts 2018) comes to them; the rest of them by rows.
            let visited = (0..64 * pcf * pcf).map(|k| (spread(k) * pcf as f32).as_uvec2().min(UVec2::splat(pcf - 1)));
            for cell in visited.chain(all) {
                if cells.len() < samples as usize && !cells.contains(&cell) {
                    cells.push(cell);
                }
            }
        }
        Self { bias, bias_by, pcf, taps: cells.iter().map(|cell| cell.as_vec2()).collect() }
    }
}

/// Shadow map: distances in a square view from a light.
#[derive(Debug)]
pub struct Map {
    pub view: Projected,
    /// Distances by rows; infinite where nothing is.
    pub distances: Vec<f32>,
    pub size: u32,
}

/// A point in a map.
#[derive(Clone, Copy, Debug)]
pub struct InMap {
    /// In the view's coordinates.
    pub local: Vec3,
    /// In the frame, x right and y up, from −1 to 1.
    pub at: Vec2,
    /// Width of a texel there, in space.
    pub texel: f32,
    /// Change of the distance along the axis from texel to texel on the surface, in widths of a texel: the sum of both
    /// axes.
    pub slope: f32,
}

impl Map {
    /// Draws what the view sees.
    pub fn new(scene: &Scene, list: &DrawList, view: Projected, size: u32) -> Result<Self, Error> {
        let seen = Visibility::draw(scene, list, &view)?;
        Ok(Self::of_depths(view, &seen.depths, size))
    }

    /// Shadow map of a picture of reversed depths.
    pub fn of_depths(view: Projected, depths: &[f32], size: u32) -> Self {
        let mut map = Self { view, distances: Vec::new(), size };
        // Depths become distances along the axis, which are linear in space: a bias in texels then has one meaning
        // everywhere.
        let distance = |(i, depth): (usize, &f32)| -> f32 {
            let center = map.center(i as u32 % size, i as u32 / size);
            view.distance_of(depth * view.unwarped(center.x, center.y).1)
        };
        map.distances = depths.par_iter().enumerate().map(distance).collect();
        map
    }

    /// The place in the frame of the centre of a texel.
    fn center(&self, column: u32, row: u32) -> Vec2 {
        let at = |i: u32| (i as f32 + 0.5) / self.size as f32 * 2.0 - 1.0;
        Vec2::new(at(column), -at(row))
    }

    /// The direction of the centre of a texel from the eye of the view with z = 1; for parallel light its place on the
    /// plane.
    pub fn direction(&self, column: u32, row: u32) -> Vec2 {
        let center = self.center(column, row);
        self.view.unwarped(center.x, center.y).0 * self.view.half()
    }

    /// Position in the map of a world point with this normal; `None` behind the view.
    pub fn locate(&self, p: Vec3, n: Vec3) -> Option<InMap> {
        // Project the point; behind the light's eye there is no map.
        let (local, clip) = (self.view.local(p), self.view.clip(p));
        if clip.w.is_nan() || clip.w <= 0.0 {
            return None;
        }
        let at = Vec2::new(clip.x, clip.y) / clip.w;
        // The width of a texel by finite differences, as the warp makes it vary over the map.
        let (here, step) = (self.view.unwarped(at.x, at.y).0, 2.0 / self.size as f32);
        let width = |x: f32, y: f32| (self.view.unwarped(at.x + x, at.y + y).0 - here).length();
        let texel = width(step, 0.0).max(width(0.0, step)) * self.view.half();
        let is_perspective = self.view.is_perspective();
        let texel = if is_perspective { texel * local.z } else { texel };
        // The depth of the tangent plane changes by (|n_x| + |n_y|)/|n·d| for a step of one texel along both axes.
        let n = self.view.turn(n);
        let towards = if is_perspective { local / local.z } else { Vec3::Z };
        let slope = ((n.x.abs() + n.y.abs()) / n.dot(towards).abs().max(1e-6)).min(STEEPEST);
        Some(InMap { local, at, texel, slope })
    }

    /// The share of the texels around a point's that do not see something before it (percentage-closer filtering;
    /// Reeves, Salesin, Cook 1987). A point is lit where its distance is at most that of what the light sees, plus the
    /// bias. `None` beyond a map of parallel light; the border of others goes on.
    pub fn lit(&self, p: Vec3, n: Vec3, filter: &Filter) -> Option<f32> {
        let Some(mut found) = self.locate(p, n) else { return Some(1.0) };
        let Filter { bias, bias_by, pcf, .. } = *filter;
        // The surface changes by its slope from the middle of a texel to its border, and further texels lie further
        // off.
        let reach = 0.5 * (pcf as f32 + 1.0);
        let InMap { texel, slope, .. } = found;
        let is_perspective = self.view.is_perspective();
        let allowed = match bias_by {
            BiasBy::Slope => reach * slope + 0.1,
            BiasBy::Constant => 1.0,
            BiasBy::Normal => {
                // Holbert 2011, "Saying Goodbye to Shadow Acne": by the sine of the angle of incidence.
                let to_light = self.view.world(if is_perspective { Vec3::ZERO } else { found.local.with_z(0.0) }) - p;
                let cos = n.dot(to_light.normalize_or_zero());
                let along = n * (bias * texel * reach * (1.0 - cos * cos).max(0.0).sqrt()).copysign(bias * cos);
                found = self.locate(p + along, n)?;
                0.1
            }
            BiasBy::Plane => 0.1 + 0.02 * slope,
        };
        // The point is lit by a texel whose distance is at least this limit.
        let limit = found.local.z - bias * texel * allowed;
        let n = self.view.turn(n);
        let to_texel = |x: f32| (x * 0.5 + 0.5) * self.size as f32;
        let (x, y) = (to_texel(found.at.x), to_texel(-found.at.y));
        let half = (pcf as f32 - 1.0) / 2.0;
        let outside = |v: f32| !(0.0..self.size as f32).contains(&v);
        if !is_perspective && (outside(x) || outside(y)) {
            return None;
        }
        // The comparison comes before the mean: averaging depths would invent surfaces between near and far.
        let mut lit = 0;
        for tap in &filter.taps {
            let at = |x: f32, d: f32| (x - half + d).floor().clamp(0.0, (self.size - 1) as f32) as u32;
            let (column, row) = (at(x, tap.x), at(y, tap.y));
            // Receiver plane depth bias (Isidoro 2006): the limit follows the tangent plane to the texel.
            let limit = if bias_by == BiasBy::Plane {
                let most = slope * texel * (reach + 0.5);
                limit + self.on_plane(found.local, n, column, row).clamp(-most, most)
            } else {
                limit
            };
            lit += u32::from(limit <= self.distances[(row * self.size + column) as usize]);
        }
        Some(lit as f32 / filter.taps.len() as f32)
    }

    /// Change of the distance along the axis, from a point to the plane through it with normal `n` at the centre of a
    /// texel.
    fn on_plane(&self, local: Vec3, n: Vec3, column: u32, row: u32) -> f32 {
        let direction = self.direction(column, row);
        // Intersect the texel's ray with the tangent plane.
        let change = if self.view.is_perspective() {
            local.dot(n) / direction.extend(1.0).dot(n) - local.z
        } else {
            (local.truncate() - direction).dot(n.truncate()) / n.z
        };
        if change.is_finite() { change } else { 0.0 }
    }
}
