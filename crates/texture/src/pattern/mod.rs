//! Procedural patterns: numbers as a function of the place, averaged over the footprint. Tilings are averaged exactly
//! by a box or tent as wide as the footprint; noise leaves out the octaves that do not fit; the others fade to their
//! mean.
//!
//! A pattern is a number; two colours are mixed by it. Patterns use exact arithmetic only (`exact`), so that they have
//! the same bits everywhere.

pub mod solid;
pub mod tiling;

#[cfg(test)]
mod tests;

use super::{
    Mapping, TextureContext,
    mapping::{Coordinates2, Coordinates3},
    noise::{Cellular, Fractal, smoothstep},
};
pub use solid::Wood;
use steradian_math::{Vec2, Vec3};
pub use tiling::Bricks;

/// Procedural pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pattern {
    /// 0 in squares whose cell indices have an even sum, 1 in the others.
    Checker2,
    /// 0 in cubes whose cell indices have an even sum, 1 in the others.
    Checker3,
    /// 1 on tiles and bricks, 0 in the mortar.
    Bricks(Bricks),
    /// A random number for each tile or brick, in [0, 1).
    BrickShade(Bricks, u32),
    /// 1 within stripes of a share of the period, that follow each other along u with period one.
    Stripes(f32),
    /// Polka dots: pbrt-v4's, in about half of the unit cells.
    Dots,
    /// The coordinate u, or v where set; not clamped.
    Coordinate(bool),
    /// From 0 in the middle (½, ½) to 1 at distance ½, clamped.
    Radial,
    /// Angle about (½, ½), from 0 to 1.
    Angular,
    /// Fractional Brownian motion.
    Fbm(Fractal),
    /// Turbulence; pbrt's `wrinkled`.
    Turbulence(Fractal),
    /// Ridges.
    Ridged(Fractal),
    /// Waves on water, by wind of varying strength: pbrt's `windy`.
    Windy,
    /// Distance to the nearest random point.
    WorleyF1(Cellular),
    /// To the second nearest.
    WorleyF2(Cellular),
    /// The difference of the two: zero on the borders of cells.
    WorleyBorder(Cellular),
    /// A random number for each cell.
    Voronoi(Cellular),
    /// 1 in the light rings of wood, 0 in the dark ones.
    Wood(Wood),
    /// `½ + ½ sin(y + variation · fBm)`: pbrt's veins of marble.
    Marble(Fractal, f32),
    /// |n·d| of the surface's normal and a unit direction.
    Facing(Vec3),
}

/// A pattern with all that its lookup needs.
#[derive(Clone, Debug)]
pub struct PatternTexture {
    /// Procedural pattern.
    pub pattern: Pattern,
    /// Mapping of surface points to the pattern.
    pub mapping: Mapping,
    /// Noise and cells are looked up at (u, v, ½) instead of a point of space.
    pub over_surface: bool,
    /// Frequency of solid patterns.
    pub frequency: f32,
    /// Averaged over the footprint; a point is looked up otherwise.
    pub antialias: bool,
    /// Least width of the average, in texture space.
    pub width: f32,
    /// Factor on the value.
    pub gain: f32,
    /// Added to it.
    pub offset: f32,
    /// Mean over space of patterns that fade to it.
    mean: f32,
}

impl Pattern {
    /// True if it is a function of (u, v) rather than of space.
    pub fn is_flat(&self) -> bool {
        matches!(
            self,
            Self::Checker2
                | Self::Bricks(_)
                | Self::BrickShade(..)
                | Self::Stripes(_)
                | Self::Dots
                | Self::Coordinate(_)
                | Self::Radial
                | Self::Angular
        )
    }

    /// True if it has no average of its own and is faded to its mean instead.
    fn fades(&self) -> bool {
        matches!(
            self,
            Self::BrickShade(..)
                | Self::Dots
                | Self::WorleyF1(_)
                | Self::WorleyF2(_)
                | Self::WorleyBorder(_)
                | Self::Voronoi(_)
        )
    }

    fn at2(&self, c: &Coordinates2) -> f32 {
        match self {
            Self::Checker2 => tiling::checker2(c),
            Self::Bricks(b) => b.value(c),
            Self::BrickShade(b, seed) => b.shade(c.uv, *seed),
            Self::Stripes(duty) => tiling::pulse(c.uv.x, c.width().x, *duty),
            Self::Dots => tiling::polka_dot(c.uv),
            Self::Coordinate(v) => c.uv[usize::from(*v)],
            Self::Radial => ((c.uv - 0.5).length() * 2.0).min(1.0),
            Self::Angular => super::mapping::projector::azimuth((c.uv - 0.5).extend(0.0)),
            _ => 0.0,
        }
    }

    fn at3(&self, c: &Coordinates3) -> f32 {
        match self {
            Self::Checker3 => tiling::checker3(c),
            Self::Fbm(f) => f.fbm(c),
            Self::Turbulence(f) => f.turbulence(c),
            Self::Ridged(f) => f.ridged(c),
            Self::Windy => solid::windy(c),
            Self::WorleyF1(w) => w.nearest(c.p).f1,
            Self::WorleyF2(w) => w.nearest(c.p).f2,
            Self::WorleyBorder(w) => {
                let n = w.nearest(c.p);
                n.f2 - n.f1
            }
            Self::Voronoi(w) => w.nearest(c.p).cell,
            Self::Wood(w) => w.value(c),
            Self::Marble(f, variation) => solid::marble(c, f, *variation),
            _ => 0.0,
        }
    }
}

impl PatternTexture {
    /// A pattern without gain and offset.
    pub fn new(pattern: Pattern, mapping: Mapping) -> Self {
        let mut t = Self {
            pattern,
            mapping,
            over_surface: false,
            frequency: 1.0,
            antialias: true,
            width: 0.0,
            gain: 1.0,
            offset: 0.0,
            mean: 0.0,
        };
        if pattern.fades() {
            // Points of an additive lattice, over 64 periods.
            let n = 4096_u32;
            let sum: f64 = (0..n)
                .map(|i| {
                    let u = |step: u32| i.wrapping_mul(step) as f32 * (64.0 / 4_294_967_296.0);
                    // Powers of the plastic numbers of two and three dimensions.
                    let v = if pattern.is_flat() {
                        pattern.at2(&Coordinates2 {
                            uv: Vec2::new(u(3_242_174_889), u(2_447_445_414)),
                            ..Default::default()
                        })
                    } else {
                        let p = Vec3::new(u(3_518_319_155), u(2_882_110_345), u(2_360_945_575));
                        pattern.at3(&Coordinates3 { p, ..Default::default() })
                    };
                    f64::from(v)
                })
                .sum();
            t.mean = (sum / f64::from(n)) as f32;
        }
        t
    }

    /// True if the value depends on the footprint.
    pub fn is_filtered(&self) -> bool {
        self.antialias
            && !matches!(self.pattern, Pattern::Coordinate(_) | Pattern::Radial | Pattern::Angular | Pattern::Facing(_))
    }

    /// The value at a place.
    pub fn value(&self, at: &TextureContext) -> f32 {
        let v = if let Pattern::Facing(d) = self.pattern {
            at.n.dot(d).abs()
        } else if self.pattern.is_flat() {
            let c = self.flat(at);
            self.faded(self.pattern.at2(&c), c.width().max_element())
        } else {
            let c = self.solid(at);
            self.faded(self.pattern.at3(&c), c.width().max_element())
        };
        let v = v * self.gain + self.offset;
        if v.is_finite() { v } else { 0.0 }
    }

    fn flat(&self, at: &TextureContext) -> Coordinates2 {
        let mut c = if self.antialias {
            self.mapping.coordinates(at)
        } else {
            Coordinates2 { uv: self.mapping.uv(at), ..Coordinates2::default() }
        };
        if !c.uv.is_finite() {
            c.uv = Vec2::ZERO;
        }
        if self.width > 0.0 {
            c.dx.x = c.dx.x.abs().max(self.width);
            c.dy.y = c.dy.y.abs().max(self.width);
        }
        c
    }

    fn solid(&self, at: &TextureContext) -> Coordinates3 {
        let mut c = if self.over_surface {
            let c = self.flat(at);
            Coordinates3 { p: c.uv.extend(0.0), dx: c.dx.extend(0.0), dy: c.dy.extend(0.0) }
        } else if self.antialias {
            self.mapping.solid_coordinates(at)
        } else {
            Coordinates3 { p: self.mapping.solid(at.p), ..Coordinates3::default() }
        };
        c = c.scaled(self.frequency);
        if self.over_surface {
            // The middle of a layer of cells: noise is zero on lattice planes.
            c.p.z = 0.5;
        }
        if !c.p.is_finite() {
            c.p = Vec3::ZERO;
        }
        if self.width > 0.0 && c.dx.length_squared().max(c.dy.length_squared()) < self.width * self.width {
            c.dx = Vec3::X * self.width;
        }
        c
    }

    /// The value where the footprint is small against a cell, the mean where it is as large.
    fn faded(&self, v: f32, width: f32) -> f32 {
        if width <= 0.25 || !self.pattern.fades() {
            return v;
        }
        let t = smoothstep(width, 0.25, 1.0);
        v * (1.0 - t) + self.mean * t
    }
}
