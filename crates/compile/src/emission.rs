//! Compiling the light of shapes.

use super::Compiler;
use std::sync::Arc;
use steradian_core::{
    light::{AreaLight, AreaShape, Emitter, Light, Moving},
    scene::{Geometry, Shape},
    shape::{QuadricKind, TriMesh, level::Swept},
};
use steradian_math::{Vec3, spectra::role::Role};
use steradian_scene::Node;

/// Most lights that instances make.
const MOST_PLACED: usize = 1 << 20;

impl Compiler<'_> {
    /// Makes a geometry emit: adds its emitter and a light for each of its parts.
    pub(super) fn emission(&mut self, light: &Node, is_kept_square: bool, geometry: &mut Geometry) {
        let directional = match light.kind.as_str() {
            "area" => false,
            "directional_area" => true,
            other => {
                self.error(light.span, format!("light '{other}' cannot be attached to a shape"));
                return;
            }
        };
        let mut sweeps = None;
        let area = match &geometry.shape {
            Shape::Mesh(m) => (0..m.triangles.len() as u32).map(|t| triangle_area(m.corners(t))).sum(),
            Shape::Quadric(q) => q.area(),
            Shape::Plane(_) => 1.0,
            Shape::Level(l) => match Swept::new(l) {
                Some(swept) => {
                    let area = swept.area();
                    sweeps = Some(Arc::new(swept));
                    area
                }
                None if self.is_left_to_chance(light) => 1.0,
                None => return,
            },
            Shape::Sdf(_) if self.is_left_to_chance(light) => 1.0,
            _ => return,
        };
        let Some(mut emitter) = self.emitter(light, area) else { return };
        if emitter.luminance <= 0.0 {
            return;
        }
        emitter.alpha = geometry.alpha;
        // Rays pass it from behind.
        emitter.two_sided &= !geometry.is_single_sided;
        let varies = emitter.varies();
        let far_share = match &geometry.shape {
            Shape::Quadric(q) if emitter.alpha.is_some() || geometry.is_single_sided => {
                if emitter.two_sided {
                    0.5
                } else if q.flip {
                    1.0
                } else {
                    0.0
                }
            }
            _ => 0.0,
        };
        self.emitters.push(emitter);
        let emitter = self.emitters.len() as u32 - 1;
        let add = |lights: &mut Vec<Light>, shape: AreaShape, mesh: Option<(Arc<TriMesh>, u32)>| {
            let light = AreaLight { shape, emitter, mesh, far_share };
            lights.push(if directional { Light::DirectionalArea(light) } else { Light::Area(light) });
            lights.len() as u32 - 1
        };
        let lights: Vec<u32> = match &geometry.shape {
            Shape::Quadric(q) => {
                let scale = q.similarity();
                let shape = match (q.kind, scale) {
                    (QuadricKind::Sphere { radius, .. }, Some(scale)) if q.is_whole_sphere() && !varies => {
                        AreaShape::Sphere(q.place.point(Vec3::ZERO), radius * scale, q.flip)
                    }
                    _ => AreaShape::Quadric(q.clone()),
                };
                vec![add(&mut self.lights, shape, None)]
            }
            Shape::Mesh(m) => {
                let mut of_triangle = Vec::with_capacity(m.triangles.len());
                let mut t = 0;
                while t < m.triangles.len() as u32 {
                    let rectangle = if varies || !is_kept_square { None } else { rectangle(m, t) };
                    let n = m.geometric_normal(t);
                    if let Some((corner, ex, ey)) = rectangle {
                        let area = ex.cross(ey).length();
                        let l = add(&mut self.lights, AreaShape::Rectangle { corner, ex, ey, n, area }, None);
                        of_triangle.extend([l, l]);
                        t += 2;
                    } else {
                        let corners = m.corners(t);
                        let shape = AreaShape::Triangle(corners, n, triangle_area(corners));
                        of_triangle.push(add(&mut self.lights, shape, Some((m.clone(), t))));
                        t += 1;
                    }
                }
                of_triangle
            }
            // Others, such as infinite planes, are found by scattering alone.
            _ => sweeps.map_or_else(Vec::new, |swept| vec![add(&mut self.lights, AreaShape::Swept(swept), None)]),
        };
        // Light that leaves along the normal alone is never met by chance.
        if !directional {
            geometry.emitter = Some(emitter);
            geometry.lights = lights.into();
        }
    }

    /// Says that no point of a shape can be drawn as a light; whether it may emit nevertheless.
    fn is_left_to_chance(&mut self, light: &Node) -> bool {
        if light.kind == "directional_area" || self.if_positive(light, "power").is_some() {
            let what = "a light of this kind, or of a power, needs a shape of known area, such as a mesh or a cone; \
                        the light is left out";
            self.diagnostics.dropped(&self.desc.sources, light.span, what);
            return false;
        }
        let what =
            "no point of this shape can be drawn as a light: paths find its light by chance alone, with more noise";
        self.diagnostics.note(&self.desc.sources, light.span, what);
        true
    }

    /// Adds the lights of placed groups, which `of_groups` has for a group where it stands for itself; gives the first
    /// of each placement.
    pub(super) fn place_lights(
        &mut self,
        groups: &[(u32, super::shapes::Boxes)],
        of_groups: &[Vec<Light>],
        instances: &[steradian_accel::Instance],
    ) -> Vec<u32> {
        let mut counts = vec![0; groups.len()];
        instances.iter().for_each(|i| counts[i.object as usize] += of_groups[i.object as usize].len());
        let mut left = MOST_PLACED;
        let mut is_placed = Vec::with_capacity(groups.len());
        for (&count, (base, boxes)) in counts.iter().zip(groups) {
            is_placed.push(count <= left);
            if count <= left {
                left -= count;
                continue;
            }
            let what = format!(
                "the emitting parts of a group come to {count} lights where it is placed, more than {left}: paths find \
                 their light by chance alone, with more noise"
            );
            self.diagnostics.note(&self.desc.sources, None, what);
            let first = *base as usize;
            self.geometries[first..first + boxes.len()].iter_mut().for_each(|g| g.lights = Box::default());
        }
        let mut firsts = Vec::with_capacity(instances.len());
        for instance in instances {
            firsts.push(self.lights.len() as u32);
            if !is_placed[instance.object as usize] {
                continue;
            }
            for light in &of_groups[instance.object as usize] {
                let placed = |area: &AreaLight| {
                    let shape = match &instance.motion {
                        None => area.shape.placed(&instance.world_from_object),
                        Some(motion) => AreaShape::Moving(Arc::new(Moving {
                            shape: area.shape.clone(),
                            start: instance.world_from_object,
                            motion: motion.clone(),
                        })),
                    };
                    AreaLight { shape, ..area.clone() }
                };
                self.lights.push(match light {
                    Light::Area(area) => Light::Area(placed(area)),
                    Light::DirectionalArea(area) => Light::DirectionalArea(placed(area)),
                    other => other.clone(),
                });
            }
        }
        firsts
    }

    fn emitter(&mut self, light: &Node, area: f32) -> Option<Emitter> {
        let two_sided = self.bool(light, "two_sided");
        let mut scale = self.float(light, "scale");
        let (radiance, mean) = if light.get("file").is_some() {
            let texels = (*self.image(light)?).clone();
            let texels = Arc::new(self.emitted_texels(light, texels));
            let mean = super::lights::mean_luminance(&texels);
            let level = steradian_texture::store::Level::new(texels, None).ok()?;
            let image = self.image_texture(light, &level);
            // `scale` of an image texture is the light's own.
            let image = steradian_texture::ImageTexture { scale: 1.0, ..image };
            let texture = self.image_or_opaque(light, &level, image);
            let id = self.textures.add(texture);
            (steradian_texture::SpectrumTexture::Texture(id, Role::Illuminant), mean)
        } else {
            let radiance = self.emitted(light, "radiance");
            scale *= self.normalization(light, "radiance");
            let mean = match &radiance {
                steradian_texture::SpectrumTexture::Constant(c) => c.luminance(self.mode),
                steradian_texture::SpectrumTexture::Texture(..) => self.texture_luminance(light, "radiance"),
            };
            (radiance, mean)
        };
        // The luminance of a picture is counted below, and that of white is one.
        let luminance = if light.get("file").is_some() { 1.0 } else { mean };
        if let Some(power) = self.luminous_target(light, "power", luminance) {
            let sides = if two_sided { 2.0 } else { 1.0 };
            let k = if light.get("file").is_some() { mean } else { 1.0 };
            scale *= power / (k * sides * area * std::f32::consts::PI);
        }
        if !(scale.is_finite() && scale >= 0.0) {
            self.error(light.span, format!("the scale of this light comes to {scale}"));
            return None;
        }
        Some(Emitter { radiance, scale, two_sided, luminance: mean * scale, alpha: None })
    }
}

fn triangle_area([a, b, c]: [Vec3; 3]) -> f32 {
    0.5 * (b - a).cross(c - a).length()
}

/// The rectangle that a triangle and the next one make up, as corner and edges.
fn rectangle(m: &TriMesh, t: u32) -> Option<(Vec3, Vec3, Vec3)> {
    let a = m.corners(t);
    let b = (t as usize + 1 < m.triangles.len()).then(|| m.corners(t + 1))?;
    // The corner of each triangle that the other lacks, and the two they share.
    let lonely = |x: &[Vec3; 3], y: &[Vec3; 3]| {
        let mut it = x.iter().enumerate().filter(|(_, p)| !y.contains(p));
        let first = it.next()?;
        it.next().is_none().then_some(first.0)
    };
    let (i, j) = (lonely(&a, &b)?, lonely(&b, &a)?);
    let (corner, s0, s1) = (a[i], a[(i + 1) % 3], a[(i + 2) % 3]);
    let (ex, ey) = (s0 - corner, s1 - corner);
    let scale = ex.length().max(ey.length());
    let right_angle = ex.dot(ey).abs() < 1e-5 * ex.length() * ey.length();
    let closes = (corner + ex + ey - b[j]).length() < 1e-5 * scale;
    // Both must shine to the same side.
    let same_side = m.geometric_normal(t).dot(m.geometric_normal(t + 1)) > 0.99;
    (right_angle && closes && same_side).then_some((corner, ex, ey))
}
