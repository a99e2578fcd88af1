//! Visibility of lights from points. Each technique is a file: all give a share from 0 (dark) to 1 (lit), and leave to
//! rays what they cannot tell.

mod cascades;
mod casters;
mod cube;
mod map;
mod moments;
mod planar;
mod soft;
mod volume;
mod warp;

use steradian_core::{
    Scene,
    light::{Light, LightSample},
    scene::Interaction,
};
use steradian_math::{Ray, Vec3};

use crate::{
    Error,
    draw_list::DrawList,
    options::{BiasBy, Options, Shadows},
    projection::Projected,
    trace::Trace,
    visibility::Visibility,
};
pub use casters::Casters;
use map::{Filter, Map};
use moments::Moments;
use planar::Planar;
use soft::Soft;
use volume::Volumes;

/// More lights than this have no means of their own: rays tell their shadows.
const MOST_LIGHTS: usize = 16;

/// Visible surfaces from the eye.
#[derive(Clone, Copy, Debug)]
pub struct Eye<'a> {
    /// From where.
    pub projected: &'a Projected,
    /// And what.
    pub visibility: &'a Visibility,
}

/// Shadow data of one light.
#[derive(Debug)]
enum Means {
    Rays,
    /// One map for parallel light, six for points.
    Maps(Vec<Map>),
    /// The first map with a point counts.
    Cascades(Vec<Map>),
    Moments(Vec<Moments>),
    Soft(Box<Soft>),
    Volumes(Volumes),
    Planar(Planar),
}

/// The means to tell shadows, made once for a scene, or for each picture.
#[derive(Debug)]
pub struct Shadowing {
    kind: Shadows,
    /// True if rays find the share of light that transparent surfaces let pass; otherwise they test their opacity.
    blends: bool,
    filter: Filter,
    lights: Vec<Means>,
}

/// Position or direction of a light without extent.
#[derive(Clone, Copy, Debug)]
enum Source {
    /// A point.
    At(Vec3),
    /// A unit direction.
    From(Vec3),
}

impl Source {
    fn of(light: &Light) -> Option<Self> {
        Some(match light {
            Light::Punctual(light) => Self::At(light.position()),
            Light::Distant(wi, _) => Self::From(*wi),
            _ => return None,
        })
    }
}

impl Shadowing {
    /// By rays alone, which find shares of light if `blends`.
    pub fn by_rays(blends: bool) -> Self {
        let filter = Filter::new((0.0, BiasBy::Slope), 1, 0);
        Self { kind: Shadows::Ray, blends, filter, lights: Vec::new() }
    }

    /// Draws what the options ask for.
    ///
    /// # Errors
    /// Those of the pipeline.
    pub fn new(scene: &Scene, list: &DrawList, options: &Options, eye: &Eye) -> Result<Self, Error> {
        let filter = Filter::new((options.bias, options.bias_by), options.pcf, options.pcf_samples);
        let mut lights = Vec::new();
        // Prepare maps or volumes once for each light; many lights fall back to rays.
        if !matches!(options.shadows, Shadows::None | Shadows::Ray) && scene.lights().lights.len() <= MOST_LIGHTS {
            let maker = Maker { scene, list, options, eye, casters: Casters::new(scene, list, options.shadows)? };
            lights = scene.lights().lights.iter().map(|light| maker.means(light)).collect::<Result<_, _>>()?;
        }
        let blends = options.blends() && scene.has_layers();
        Ok(Self { kind: options.shadows, blends, filter, lights })
    }

    /// Visibility of a light from a point: 1 where it is lit, 0 in its shadow.
    pub fn lit(&self, scene: &Scene, light: u32, i: &Interaction, sample: &LightSample, trace: &mut Trace<'_>) -> f32 {
        let (p, n) = (i.surface.p, i.surface.n);
        // `None` from any technique means that it cannot tell: a ray decides.
        let told = match self.lights.get(light as usize).unwrap_or(&Means::Rays) {
            _ if self.kind == Shadows::None => Some(1.0),
            Means::Rays => None,
            Means::Maps(maps) => Some(maps[face(maps.len(), sample.wi)].lit(p, n, &self.filter).unwrap_or(1.0)),
            // The finest cascade that contains the point decides.
            Means::Cascades(maps) => maps.iter().find_map(|map| map.lit(p, n, &self.filter)),
            Means::Moments(maps) => Some(maps[face(maps.len(), sample.wi)].lit(p, n)),
            Means::Soft(soft) => Some(soft.lit(p, n, &self.filter)),
            Means::Volumes(volumes) => trace.pixel.and_then(|pixel| volumes.lit(scene, i, sample.wi, pixel)),
            Means::Planar(planar) => trace.pixel.map(|pixel| planar.lit(pixel)),
        };
        told.unwrap_or_else(|| self.by_ray(scene, &i.spawn_towards(sample.wi, sample.distance), trace))
    }

    /// True if rays find shares of light.
    pub fn blends(&self) -> bool {
        self.blends
    }

    /// The share of light that passes along a ray.
    fn by_ray(&self, scene: &Scene, ray: &Ray, trace: &mut Trace<'_>) -> f32 {
        match self.blends {
            true => trace.open(scene, ray),
            false => f32::from(u8::from(!trace.is_occluded(scene, ray))),
        }
    }

    /// The share of a light that a point sees, where that is told for the whole light at once.
    pub fn share(&self, light: u32, i: &Interaction) -> Option<f32> {
        match self.lights.get(light as usize) {
            Some(Means::Soft(soft)) => Some(soft.lit(i.surface.p, i.surface.n, &self.filter)),
            _ => None,
        }
    }

    /// The maps of the first light that has some, side by side in rows of three in a picture of this size: near white,
    /// far black.
    pub fn maps_side_by_side(&self, [width, height]: [u32; 2]) -> Option<Vec<Vec3>> {
        let maps = self.lights.iter().find_map(|means| match means {
            Means::Maps(maps) | Means::Cascades(maps) => Some(maps.as_slice()),
            Means::Soft(soft) => Some(soft.maps()),
            _ => None,
        })?;
        // Nearest texels, the greyscale linear in distance.
        let columns = (maps.len() as u32).min(3);
        let side = (width / columns).min(height / (maps.len() as u32).div_ceil(columns)).max(1);
        let pixel = |x: u32, y: u32| {
            // Which map the pixel falls into, and which of its texels.
            let number = if x / side < columns { y / side * columns + x / side } else { u32::MAX };
            let Some(map) = maps.get(number as usize) else { return Vec3::new(0.0, 0.0, 0.15) };
            let texel = |i: u32| (u64::from(i % side) * u64::from(map.size) / u64::from(side)) as u32;
            let distance = map.distances[(texel(y) * map.size + texel(x)) as usize];
            Vec3::splat(1.0 - map.view.share_of(distance))
        };
        Some((0..height).flat_map(|y| (0..width).map(move |x| pixel(x, y))).collect())
    }

    /// The share of light of the sky that comes along a ray.
    pub fn of_sky(&self, scene: &Scene, ray: &Ray, trace: &mut Trace<'_>) -> f32 {
        if self.kind == Shadows::None { 1.0 } else { self.by_ray(scene, ray, trace) }
    }
}

/// True if a scene has a light without extent.
pub fn has_sharp_light(scene: &Scene) -> bool {
    scene.lights().lights.iter().any(|light| Source::of(light).is_some())
}

/// True if these options give a scene shadow maps.
pub fn has_maps(scene: &Scene, options: &Options) -> bool {
    let lights = &scene.lights().lights;
    let has_some = match options.shadows {
        Shadows::Map | Shadows::Cube | Shadows::Trapezoid | Shadows::Perspective | Shadows::Cascades => {
            has_sharp_light(scene)
        }
        Shadows::Pcss => has_sharp_light(scene) || lights.iter().any(|light| matches!(light, Light::Area(_))),
        _ => false,
    };
    has_some && lights.len() <= MOST_LIGHTS
}

/// Number of shadow volumes of the first light without extent that each pixel is in; `None` where there is no such
/// light.
pub fn stencil_counts(scene: &Scene, casters: &Casters, eye: &Eye) -> Result<Option<Vec<u8>>, Error> {
    let Some(source) = scene.lights().lights.iter().find_map(Source::of) else { return Ok(None) };
    Ok(Some(Volumes::new(scene, casters, source, eye, true)?.into_counts()))
}

/// Which of so many maps a light looks through at a point that sees it in direction `wi`: along −wi.
fn face(count: usize, wi: Vec3) -> usize {
    if count < 6 {
        return 0;
    }
    // The axis with the largest component is that of the cube face.
    let d = -wi;
    let a = d.abs();
    let axis = if a.x >= a.y && a.x >= a.z {
        0
    } else if a.y >= a.z {
        1
    } else {
        2
    };
    2 * axis + usize::from(d[axis] < 0.0)
}

/// Right, up and forward of the views of a point: +x, −x, +y, −y, +z, −z.
const FACES: [[Vec3; 3]; 6] = [
    [Vec3::NEG_Z, Vec3::Y, Vec3::X],
    [Vec3::Z, Vec3::Y, Vec3::NEG_X],
    [Vec3::X, Vec3::NEG_Z, Vec3::Y],
    [Vec3::X, Vec3::Z, Vec3::NEG_Y],
    [Vec3::X, Vec3::Y, Vec3::Z],
    [Vec3::NEG_X, Vec3::Y, Vec3::NEG_Z],
];

/// The six views of a point, up to a distance.
fn cube_views(place: Vec3, range: [f32; 2], size: u32) -> [Projected; 6] {
    FACES.map(|axes| Projected::of_light(place, axes, 1.0, true, range, size))
}

/// Right, up and forward of a view of parallel light from `wi`; left-handed, as cameras are.
fn parallel_axes(wi: Vec3) -> [Vec3; 3] {
    let forward = -wi;
    let right = wi.any_orthonormal_vector();
    [right, forward.cross(right), forward]
}

/// Inputs of the shadow data of lights.
struct Maker<'a> {
    scene: &'a Scene,
    list: &'a DrawList,
    options: &'a Options,
    eye: &'a Eye<'a>,
    casters: Casters,
}

impl Maker<'_> {
    fn means(&self, light: &Light) -> Result<Means, Error> {
        let Self { scene, list, options, eye, .. } = *self;
        // Area lights have maps for soft shadows only, and rays otherwise.
        if let (Light::Area(area), Shadows::Pcss) = (light, options.shadows) {
            return Ok(Soft::new(scene, list, &area.shape, options)?.map_or(Means::Rays, |s| Means::Soft(Box::new(s))));
        }
        let Some(source) = Source::of(light) else { return Ok(Means::Rays) };
        Ok(match (options.shadows, source) {
            (Shadows::Volume | Shadows::VolumePass, _) => {
                let counted_behind = options.shadows == Shadows::Volume;
                Means::Volumes(Volumes::new(scene, &self.casters, source, eye, counted_behind)?)
            }
            (Shadows::Planar, _) => Means::Planar(Planar::new(scene, list, &self.casters, source, eye)?),
            (Shadows::Cascades, Source::From(wi)) => Means::Cascades(cascades::maps(scene, list, options, eye, wi)?),
            (Shadows::Variance | Shadows::Moments, _) => {
                let by_variance = options.shadows == Shadows::Variance;
                // Filtered moments replace the maps that they are made from.
                let filtered = |map: Map| Moments::new(&map, options.pcf, by_variance);
                Means::Moments(self.maps(source)?.into_iter().map(filtered).collect())
            }
            (Shadows::Trapezoid | Shadows::Perspective, Source::From(wi)) => {
                let view = self.parallel_view(wi);
                let warp = warp::warp(scene, eye, &view, options.shadows == Shadows::Trapezoid);
                // What the eye does not see itself may lie outside.
                Means::Cascades(vec![Map::new(scene, list, view.warped(warp), options.size)?])
            }
            _ => Means::Maps(self.maps(source)?),
        })
    }

    fn maps(&self, source: Source) -> Result<Vec<Map>, Error> {
        let Self { scene, list, options, .. } = *self;
        match source {
            Source::At(place) => {
                // Reach from the light over the whole scene; the near plane in proportion.
                let (center, radius) = crate::extent(scene);
                let reach = (place - center).length() + radius;
                let views = cube_views(place, [1e-5 * reach, reach], options.size);
                if options.shadows == Shadows::Cube {
                    return cube::maps(scene, list, &self.casters, &views, options.size);
                }
                views.into_iter().map(|view| Map::new(scene, list, view, options.size)).collect()
            }
            Source::From(wi) => Ok(vec![Map::new(scene, list, self.parallel_view(wi), options.size)?]),
        }
    }

    /// The whole scene as parallel light sees it.
    fn parallel_view(&self, wi: Vec3) -> Projected {
        let (center, radius) = crate::extent(self.scene);
        // A little beyond the scene, so that its border is inside.
        let half = 1.01 * radius;
        let place = center + wi * half;
        Projected::of_light(place, parallel_axes(wi), half, false, [0.0, 2.0 * half], self.options.size)
    }
}
