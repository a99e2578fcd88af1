//! Maps of parallel light that are bent so that what is near the eye has more texels.
//!
//! Both kinds are one perspective of the light's picture plane along the view: its centre lies a distance `n` before
//! the nearest visible point. They differ in `n`. Trapezoidal maps (Martin, Tan 2004, "Anti-aliasing and Continuity
//! with Trapezoidal Shadow Maps") let the nearer part of what is seen have 80 % of the map; that part is here the one
//! with 80 % of the visible pixels. Light-space perspective maps (Wimmer, Scherzer, Purgathofer 2004, eq. 7) take
//! `n = (z_n + √(z_n z_f)) / sin γ`, γ between view and light.

use steradian_core::Scene;
use steradian_math::{Vec2, Vec3};
use steradian_raster::glam::Mat3;

use super::Eye;
use crate::projection::{Projected, Warp};

/// Share of the frame that what is seen may take; the rest is for what lies between the pixels that are looked at.
const FILLED: f32 = 0.97;

/// Perspective warp of a light's shadow map; `None` where nothing is seen.
pub fn warp(scene: &Scene, eye: &Eye, light: &Projected, trapezoid: bool) -> Option<Warp> {
    let (place, forward) = eye.projected.eye();
    let forward = forward.normalize_or_zero();
    let seen: Vec<Vec3> = visible(scene, eye);
    let (origin, ahead) = (light.clip(place), light.clip(place + forward * light.half()));
    // Along the view in the light's picture; its length is the sine of the angle between the two.
    let view = Vec2::new(ahead.x - origin.x, ahead.y - origin.y);
    let sine = view.length();
    let turn = if sine > 1e-3 { view / sine } else { Vec2::Y };
    // Columns s across and t along the view.
    let turned = Mat3::from_cols(Vec3::new(turn.y, turn.x, 0.0), Vec3::new(-turn.x, turn.y, 0.0), Vec3::Z);
    let flat: Vec<Vec3> = seen.iter().map(|p| turned * light.clip(*p).truncate().with_z(1.0)).collect();
    let mut along: Vec<f32> = flat.iter().map(|p| p.y).collect();
    along.sort_by(f32::total_cmp);
    let (first, last) = (*along.first()?, *along.last()?);
    let length = (last - first).max(1e-6);
    let near = if trapezoid {
        // The perspective sends t = 0 … L to −1 … 1. That the focus f lands on 0.6, the 80 % line, is 0.4 L f = n (1.6
        // L − 2 f).
        let focus = along[along.len() * 4 / 5] - first;
        let rest = 1.6 * length - 2.0 * focus;
        if rest > 0.0 { 0.4 * length * focus / rest } else { f32::INFINITY }
    } else {
        let depths = || seen.iter().map(|p| (*p - place).dot(forward).max(0.0) / light.half());
        let (z_near, z_far) = (depths().fold(f32::MAX, f32::min), depths().fold(0.0, f32::max));
        (z_near + (z_near * z_far).sqrt()) / sine
    };
    let bent = if sine > 1e-3 && near < 1e3 * length {
        // t − first + near is what is divided by; the frame's far side must stay behind the horizon.
        let n = near.max(0.02 * length);
        let (a, b) = ((2.0 * n + length) / length, -2.0 * n * (n + length) / length);
        let shift = n - first;
        // Rows: s; a (t + shift) + b; t + shift.
        Mat3::from_cols(Vec3::X, Vec3::new(0.0, a, 1.0), Vec3::new(0.0, a * shift + b, shift)) * turned
    } else {
        turned
    };
    // The box of the visible points after the warp is then fitted to the frame.
    let bounds = seen.iter().fold((Vec2::MAX, Vec2::MIN), |(low, high), p| {
        let p = bent * light.clip(*p).truncate().with_z(1.0);
        let p = p.truncate() / p.z;
        (low.min(p), high.max(p))
    });
    let (low, high) = bounds;
    let scale = 2.0 * FILLED / (high - low).max(Vec2::splat(1e-6));
    let middle = (low + high) / 2.0;
    let fit = Mat3::from_cols(
        Vec3::new(scale.x, 0.0, 0.0),
        Vec3::new(0.0, scale.y, 0.0),
        Vec3::new(-middle.x * scale.x, -middle.y * scale.y, 1.0),
    );
    // A warp whose horizon crosses the frame is replaced by the turned view without perspective.
    Warp::new(fit * bent).or_else(|| Warp::new(fit * turned))
}

/// Points that the eye sees, of up to about 40 000 pixels.
fn visible(scene: &Scene, eye: &Eye) -> Vec<Vec3> {
    let (width, height) = (scene.film().crop.width(), scene.film().crop.height());
    let step = ((width as f32 * height as f32 / 40_000.0).sqrt() as u32).max(1);
    let axis = eye.projected.eye().1;
    let pixels =
        (0..height).step_by(step as usize).flat_map(|y| (0..width).step_by(step as usize).map(move |x| [x, y]));
    let point = |at: [u32; 2]| {
        let depth = eye.visibility.depths[(at[1] * width + at[0]) as usize];
        if depth <= 0.0 {
            return None;
        }
        let ray = eye.projected.ray(scene, at);
        // The axis is as long as a unit of the view's own coordinates.
        let t = eye.projected.distance_of(depth) * axis.length_squared() / ray.direction.dot(axis);
        let from = eye.projected.local(ray.origin).z * axis.length_squared() / ray.direction.dot(axis);
        Some(ray.at(t - from)).filter(|p| p.is_finite())
    };
    pixels.filter_map(point).collect()
}
