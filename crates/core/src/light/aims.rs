//! Aims of emission: spheres at which rays from lights are aimed, since most light of a sun or of a lamp in the open
//! lands where nobody looks (Peter, Pietrek 1998, "Importance Driven Construction of Photon Maps", draw emission by
//! importance too).
//!
//! Three kinds of spheres have a share of the rays each: one around all that does not shine, some around what the
//! camera sees, and some around what focuses light. The rest is drawn as the light is bright. From a point p, the
//! directions to a sphere are a cone of solid angle Ω, and the density is the mixture
//!
//! `p(ω) = c₀ p_light(ω) + Σₖ cₖ [ω in cone k] / Ωₖ(p)`
//!
//! where spheres around p leave their share to the light. Parallel light passes the disk of a sphere's outline:
//! `[ray meets disk k] / (π rₖ²)`. The light of a scene does not depend on its aims, its noise does.

use crate::{
    Scene,
    material::{Material, Model, Roughness},
};
use std::f32::consts::PI;
use steradian_math::{Bounds3, Frame, Vec2, Vec3, warp};
use steradian_texture::FloatTexture;

/// Roughness α above which metals and glass do not focus.
pub const BROAD: f32 = 0.25;
/// Shares of rays aimed at what focuses light, at what the camera sees where it is a small part of the scene, and at
/// all that does not shine.
const SHARES: [f32; 3] = [0.3, 0.3, 0.3];
/// Most spheres of a kind.
const MOST: usize = 8;
/// Edge of the grid of camera rays.
const EDGE: u32 = 24;
/// The largest part of the scene's outline at which the visible part is an aim.
const SEEN: f32 = 0.25;

/// A sphere and its share of the rays.
#[derive(Clone, Copy, Debug)]
struct Aim {
    center: Vec3,
    radius: f32,
    share: f32,
}

/// Spheres at which rays from lights are aimed; the last one is that around all that does not shine.
#[derive(Clone, Debug, Default)]
pub(super) struct Aims(Vec<Aim>);

impl Aims {
    /// The aims of a scene; none where planes or media without end receive light everywhere.
    pub fn new(scene: &Scene) -> Self {
        if !scene.planes().is_empty() || scene.camera().medium.is_some() {
            return Self::default();
        }
        let dark = bounds(scene, |g| g.emitter.is_none());
        let whole = dark.iter().fold(Bounds3::EMPTY, |all, b| all.union(*b));
        if whole.is_empty() {
            return Self::default();
        }
        let is_small = |parts: &[Bounds3]| {
            let outline = |b: Bounds3| b.bounding_sphere().1.powi(2);
            let union = parts.iter().fold(Bounds3::EMPTY, |all, b| all.union(*b));
            outline(union) < SEEN * outline(whole)
        };
        let seen = clusters(seen(scene));
        let seen = if is_small(&seen) { seen } else { Vec::new() };
        let kinds = [clusters(focusing(scene)), seen, vec![whole]];
        let of_kind = |(boxes, share): (Vec<Bounds3>, f32)| {
            let share = share / boxes.len().max(1) as f32;
            boxes.into_iter().map(move |b| {
                let (center, radius) = b.bounding_sphere();
                Aim { center, radius: radius * 1.001, share }
            })
        };
        let is_finite = |aim: &Aim| aim.center.is_finite() && aim.radius.is_finite() && aim.radius > 0.0;
        Self(kinds.into_iter().zip(SHARES).flat_map(of_kind).filter(is_finite).collect())
    }

    /// The share of light sent to one half of all directions from a point that may meet what does not shine; 1 near it.
    pub fn reached(&self, p: Vec3) -> f32 {
        self.0.last().and_then(|whole| whole.cone(p)).map_or(1.0, |(_, opening)| opening)
    }

    /// A direction from a point, by a number that chooses the aim; `None` where the light itself is to draw it.
    pub fn direction(&self, p: Vec3, u: f32, u2: Vec2) -> Option<Vec3> {
        let (axis, opening) = self.choose(u)?.cone(p)?;
        Some(Frame::from_z(axis).to_world(warp::uniform_cone(u2, opening)))
    }

    /// Density of directions from a point, where the light's own is `own`.
    pub fn pdf(&self, p: Vec3, w: Vec3, own: f32) -> f32 {
        let mut of_light = 1.0;
        let mut pdf = 0.0;
        for aim in &self.0 {
            let Some((axis, opening)) = aim.cone(p) else { continue };
            of_light -= aim.share;
            // sin²θ = |ω × axis|², and sin²α = x(2 − x) with x = 1 − cosα: exact for the smallest cones too.
            if axis.dot(w) > 0.0 && axis.cross(w).length_squared() <= opening * (2.0 - opening) {
                pdf += aim.share * warp::uniform_cone_pdf(opening);
            }
        }
        pdf + of_light * own
    }

    /// Centre and radius of the disk across a direction that parallel light is sent through, by a number that chooses
    /// the aim; `None` for the disk of the whole scene.
    pub fn disk(&self, u: f32) -> Option<(Vec3, f32)> {
        self.choose(u).map(|aim| (aim.center, aim.radius))
    }

    /// Density over the plane across a direction of parallel rays through a point, where that of the disk of the whole
    /// scene is `own`.
    pub fn disk_pdf(&self, p: Vec3, w: Vec3, own: f32) -> f32 {
        let mut of_light = 1.0;
        let mut pdf = 0.0;
        for aim in &self.0 {
            of_light -= aim.share;
            if (p - aim.center).cross(w).length_squared() <= aim.radius * aim.radius {
                pdf += aim.share / (PI * aim.radius * aim.radius);
            }
        }
        pdf + of_light * own
    }

    fn choose(&self, u: f32) -> Option<&Aim> {
        let mut sum = 0.0;
        self.0.iter().find(|aim| {
            sum += aim.share;
            u < sum
        })
    }
}

impl Aim {
    /// Axis of the cone of directions from a point to the sphere, and 1 − cosα of its half-angle; `None` from within
    /// or close by.
    fn cone(&self, p: Vec3) -> Option<(Vec3, f32)> {
        let to = self.center - p;
        let d2 = to.length_squared();
        // sin²α = r²/d².
        let sin2 = self.radius * self.radius / d2;
        (sin2 < 0.9 && sin2 > 1e-12).then(|| (to / d2.sqrt(), sin2 / (1.0 + (1.0 - sin2).sqrt())))
    }
}

/// Boxes of the points that a grid of camera rays meets first.
fn seen(scene: &Scene) -> Vec<Bounds3> {
    let film = scene.film();
    let size = Vec2::new(film.width as f32, film.height as f32);
    let met = |k: u32| {
        let place = Vec2::new((k % EDGE) as f32 + 0.5, (k / EDGE) as f32 + 0.5) / EDGE as f32;
        let ray = scene.camera().ray(film, place * size, Vec2::splat(0.5));
        let hit = ray.is_valid().then(|| scene.intersect(&ray)).flatten()?;
        Some(Bounds3::from_points([ray.at(hit.t)]))
    };
    (0..EDGE * EDGE).filter_map(met).collect()
}

/// Boxes of the shapes in the world whose materials may send light on in narrow bundles.
pub fn focusing(scene: &Scene) -> Vec<Bounds3> {
    let focuses = focusing_materials(scene.materials());
    bounds(scene, |g| focuses[g.material as usize] && !g.is_interface)
}

/// Boxes of the shapes in the world, placed, that a condition holds for.
fn bounds(scene: &Scene, is_meant: impl Fn(&crate::scene::Geometry) -> bool) -> Vec<Bounds3> {
    let boxes: Vec<Option<Bounds3>> =
        scene.geometries().iter().map(|g| is_meant(g).then(|| g.shape.bounds())).collect();
    let of = |first: u32, count: u32| boxes[first as usize..][..count as usize].iter().flatten();
    let mut bounds: Vec<Bounds3> = of(0, scene.world_count()).copied().collect();
    for place in scene.placements() {
        let placed = |b: &Bounds3| Bounds3::from_points((0..8).map(|i| place.world_from_group.point(b.corner(i))));
        bounds.extend(of(place.base, place.count).map(placed));
    }
    bounds.retain(|b| !b.is_empty() && b.diagonal().is_finite() && b.area() > 0.0);
    bounds
}

/// Boxes around parts of the boxes, some to each: halves by the median along the longest edge.
fn clusters(boxes: Vec<Bounds3>) -> Vec<Bounds3> {
    fn split(boxes: &mut [Bounds3], most: usize, out: &mut Vec<Bounds3>) {
        let all = boxes.iter().fold(Bounds3::EMPTY, |all, b| all.union(*b));
        if most == 1 || boxes.len() < 2 {
            out.extend((!all.is_empty()).then_some(all));
            return;
        }
        let d = all.diagonal();
        let axis = (0..3).max_by(|a, b| d[*a].total_cmp(&d[*b])).unwrap_or(0);
        boxes.sort_by(|a, b| a.center()[axis].total_cmp(&b.center()[axis]));
        let (low, high) = boxes.split_at_mut(boxes.len() / 2);
        split(low, most / 2, out);
        split(high, most / 2, out);
    }
    let (mut boxes, mut out) = (boxes, Vec::new());
    split(&mut boxes, MOST, &mut out);
    out
}

/// Flags for the materials that may send light on in narrow bundles.
fn focusing_materials(materials: &[Material]) -> Vec<bool> {
    let is_narrow = |r: &Roughness| match (r.u, r.v) {
        (FloatTexture::Constant(u), FloatTexture::Constant(v)) => {
            let alpha = (u * v).max(0.0).sqrt();
            (if r.remap { alpha.sqrt() } else { alpha }) <= BROAD
        }
        _ => true,
    };
    let mut focuses: Vec<bool> = Vec::with_capacity(materials.len());
    for material in materials {
        focuses.push(match &material.model {
            Model::Conductor { roughness, .. }
            | Model::ConductorReflectance(_, roughness)
            | Model::Mirror(_, roughness)
            | Model::Dielectric { roughness, .. } => is_narrow(roughness),
            Model::ThinDielectric { .. } | Model::Pbr(_) | Model::Principled(_) => true,
            // Wrappers refer to materials with smaller indices.
            Model::Mix(a, b, _) | Model::TwoSided(a, b) => focuses[*a as usize] || focuses[*b as usize],
            _ => false,
        });
    }
    focuses
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Eta;
    use steradian_math::spectra::role::Color;
    use steradian_texture::SpectrumTexture;

    /// Mixtures of mixtures are looked at once each.
    #[test]
    fn mixtures_focus_as_their_parts_do() {
        let material = |model| Material::new(model, false);
        for focuses in [false, true] {
            let white = SpectrumTexture::Constant(Color::constant(1.0));
            let first = if focuses {
                Model::ThinDielectric { eta: Eta::Constant(1.5), reflectance: white.clone(), transmittance: white }
            } else {
                Model::Diffuse(white)
            };
            let mut materials = vec![material(first)];
            materials.extend((0..100).map(|i| material(Model::Mix(i, i, FloatTexture::Constant(0.5)))));
            assert_eq!(focusing_materials(&materials), vec![focuses; 101]);
        }
    }

    fn aims() -> Aims {
        let aim = |x: f32, radius: f32, share: f32| Aim { center: Vec3::new(x, 0.3, -0.2), radius, share };
        Aims(vec![aim(2.0, 0.5, 0.3), aim(-1.0, 0.8, 0.25), aim(0.0, 1e-3, 0.15)])
    }

    /// Directions are aimed as often as the spheres that do not contain the point have shares, and their density is
    /// that of all aims: the mean of its reciprocal is the solid angle of these spheres, which hide no part of each
    /// other.
    #[test]
    fn directions_are_drawn_by_their_density() {
        let aims = aims();
        for p in [Vec3::new(0.2, 1.5, 0.4), Vec3::new(-1.0, 0.9, -0.2), Vec3::new(0.0, 40.0, 1.0)] {
            let mut rng = steradian_math::hash::HashRng::new(7);
            let (mut aimed, mut solid_angle, n) = (0.0_f64, 0.0_f64, 20_000);
            for _ in 0..n {
                let (u, u2) = (rng.next_f32(), Vec2::new(rng.next_f32(), rng.next_f32()));
                let Some(w) = aims.direction(p, u, u2) else { continue };
                let pdf = aims.pdf(p, w, 0.0);
                assert!(pdf > 0.0 && (w.length() - 1.0).abs() < 1e-5);
                aimed += 1.0 / f64::from(n);
                solid_angle += 1.0 / f64::from(pdf) / f64::from(n);
            }
            let cones: Vec<(f32, f32)> =
                aims.0.iter().filter_map(|aim| Some((aim.share, 2.0 * PI * aim.cone(p)?.1))).collect();
            let shares: f32 = cones.iter().map(|cone| cone.0).sum();
            let expected: f32 = cones.iter().map(|cone| cone.1).sum();
            assert!((aimed - f64::from(shares)).abs() < 0.015, "{p}: {aimed} {shares}");
            assert!((solid_angle / f64::from(expected) - 1.0).abs() < 0.03, "{p}: {solid_angle} {expected}");
            // Away from all spheres the light's own density is left.
            assert!((aims.pdf(p, Vec3::Y, 2.0) - 2.0 * (1.0 - shares)).abs() < 1e-5, "{p}");
        }
    }

    /// Each sphere's cone and disk have its share: counted by rays drawn with uniform densities.
    #[test]
    fn densities_integrate_to_one() {
        let aims = Aims(aims().0.into_iter().take(2).collect());
        let mut rng = steradian_math::hash::HashRng::new(5);
        let mut numbers = || Vec2::new(rng.next_f32(), rng.next_f32());
        let p = Vec3::new(0.2, 1.5, 0.4);
        let n = 200_000;
        let uniform = 0.25 / PI;
        let (mut sum, mut across) = (0.0_f64, 0.0_f64);
        let (w, radius) = (Vec3::new(0.6, -0.64, 0.48), 4.0_f32);
        let (frame, own) = (Frame::from_z(w), 1.0 / (PI * radius * radius));
        for _ in 0..n {
            sum += f64::from(aims.pdf(p, warp::uniform_sphere(numbers()), uniform) / uniform) / f64::from(n);
            let d = warp::concentric_disk(numbers()) * radius;
            across += f64::from(aims.disk_pdf(frame.x * d.x + frame.y * d.y, w, own) / own) / f64::from(n);
        }
        assert!((sum - 1.0).abs() < 0.01 && (across - 1.0).abs() < 0.01, "{sum} {across}");
    }
}
