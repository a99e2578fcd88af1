//! Clustered lights (Olsson, Billeter, Assarsson 2012, "Clustered deferred and forward shading"): the view is divided
//! into tiles and slices of depth, and each cell keeps the lights that matter most in it. Lights by the square law have
//! no range beyond which they could be left out; points take a few of the others by chance.

use crate::{Error, projection::Projected};
use rayon::prelude::*;
use steradian_core::{Scene, light::Light};
use steradian_math::{Bounds3, Vec2, Vec3};

/// Side of tiles in pixels, bounds on their number along each axis, and slices of depth.
const TILE: u32 = 32;
const TILES: [u32; 2] = [16, 64];
const SLICES: u32 = 24;
/// Share of the view's length at which the second slice begins; from there on slices grow in proportion.
const FIRST: f32 = 1e-3;
/// Share of the irradiance of a cell, estimated without shadows at its centre, of the lights that it keeps, and the most
/// that it keeps for that.
const SHARE: f32 = 0.8;
const MOST_KEPT: usize = 48;
/// Lights that a picture may have.
const MOST_LIGHTS: usize = 1 << 16;

/// Lights by cells of the view.
#[derive(Debug)]
pub struct Clusters {
    projected: Projected,
    tiles: [u32; 2],
    /// Start and end of the slices along the axis of the view.
    range: [f32; 2],
    /// Indices of lights in order, by cells, the nearest slice first, each by rows.
    cells: Vec<Vec<u32>>,
}

impl Clusters {
    /// Assigns the lights of a scene to the cells of a view.
    ///
    /// # Errors
    /// Scenes of more than 65536 lights.
    pub fn new(scene: &Scene, projected: &Projected) -> Result<Self, Error> {
        let lights = scene.lights();
        if lights.lights.len() > MOST_LIGHTS {
            return Err(Error::Scene(format!(
                "lights=clustered takes up to {MOST_LIGHTS} lights, and the scene has {}; lights=chosen takes any number",
                lights.lights.len()
            )));
        }
        let bounds = |light: &Light| match light {
            Light::Punctual(light) => Some(light.bounds(lights.mode())),
            Light::Area(a) | Light::DirectionalArea(a) => Some(a.bounds(&lights.emitters[a.emitter as usize])),
            Light::Environment(_) | Light::Distant(..) => None,
        };
        let all: Vec<_> = (0..).zip(lights.lights.iter().map(bounds)).collect();
        let infinite: Vec<u32> = all.iter().filter(|(_, bounds)| bounds.is_none()).map(|(light, _)| *light).collect();
        let bounded: Vec<_> = all.iter().filter_map(|(light, bounds)| Some((*light, (*bounds)?))).collect();
        let film = scene.film();
        let tiles = [film.width, film.height].map(|size| size.div_ceil(TILE).clamp(TILES[0], TILES[1]));
        let (center, radius) = crate::extent(scene);
        let far = projected.along_axis(center) + radius;
        let far = far.max(1e-6 * radius);
        let empty = Self { projected: *projected, tiles, range: [FIRST * far, far], cells: Vec::new() };
        let cell = |number: u32| {
            let cell = empty.bounds(number);
            let (center, half) = ((cell.min + cell.max) * 0.5, cell.diagonal() * 0.5);
            // Irradiance by the square law; within the cell or the light at the distance of their borders.
            let estimates = bounded.iter().map(|(light, known)| {
                let size2 = half.length_squared() + 0.25 * known.bounds.diagonal().length_squared();
                let distance2 = ((known.bounds.min + known.bounds.max) * 0.5 - center).length_squared();
                (*light, known.intensity / distance2.max(size2).max(f32::MIN_POSITIVE))
            });
            let mut found: Vec<(u32, f32)> = estimates.collect();
            let sum: f32 = found.iter().map(|(_, most)| most).sum();
            // The strongest are kept, and all that have no bounds.
            found.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
            let mut kept = infinite.clone();
            let mut share = 0.0;
            for (light, most) in found.into_iter().take(MOST_KEPT) {
                if share >= SHARE * sum {
                    break;
                }
                share += most;
                kept.push(light);
            }
            kept.sort_unstable();
            kept
        };
        let cells = (0..tiles[0] * tiles[1] * SLICES).into_par_iter().map(cell).collect();
        Ok(Self { cells, ..empty })
    }

    /// Indices of the lights that matter most at a point, in order; `None` outside the view.
    pub fn at(&self, p: Vec3) -> Option<&[u32]> {
        let clip = self.projected.clip(p);
        let place = Vec2::new(clip.x, -clip.y) / clip.w * 0.5 + 0.5;
        let [width, height] = self.tiles;
        let is_in = clip.w > 0.0 && place.min_element() >= 0.0 && place.max_element() < 1.0;
        let depth = self.projected.along_axis(p);
        if !is_in || depth < 0.0 || depth > self.range[1] {
            return None;
        }
        let slice = (1..SLICES).rev().find(|k| depth >= self.start(*k)).unwrap_or(0);
        let [x, y] = [(place.x * width as f32) as u32, (place.y * height as f32) as u32];
        self.cells.get(((slice * height + y) * width + x) as usize).map(Vec::as_slice)
    }

    /// Mean number of lights of a cell.
    pub fn mean_count(&self) -> f64 {
        self.cells.iter().map(Vec::len).sum::<usize>() as f64 / self.cells.len() as f64
    }

    /// Distance along the axis at which a slice begins.
    fn start(&self, slice: u32) -> f32 {
        let [first, far] = self.range;
        if slice == 0 { 0.0 } else { first * (far / first).powf((slice - 1) as f32 / (SLICES - 1) as f32) }
    }

    /// Box in the world around a cell.
    fn bounds(&self, number: u32) -> Bounds3 {
        let [width, height] = self.tiles;
        let (x, y, slice) = (number % width, number / width % height, number / width / height);
        let [x0, x1, y0, y1] = self.projected.window();
        let mut bounds = Bounds3::EMPTY;
        for k in 0..8_u32 {
            let share = |i: u32, bit: u32, count: u32| (i + (k >> bit & 1)) as f32 / count as f32;
            let depth = self.start(slice + (k >> 2));
            let across = Vec2::new(x0 + (x1 - x0) * share(x, 0, width), y1 - (y1 - y0) * share(y, 1, height));
            let across = if self.projected.is_perspective() { across * depth } else { across };
            bounds = bounds.union(Bounds3::from_points([self.projected.world(across.extend(depth))]));
        }
        bounds
    }
}
