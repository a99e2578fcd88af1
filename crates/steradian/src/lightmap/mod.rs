//! Lightmaps: what light falls on the meshes of a scene, as pictures over a texture atlas of all of them.
//!
//! The [atlas](crate::unwrap) is a second set of texture coordinates. At the centre of each texel that lies in a
//! triangle a light meter ([`crate::meter`]) takes the irradiance of the surface by path tracing. Texels about the charts
//! take the value of the nearest one, so that filters find light beyond their edges. A [lit](lit()) scene shows the map
//! without lights.

mod denoise;
mod instances;
mod lit;
#[cfg(test)]
mod tests;

pub use lit::lit;

use crate::{
    Error, Scene,
    unwrap::{self, Options, Seams, covered},
};
use rayon::prelude::*;
use steradian_core::{
    sampler::{PixelSampler, Sampler, SamplerKind},
    scene::{Hit, PrimId, Shape, WORLD},
};
use steradian_engine::{self as engine, dimension};
use steradian_integrators::{
    Depth,
    meter::{self, Receiver},
};
use steradian_math::{DVec2, Frame, Ray, Vec3, warp};
use steradian_scene::SceneDesc;

/// Quantity that a lightmap holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Irradiance.
    All,
    /// Irradiance straight from lights.
    Direct,
    /// Irradiance by way of other surfaces: the rest.
    Indirect,
    /// Share of the directions, weighted by their cosine, that meet nothing within a distance.
    Ao,
}

/// Settings of a lightmap.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Texels along a side.
    pub resolution: u32,
    /// Texels about charts that have values too.
    pub padding: u32,
    /// Quantities that are baked.
    pub parts: Vec<Part>,
    /// Samples of each texel.
    pub samples: u32,
    /// Random seed.
    pub seed: u64,
    /// Enables scattering by media.
    pub media: bool,
    /// Path depth; light straight from lights counts as no event.
    pub depth: Depth,
    /// Length of the rays of [`Part::Ao`], scene units.
    pub distance: f32,
    /// Removes noise, chart by chart, by regression; of two samples or more, which tell the noise.
    pub denoise: bool,
}

/// Pictures over the atlas, rows from the top.
#[derive(Clone, Debug)]
pub struct Lightmap {
    /// Linear Rec.709 of each part. Under a radiance of 1 from all sides the irradiance is π.
    pub parts: Vec<Vec<[f32; 3]>>,
    /// Part of white light that each texel's surface sends back along its normal, linear Rec.709.
    pub albedo: Vec<[f32; 3]>,
    /// Texels at which light was measured.
    pub measured: usize,
    /// Samples that were not finite, and count as black.
    pub nonfinite: u64,
}

/// Most samples of a lightmap: at a million in a second they take twelve days.
pub const MOST_SAMPLES: u64 = 1 << 40;

/// Bytes that baking takes for each texel, by the number of parts, and whether noise is removed.
pub fn bytes_per_texel(parts: usize, denoise: bool) -> u64 {
    120 + 72 * parts as u64 + if denoise { 300 } else { 0 }
}

/// A scene whose meshes have the coordinates of one atlas as their second set, and the number of shapes that are no
/// meshes and have no place in it.
///
/// # Errors
/// [`Error::CannotUnwrap`], and [`Error::CannotBake`] for instances that move or are too many.
pub fn laid_out(desc: &SceneDesc, options: Options) -> Result<(SceneDesc, usize), Error> {
    let desc = &instances::placed(desc)?;
    let settings = unwrap::Settings { options, seams: Seams::Angle, is_second: true, from_top: true };
    let mut unwrapped = unwrap::unwrap(desc, &settings)?;
    // Meshes without coordinates stay so: their textures are not to change.
    for (before, after) in desc.shapes.iter().zip(&unwrapped.desc.shapes) {
        let meshes = before.mesh.zip(after.mesh).filter(|(before, _)| desc.meshes[*before].uvs.is_empty());
        if let Some((_, after)) = meshes {
            let mut mesh = (*unwrapped.desc.meshes[after]).clone();
            mesh.uvs.clear();
            unwrapped.desc.meshes[after] = mesh.into();
        }
    }
    Ok((unwrapped.desc, unwrapped.left_out))
}

/// A point of a surface that a texel is of.
#[derive(Clone, Copy)]
struct Place {
    id: PrimId,
    u: f32,
    v: f32,
    chart: u32,
}

/// Bakes the lightmap of a scene that was [laid out](laid_out) for the resolution.
///
/// # Errors
/// [`Error::CannotBake`] where no texel lies in a triangle, samples would take too long, or one sample is to be
/// denoised.
pub fn bake(scene: &Scene, settings: &Settings) -> Result<Lightmap, Error> {
    if settings.denoise && settings.samples < 2 {
        return Err(Error::CannotBake("one sample does not tell its noise: denoising takes two or more".into()));
    }
    let side = settings.resolution as usize;
    let places = places(scene, side);
    let measured: Vec<usize> = (0..places.len()).filter(|k| places[*k].is_some()).collect();
    if measured.is_empty() {
        return Err(Error::CannotBake("no triangle has a place in the lightmap".into()));
    }
    let samples = measured.len() as u64 * u64::from(settings.samples);
    if samples > MOST_SAMPLES {
        let (texels, each) = (measured.len(), settings.samples);
        return Err(Error::CannotBake(format!(
            "{texels} texels of {each} samples are {samples:.1e} samples, more than {MOST_SAMPLES:.1e}: take fewer \
             samples or a lower resolution"
        )));
    }
    let baker = Baker { scene, settings, side };
    let mut texels: Vec<Texel> =
        measured.par_iter().map(|&k| places[k].map_or_else(Default::default, |place| baker.texel(k, place))).collect();
    if settings.denoise {
        denoise::charts(&mut texels, side)?;
    }
    let mut numbers = vec![NONE; places.len()];
    measured.iter().zip(0..).for_each(|(k, number)| numbers[*k] = number);
    let numbers = spread(numbers, [side; 2], settings.padding);
    let over = |value: &dyn Fn(&Texel) -> [f32; 3]| -> Vec<[f32; 3]> {
        numbers.iter().map(|number| texels.get(*number as usize).map_or([0.0; 3], value)).collect()
    };
    Ok(Lightmap {
        parts: (0..settings.parts.len()).map(|part| over(&|texel| texel.parts[part])).collect(),
        albedo: over(&|texel| texel.albedo),
        measured: measured.len(),
        nonfinite: texels.iter().map(|texel| texel.nonfinite).sum(),
    })
}

/// The points of surfaces that texels are of: at their centres, and for triangles that cover no centre in their own
/// middle.
fn places(scene: &Scene, side: usize) -> Vec<Option<Place>> {
    let mut places = vec![None; side * side];
    let mut small = Vec::new();
    for (geom, geometry) in (0..scene.world_count()).zip(scene.geometries()) {
        let Shape::Mesh(mesh) = &geometry.shape else { continue };
        let Some(uvs) = mesh.attributes.iter().find(|a| a.name == unwrap::SECOND && a.channels == 2) else { continue };
        let charts = mesh.attributes.iter().find(|a| a.name == unwrap::CHART);
        let texel =
            |i: u32| DVec2::new(uvs.data[2 * i as usize].into(), uvs.data[2 * i as usize + 1].into()) * side as f64;
        for (prim, triangle) in (0..).zip(mesh.triangles.iter()) {
            let id = PrimId { instance: WORLD, geom, prim };
            let chart = charts.map_or(0, |charts| charts.data[prim as usize] as u32);
            let [a, b, c] = triangle.map(texel);
            let area = (b - a).perp_dot(c - a);
            if area == 0.0 {
                continue;
            }
            let mut is_small = true;
            covered([a, b, c], side, |x, y| {
                is_small = false;
                let p = DVec2::new(x as f64 + 0.5, y as f64 + 0.5) - a;
                let (u, v) = (p.perp_dot(c - a) / area, (b - a).perp_dot(p) / area);
                places[y * side + x].get_or_insert(Place { id, u: u as f32, v: v as f32, chart });
            });
            if is_small {
                small.push(((a + b + c) / 3.0, Place { id, u: 1.0 / 3.0, v: 1.0 / 3.0, chart }));
            }
        }
    }
    let texel = |x: f64| (x as usize).min(side - 1);
    for (middle, place) in small {
        places[texel(middle.y) * side + texel(middle.x)].get_or_insert(place);
    }
    places
}

/// Measurement at a texel.
#[derive(Clone, Debug, Default)]
struct Texel {
    /// Its number, row by row.
    number: usize,
    chart: u32,
    normal: Vec3,
    parts: Vec<[f32; 3]>,
    /// Variances of the means that the parts are; empty where noise is not removed.
    variances: Vec<[f32; 3]>,
    albedo: [f32; 3],
    nonfinite: u64,
}

/// All that measuring needs.
#[derive(Clone, Copy)]
struct Baker<'a> {
    scene: &'a Scene,
    settings: &'a Settings,
    side: usize,
}

impl Baker<'_> {
    /// Measures a texel. Random numbers depend on the texel and the sample.
    fn texel(&self, texel: usize, place: Place) -> Texel {
        let Settings { samples, seed, .. } = *self.settings;
        let hit = Hit { t: 0.0, u: place.u, v: place.v, id: place.id };
        let mut at = self.scene.interaction(&Ray::new(Vec3::ZERO, Vec3::Z), &hit);
        let n = if at.surface.ns.dot(at.surface.n) < 0.0 { -at.surface.ns } else { at.surface.ns };
        // Seen from the side that the light falls on.
        at.wo = n;
        let lambda = self.scene.mode().wavelengths(|| 0.5);
        let albedo = engine::albedo(self.scene, &at, &lambda).map_or(Vec3::ZERO, |(albedo, _)| albedo);
        let receiver = meter::off_surface(self.scene, &Receiver::Plane(at.surface.p, n));
        let sampler = Sampler { kind: SamplerKind::Sobol, spp: samples, seed };
        let (x, y) = ((texel % self.side) as u32, (texel / self.side) as u32);
        // Of both halves of the samples.
        let mut sums = vec![[[0.0_f64; 2]; 3]; self.settings.parts.len()];
        let first = samples / 2;
        let mut nonfinite = 0;
        for index in 0..samples {
            let sampler = sampler.pixel(x, y, index);
            let light = |max: u32| {
                let depth = Depth { max, hide_emitters: false, ..self.settings.depth };
                let settings = meter::Settings { samples: 1, error: None, seed, media: self.settings.media, depth };
                meter::sample(self.scene, &receiver, &settings, &sampler)
            };
            let has = |part: Part| self.settings.parts.contains(&part);
            let all = if has(Part::All) || has(Part::Indirect) { light(self.settings.depth.max) } else { Vec3::ZERO };
            let direct = if has(Part::Direct) || has(Part::Indirect) { light(0) } else { Vec3::ZERO };
            if !(all + direct).is_finite() {
                nonfinite += 1;
                continue;
            }
            for (sum, part) in sums.iter_mut().zip(&self.settings.parts) {
                let value = match part {
                    Part::All => all,
                    Part::Direct => direct,
                    Part::Indirect => all - direct,
                    Part::Ao => self.openness(&receiver, &sampler),
                };
                (0..3).for_each(|k| sum[k][usize::from(index >= first)] += f64::from(value[k]));
            }
        }
        let mean = |[a, b]: [f64; 2]| ((a + b) / f64::from(samples)) as f32;
        // By the halves' difference: samples that fill their domain evenly err far less than they scatter.
        let variance =
            |[a, b]: [f64; 2]| (0.25 * (a / f64::from(first) - b / f64::from(samples - first)).powi(2)) as f32;
        let variances =
            if self.settings.denoise { sums.iter().map(|sum| sum.map(variance)).collect() } else { Vec::new() };
        Texel {
            number: texel,
            chart: place.chart,
            normal: n,
            parts: sums.iter().map(|sum| sum.map(mean)).collect(),
            variances,
            albedo: albedo.to_array(),
            nonfinite,
        }
    }

    /// One where a direction in proportion to its cosine meets nothing, else zero.
    fn openness(&self, receiver: &Receiver, sampler: &PixelSampler) -> Vec3 {
        let Receiver::Plane(p, n) = *receiver else { return Vec3::ZERO };
        let u = sampler.get_2d(dimension::at(0, dimension::DIRECTION));
        let w = Frame::from_z(n).to_world(warp::cosine_hemisphere(u));
        let ray = Ray { t_max: self.settings.distance, ..Ray::new(p, w) };
        Vec3::splat(if self.scene.occluded(&ray) { 0.0 } else { 1.0 })
    }
}

/// Number of texels that are of no point.
const NONE: u32 = u32::MAX;

/// Numbers that go on beyond charts, ring by ring: texels without one take that of a neighbour, those beside before
/// those at corners.
fn spread(mut numbers: Vec<u32>, [width, height]: [usize; 2], rings: u32) -> Vec<u32> {
    const AROUND: [[isize; 2]; 8] = [[0, -1], [-1, 0], [1, 0], [0, 1], [-1, -1], [1, -1], [-1, 1], [1, 1]];
    for _ in 0..rings {
        let near = |k: usize| {
            let (x, y) = ((k % width) as isize, (k / width) as isize);
            let inside = |[dx, dy]: [isize; 2]| {
                let (x, y) = (usize::try_from(x + dx).ok()?, usize::try_from(y + dy).ok()?);
                (x < width && y < height).then(|| numbers[y * width + x])
            };
            AROUND.into_iter().filter_map(inside).find(|number| *number != NONE).unwrap_or(NONE)
        };
        let next = |k: usize| if numbers[k] == NONE { near(k) } else { numbers[k] };
        numbers = (0..numbers.len()).into_par_iter().map(next).collect();
    }
    numbers
}
