//! What passes know of a surface that a pixel sees, and where it was in the frame before.

use super::filter::Filters;
use crate::projection::Projected;
use std::sync::Arc;
use steradian_core::{
    Scene,
    scene::{Hit, Interaction, Shape},
};
use steradian_engine::albedo;
use steradian_math::{Vec2, Vec3, geometry::barycentric, spectra::Wavelengths, transform::Affine};

/// Albedos are taken for at least this, so that light over albedo is finite.
const LEAST_ALBEDO: f32 = 1e-3;

/// A surface that a pixel sees.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Where the pixel's ray meets it.
    pub hit: Hit,
    /// Distance from the eye along the axis of the view, and how much more it is a pixel to the right, and below.
    pub depth: f32,
    pub gradient: Vec2,
    /// The shading normal.
    pub normal: Vec3,
    /// The part of white light that it sends back, at least a little.
    pub albedo: Vec3,
    /// Tells objects apart.
    pub object: u32,
    /// Where it was in the frame before; `None` where there was none, or it was not in front.
    pub before: Option<Place>,
}

/// Where a point is on a frame.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// In pixels from the corner of the picture.
    pub at: Vec2,
    /// Along the axis of the view.
    pub depth: f32,
}

impl Surface {
    /// Light over albedo.
    pub fn over_albedo(&self, light: Vec3) -> Vec3 {
        light / self.albedo
    }
}

/// The surface that a pixel sees, at a hit of its ray.
pub fn surface(
    scene: &Scene,
    (projected, pixel): (&Projected, [u32; 2]),
    hit: Hit,
    lambda: &Wavelengths,
    before: Option<&Before>,
) -> Option<Surface> {
    let ray = projected.ray(scene, pixel);
    let i = scene.interaction(&ray, &hit);
    let (albedo, frame) = albedo(scene, &i, lambda)?;
    let depth = projected.along_axis(i.surface.p);
    // Where the ray of the pixel beside meets the tangent plane.
    let beside = |[x, y]: [u32; 2]| {
        let ray = projected.ray(scene, [pixel[0] + x, pixel[1] + y]);
        let t = (i.surface.p - ray.origin).dot(i.surface.n) / ray.direction.dot(i.surface.n);
        projected.along_axis(ray.at(t)) - depth
    };
    Some(Surface {
        hit,
        depth,
        gradient: Vec2::new(beside([1, 0]), beside([0, 1])),
        normal: frame.z,
        albedo: albedo.max(Vec3::splat(LEAST_ALBEDO)),
        // Placements of a group are objects of their own.
        object: i.geometry ^ hit.id.instance.wrapping_add(1).wrapping_mul(0x9e37_79b9),
        before: before.and_then(|before| before.place(scene, &i)),
    })
}

/// The frame before.
#[derive(Clone, Debug)]
pub struct Before {
    /// What it showed.
    pub scene: Arc<Scene>,
    /// And how.
    pub projected: Projected,
    /// What remembers it.
    pub filters: Filters,
}

impl Before {
    /// Where on that frame the point of a surface was.
    pub fn place(&self, scene: &Scene, i: &Interaction) -> Option<Place> {
        let p = self.position(scene, i);
        let (clip, film) = (self.projected.clip(p), self.scene.film());
        let share = Vec2::new(clip.x, -clip.y) / clip.w * 0.5 + 0.5;
        let at = share * Vec2::new(film.width as f32, film.height as f32);
        let at = at - Vec2::new(film.crop.x0 as f32, film.crop.y0 as f32);
        let depth = self.projected.along_axis(p);
        (clip.w > 0.0 && at.is_finite() && depth > 0.0).then_some(Place { at, depth })
    }

    /// Where the point was: points of meshes that have the same triangles are known by these, others by the place of
    /// their group.
    fn position(&self, scene: &Scene, i: &Interaction) -> Vec3 {
        let place =
            |of: &Scene| of.placements().get(i.id.instance as usize).map_or(Affine::IDENTITY, |p| p.world_from_group);
        let local = place(scene).inverse().point(i.surface.p);
        let corners = |of: &Scene| {
            let Shape::Mesh(mesh) = &of.geometries().get(i.geometry as usize)?.shape else { return None };
            ((i.id.prim as usize) < mesh.triangles.len()).then(|| mesh.corners(i.id.prim))
        };
        let local = match (corners(scene), corners(&self.scene)) {
            (Some(now), Some(then)) if now != then => moved(local, now, then),
            _ => local,
        };
        place(&self.scene).point(local)
    }
}

/// A point in the plane of a triangle, at its barycentric coordinates in another triangle.
fn moved(p: Vec3, now: [Vec3; 3], then: [Vec3; 3]) -> Vec3 {
    match barycentric::triangle_3d(now.map(Vec3::as_dvec3), p.as_dvec3()) {
        Some([a, b, c]) => then[0] * a as f32 + then[1] * b as f32 + then[2] * c as f32,
        None => p,
    }
}
