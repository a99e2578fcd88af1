//! Whether a point sees a light.

use steradian_core::{
    Scene,
    light::{Light, LightSample},
    scene::Interaction,
};
use steradian_math::{Ray, Vec3};

use crate::{
    Error,
    draw_list::DrawList,
    options::{Options, Shadows},
    projection::Projected,
    visibility::Visibility,
};

/// What a light sees in a square view: distances along its axis (Williams 1978, "Casting Curved Shadows on Curved Surfaces").
#[derive(Debug)]
struct Map {
    view: Projected,
    /// Distances by rows.
    distances: Vec<f32>,
    size: u32,
    /// Width of a texel: in space for parallel light, at distance 1 otherwise.
    texel: f32,
    perspective: bool,
}

/// The means to tell shadows, made once for a scene.
#[derive(Debug)]
pub struct Shadowing {
    kind: Shadows,
    bias: f32,
    pcf: u32,
    /// For each light its maps: one for parallel light, six for points, none for others.
    maps: Vec<Vec<Map>>,
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

/// Slopes are taken to be no steeper than this.
const STEEPEST: f32 = 100.0;

impl Shadowing {
    /// Draws the maps that the options ask for.
    ///
    /// # Errors
    /// Those of the pipeline.
    pub fn new(scene: &Scene, list: &DrawList, options: &Options) -> Result<Self, Error> {
        let mut maps = Vec::new();
        if options.shadows == Shadows::Map {
            let (center, radius) = crate::extent(scene);
            let size = options.size;
            for light in &scene.lights.lights {
                let place = match light {
                    Light::Point(p, _) => Some(*p),
                    Light::Spot(s) => Some(s.position),
                    Light::Goniometric(g) => Some(g.position),
                    Light::Projection(p) => Some(p.position()),
                    _ => None,
                };
                let mut of_light = Vec::new();
                if let Some(place) = place {
                    let reach = (place - center).length() + radius;
                    for axes in FACES {
                        let view = Projected::of_light(place, axes, 1.0, true, [1e-5 * reach, reach], size);
                        of_light.push(Map::new(scene, list, view, 2.0 / size as f32, size, true)?);
                    }
                } else if let Light::Distant(wi, _) = light {
                    let forward = -*wi;
                    let right = wi.any_orthonormal_vector();
                    // Left-handed, as cameras are.
                    let axes = [right, forward.cross(right), forward];
                    // A little beyond the scene, so that its border is inside.
                    let half = 1.01 * radius;
                    let view = Projected::of_light(center + *wi * half, axes, half, false, [0.0, 2.0 * half], size);
                    of_light.push(Map::new(scene, list, view, 2.0 * half / size as f32, size, false)?);
                }
                maps.push(of_light);
            }
        }
        Ok(Self { kind: options.shadows, bias: options.bias, pcf: options.pcf, maps })
    }

    /// How much of a light reaches a point: 1 where it is lit, 0 in its shadow.
    pub fn lit(&self, scene: &Scene, light: u32, i: &Interaction, sample: &LightSample, rays: &mut u64) -> f32 {
        match self.kind {
            Shadows::None => 1.0,
            Shadows::Map if self.maps.get(light as usize).is_some_and(|m| !m.is_empty()) => {
                self.by_map(&self.maps[light as usize], i, sample.wi)
            }
            _ => {
                *rays += 1;
                f32::from(u8::from(!scene.occluded(&i.spawn_towards(sample.wi, sample.distance))))
            }
        }
    }

    /// Whether nothing lies on the way of a ray to the sky.
    pub fn is_open(&self, scene: &Scene, ray: &Ray, rays: &mut u64) -> bool {
        if self.kind == Shadows::None {
            return true;
        }
        *rays += 1;
        !scene.occluded(ray)
    }

    fn by_map(&self, maps: &[Map], i: &Interaction, wi: Vec3) -> f32 {
        let map = match maps {
            [one] => one,
            _ => {
                // The face that the light looks through at the point: along −wi.
                let d = -wi;
                let a = d.abs();
                let axis = if a.x >= a.y && a.x >= a.z {
                    0
                } else if a.y >= a.z {
                    1
                } else {
                    2
                };
                &maps[2 * axis + usize::from(d[axis] < 0.0)]
            }
        };
        map.lit(i.surface.p, i.surface.n, self.bias, self.pcf)
    }
}

impl Map {
    fn new(
        scene: &Scene,
        list: &DrawList,
        view: Projected,
        texel: f32,
        size: u32,
        perspective: bool,
    ) -> Result<Self, Error> {
        let seen = Visibility::draw(scene, list, &view)?;
        let distances = seen.depths.iter().map(|depth| view.distance_of(*depth)).collect();
        Ok(Self { view, distances, size, texel, perspective })
    }

    /// The share of the texels around a point's that do not see something before it (percentage-closer filtering; Reeves, Salesin, Cook 1987).
    /// A point is lit where its distance is at most that of what the light sees, plus the bias.
    fn lit(&self, p: Vec3, n: Vec3, bias: f32, pcf: u32) -> f32 {
        let local = self.view.local(p);
        let clip = self.view.clip(p);
        if clip.w.is_nan() || clip.w <= 0.0 {
            return 1.0;
        }
        let texel = if self.perspective { self.texel * local.z } else { self.texel };
        // How the distance along the axis changes from texel to texel on the plane of the surface, in widths of a texel: the sum of both axes.
        let n = self.view.turn(n);
        let towards = if self.perspective { local / local.z } else { Vec3::Z };
        let slope = ((n.x.abs() + n.y.abs()) / n.dot(towards).abs().max(1e-6)).min(STEEPEST);
        // The surface changes by its slope from the middle of a texel to its border, and further texels lie further off.
        let reach = 0.5 * (pcf as f32 + 1.0);
        let limit = local.z - bias * texel * (reach * slope + 0.1);
        let to_texel = |x: f32| (x * 0.5 + 0.5) * self.size as f32;
        let (x, y) = (to_texel(clip.x / clip.w), to_texel(-clip.y / clip.w));
        let half = (pcf as f32 - 1.0) / 2.0;
        let mut lit = 0;
        for (dx, dy) in (0..pcf).flat_map(|i| (0..pcf).map(move |j| (i, j))) {
            let at = |x: f32, d: u32| (x - half + d as f32).floor();
            let (x, y) = (at(x, dx), at(y, dy));
            let inside = |v: f32| v >= 0.0 && v < self.size as f32;
            // What lies beyond a parallel light's map casts no shadow; beyond a face, its border goes on.
            let (x, y) = if self.perspective {
                let last = (self.size - 1) as f32;
                (x.clamp(0.0, last), y.clamp(0.0, last))
            } else if inside(x) && inside(y) {
                (x, y)
            } else {
                lit += 1;
                continue;
            };
            let blocker = self.distances[(y as u32 * self.size + x as u32) as usize];
            lit += u32::from(limit <= blocker);
        }
        lit as f32 / (pcf * pcf) as f32
    }
}
