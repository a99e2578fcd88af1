//! Wood, marble and waves: solid patterns made of rings, veins and noise.

use super::{
    super::{exact, mapping::Coordinates3, noise::Fractal},
    tiling::pulse,
};
use steradian_math::Vec3;

/// Rings around z, as Peachey has them (in Ebert et al., *Texturing & Modeling*; the lecture's code): the radius is
/// moved by `wobble · sin(lobes · φ + twist · z)`, and of each period of the radius a share is light. The lecture
/// writes `tan(u/w)` for the angle; `atan2(y, x)` is meant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wood {
    /// Width of a ring, light and dark together.
    pub ring: f32,
    /// Share of a ring that is light.
    pub light: f32,
    /// Deviation of the rings from circles.
    pub wobble: f32,
    /// Bulges around a ring.
    pub lobes: f32,
    /// Turn of the bulges along z, radians per unit.
    pub twist: f32,
    /// Displacement of the radius by noise.
    pub grain: f32,
    /// The noise.
    pub noise: Fractal,
}

impl Default for Wood {
    /// The lecture's figures in units of a ring of 60: wobble 2, twenty bulges, 40 of 60 light.
    fn default() -> Self {
        Self {
            ring: 1.0,
            light: 2.0 / 3.0,
            wobble: 2.0 / 60.0,
            lobes: 20.0,
            twist: 60.0 / 150.0,
            grain: 0.0,
            noise: Fractal::new(4, 0.5),
        }
    }
}

impl Wood {
    /// The share of light wood in the footprint.
    pub fn value(&self, c: &Coordinates3) -> f32 {
        let p = c.p;
        let flat = p.truncate();
        let mut radius = flat.length();
        if self.wobble != 0.0 {
            let angle = exact::atan2(p.y.into(), p.x.into());
            radius += self.wobble * exact::sin(f64::from(self.lobes) * angle + f64::from(self.twist * p.z)) as f32;
        }
        if self.grain != 0.0 {
            radius += self.grain * self.noise.fbm(c);
        }
        // How far the footprint goes across the rings.
        let outward = flat.normalize_or_zero();
        let across = |d: Vec3| (d.truncate().dot(outward)).abs();
        let width = across(c.dx).max(across(c.dy)).max(0.25 * c.dx.length().max(c.dy.length()));
        pulse(radius / self.ring, width / self.ring, self.light)
    }
}

/// `½ + ½ sin(y + variation · fBm(p))`.
pub fn marble(c: &Coordinates3, noise: &Fractal, variation: f32) -> f32 {
    let phase = c.p.y + variation * noise.fbm(c);
    // The sine fades where the footprint holds more of its periods than it can show.
    let w = f64::from(c.dx.y.abs().max(c.dy.y.abs()));
    let fade = if w > 1e-3 { (exact::sin(w * 0.5) / (w * 0.5)).max(0.0) as f32 } else { 1.0 };
    let fade = if w < std::f64::consts::TAU { fade } else { 0.0 };
    0.5 + 0.5 * fade * exact::sin(phase.into()) as f32
}

/// pbrt-v4's `windy`: waves of six octaves, as high as three octaves of wind ten times as wide are strong.
pub fn windy(c: &Coordinates3) -> f32 {
    let wind = Fractal::new(3, 0.5).fbm(&c.scaled(0.1));
    wind.abs() * Fractal::new(6, 0.5).fbm(c)
}
