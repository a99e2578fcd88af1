//! Skies without a file: pictures made from formulas when a model is read, of latitude and longitude with +y up. The
//! viewer stands at +z of the studio.

use std::f64::consts::{PI, TAU};
use steradian_math::DVec3;

/// Columns of a picture; it has half as many rows.
const COLUMNS: usize = 512;
/// Width in radians of the soft edge of a lamp.
const EDGE: f64 = 0.05;

/// A soft box: a rectangle with round corners in the plane that is tangent to the sphere of directions at its middle.
struct SoftBox {
    /// Azimuth of its middle from the viewer to the right, and elevation, in degrees.
    place: [f64; 2],
    /// Half its width and height, in the tangent plane.
    half: [f64; 2],
    radiance: [f64; 3],
}

/// Key, fill, top light and two rims. None lies before the viewer, where it would be in view.
const BOXES: [SoftBox; 5] = [
    SoftBox { place: [-50.0, 40.0], half: [0.40, 0.30], radiance: [9.0, 8.2, 7.3] },
    SoftBox { place: [64.0, 16.0], half: [0.24, 0.50], radiance: [0.9, 1.0, 1.15] },
    SoftBox { place: [180.0, 80.0], half: [0.46, 0.28], radiance: [1.7, 1.75, 1.85] },
    SoftBox { place: [-138.0, 22.0], half: [0.08, 0.48], radiance: [5.8, 6.8, 8.2] },
    SoftBox { place: [130.0, 32.0], half: [0.10, 0.42], radiance: [5.8, 6.8, 8.2] },
];
/// Radiance of the room at the horizon and at the zenith.
const ROOM: [[f64; 3]; 2] = [[0.055, 0.06, 0.068], [0.16, 0.165, 0.175]];
/// Radiance of the floor, which is that of the ground that fades before it, and the heights (of unit directions)
/// between which the wall becomes the floor.
const FLOOR: [f64; 3] = [0.136, 0.145, 0.162];
const FLOOR_BEGINS: [f64; 2] = [0.0, -0.11];
/// A glow on the wall behind the model: its place, its width in radians, its radiance.
const GLOW: ([f64; 2], f64, [f64; 3]) = ([180.0, 0.0], 0.36, [0.10, 0.11, 0.125]);

/// Direction at an azimuth from +z towards +x and an elevation, in degrees.
fn direction([azimuth, elevation]: [f64; 2]) -> DVec3 {
    let ((sin, cos), (height, level)) = (azimuth.to_radians().sin_cos(), elevation.to_radians().sin_cos());
    DVec3::new(sin * level, height, cos * level)
}

pub(super) fn smoothstep(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

impl SoftBox {
    /// Share of its radiance in a direction: brightest in the middle, none outside.
    fn share(&self, d: DVec3) -> f64 {
        let middle = direction(self.place);
        let along = d.dot(middle);
        if along <= 0.0 {
            return 0.0;
        }
        let right = DVec3::Y.cross(middle).normalize_or(DVec3::X);
        let [x, y] = [right, middle.cross(right)].map(|axis| d.dot(axis) / along);
        let round = 0.3 * self.half[0].min(self.half[1]);
        let [dx, dy] = [x.abs() - self.half[0] + round, y.abs() - self.half[1] + round];
        let distance = dx.max(0.0).hypot(dy.max(0.0)) + dx.max(dy).min(0.0) - round;
        let falloff = 1.0 - 0.35 * ((x / self.half[0]).powi(2) + (y / self.half[1]).powi(2)) * 0.5;
        smoothstep(0.5 - distance / EDGE) * falloff.max(0.0)
    }
}

/// Radiance of a photographer's studio: soft boxes in a dim room that fades from floor to ceiling.
fn studio(d: DVec3) -> [f64; 3] {
    let [wall, ceiling] = ROOM;
    let height = smoothstep(d.y);
    // The ground fades before a floor as bright as it is: of its edge nothing is seen.
    let [top, bottom] = FLOOR_BEGINS;
    let floor = smoothstep((top - d.y) / (top - bottom));
    let shares = BOXES.map(|lamp| lamp.share(d));
    let (place, width, glow) = GLOW;
    let glowing = (-(d.angle_between(direction(place)) / width).powi(2)).exp();
    std::array::from_fn(|c| {
        let lamps: f64 = BOXES.iter().zip(shares).map(|(lamp, share)| lamp.radiance[c] * share).sum();
        let upright = wall[c] + (ceiling[c] - wall[c]) * height + glow[c] * glowing;
        upright + (FLOOR[c] - upright) * floor + lamps
    })
}

/// Radiance of the overcast sky of the CIE (S 011: type 1 to three parts at the horizon), over a ground that reflects
/// three tenths of it.
fn overcast(d: DVec3) -> [f64; 3] {
    const ZENITH: [f64; 3] = [1.62, 1.68, 1.75];
    // Its illuminance is 7π/9 times the luminance of the zenith.
    let below = 0.3 * 7.0 / 9.0;
    let sky = (1.0 + 2.0 * d.y.max(0.0)) / 3.0;
    let share = below + (sky - below) * smoothstep(0.5 + d.y / 0.3);
    ZENITH.map(|zenith| zenith * share)
}

/// Radiance of dim light from all sides, which is a little brighter from above.
fn dim(d: DVec3) -> [f64; 3] {
    [1.0, 1.03, 1.08].map(|c| c * (0.75 + 0.5 * smoothstep(0.5 + 0.5 * d.y)))
}

/// Radiance by direction, linear Rec.709.
type Radiance = fn(DVec3) -> [f64; 3];

/// The names of the skies of formulas, and their radiance.
pub(super) const FORMULAS: [(&str, Radiance); 3] = [("studio", studio), ("overcast", overcast), ("dim", dim)];

/// A picture of the radiance of all directions as a PFM file (latitude and longitude, +y up, linear Rec.709).
pub(super) fn pfm(radiance: impl Fn(DVec3) -> [f64; 3]) -> Vec<u8> {
    let rows = COLUMNS / 2;
    let mut bytes = format!("PF\n{COLUMNS} {rows}\n-1.0\n").into_bytes();
    // PFM begins with the last row.
    for row in (0..rows).rev() {
        let (sin, cos) = (PI * (row as f64 + 0.5) / rows as f64).sin_cos();
        for column in 0..COLUMNS {
            let (sin_phi, cos_phi) = (TAU * (column as f64 + 0.5) / COLUMNS as f64).sin_cos();
            let texel = radiance(DVec3::new(sin * sin_phi, cos, -sin * cos_phi));
            texel.into_iter().for_each(|v| bytes.extend((v as f32).to_le_bytes()));
        }
    }
    bytes
}

/// Irradiance on a surface that faces up.
pub(super) fn irradiance(radiance: impl Fn(DVec3) -> [f64; 3]) -> [f64; 3] {
    const ROWS: usize = 64;
    let mut sum = [0.0; 3];
    for row in 0..ROWS / 2 {
        let (sin, cos) = (PI * (row as f64 + 0.5) / ROWS as f64).sin_cos();
        for column in 0..2 * ROWS {
            let (sin_phi, cos_phi) = (PI * (column as f64 + 0.5) / ROWS as f64).sin_cos();
            let light = radiance(DVec3::new(sin * sin_phi, cos, -sin * cos_phi));
            sum = std::array::from_fn(|c| sum[c] + light[c] * sin * cos);
        }
    }
    sum.map(|v| v * (PI / ROWS as f64).powi(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Irradiance of green on a surface with a normal.
    fn facing(radiance: fn(DVec3) -> [f64; 3], normal: DVec3) -> f64 {
        let rows = 180;
        let mut sum = 0.0;
        for k in 0..rows * rows * 2 {
            let theta = PI * ((k / (2 * rows)) as f64 + 0.5) / rows as f64;
            let phi = PI * ((k % (2 * rows)) as f64 + 0.5) / rows as f64;
            let d = DVec3::new(theta.sin() * phi.sin(), theta.cos(), -theta.sin() * phi.cos());
            sum += radiance(d)[1] * d.dot(normal).max(0.0) * theta.sin();
        }
        sum * (PI / rows as f64).powi(2)
    }

    /// Surfaces of an albedo of 0.8 are as bright as white, the lit side is much brighter than the shaded one, and an
    /// overcast sky has the illuminance of the standard.
    #[test]
    fn skies_have_their_brightness() {
        let up = facing(studio, DVec3::Y);
        assert!((irradiance(studio)[1] / up - 1.0).abs() < 0.02, "{up}");
        let key = facing(studio, direction(BOXES[0].place));
        let away = facing(studio, direction([110.0, -30.0]));
        assert!((3.4..4.2).contains(&up) && (3.4..4.2).contains(&key) && away < 0.45 * key, "{up} {key} {away}");
        let zenith = overcast(DVec3::Y)[1];
        let up = facing(overcast, DVec3::Y) / zenith;
        assert!((up / (7.0 / 9.0 * PI) - 1.0).abs() < 0.02, "{up}");
    }

    /// No lamp is where the camera looks, from level to steep.
    #[test]
    fn lamps_are_out_of_view() {
        for k in 0..2000 {
            let d = direction([180.0 + f64::from(k % 50) - 25.0, f64::from(k / 50) - 25.0]);
            assert!(BOXES.iter().all(|lamp| lamp.share(d) == 0.0), "{d}");
        }
    }
}
