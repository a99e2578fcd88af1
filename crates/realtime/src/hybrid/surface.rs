//! Surface that a pixel sees, as the passes know it, and its position in the frame before.

use super::filter::Filters;
use crate::projection::Projected;
use std::sync::Arc;
use steradian_core::{
    Scene,
    scene::{Hit, Interaction},
};
use steradian_engine::albedo;
use steradian_math::{Vec2, Vec3, spectra::Wavelengths};

/// Albedos are taken for at least this, so that light over albedo is finite.
const LEAST_ALBEDO: f32 = 1e-3;

/// A surface that a pixel sees.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Hit of the pixel's ray.
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
    /// Position in the frame before; `None` where there was none, or it was not in front.
    pub before: Option<Place>,
}

/// Position of a point in a frame.
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
    /// Its scene.
    pub scene: Arc<Scene>,
    /// And how.
    pub projected: Projected,
    /// Denoisers with its history.
    pub filters: Filters,
}

impl Before {
    /// Position of a surface point in that frame.
    pub fn place(&self, scene: &Scene, i: &Interaction) -> Option<Place> {
        // The same point of the surface, in the scene of the frame before, through its camera: the motion vector of
        // temporal accumulation.
        let p = scene.position_in(&self.scene, i);
        let (clip, film) = (self.projected.clip(p), self.scene.film());
        let share = Vec2::new(clip.x, -clip.y) / clip.w * 0.5 + 0.5;
        let at = share * Vec2::new(film.width as f32, film.height as f32);
        let at = at - Vec2::new(film.crop.x0 as f32, film.crop.y0 as f32);
        let depth = self.projected.along_axis(p);
        (clip.w > 0.0 && at.is_finite() && depth > 0.0).then_some(Place { at, depth })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::{DVec3, Transform};
    use steradian_scene::{Family, Node, SceneDesc, Shape};

    /// A ball that is placed, before a camera in a place.
    fn scene(eye: DVec3) -> Arc<Scene> {
        let mut desc = SceneDesc::default();
        let film = Node::new(Family::Film, "rgb", None).with("width", 48_i64).with("height", 32_i64);
        desc.film = Some(desc.add(film));
        let place = Transform::look_at(eye, DVec3::new(0.2, 0.1, 0.0), DVec3::Y).expect("a place");
        let camera = Node::new(Family::Camera, "perspective", None).with("fov", 50.0).with("to_world", place);
        desc.cameras = vec![desc.add(camera)];
        let (shape, material) =
            (Node::new(Family::Shape, "sphere", None), Node::new(Family::Material, "diffuse", None));
        let (node, material) = (desc.add(shape), desc.add(material));
        desc.shapes.push(Shape { material: Some(material), ..Shape::new(node) });
        Arc::new(steradian_compile::compile(&desc, &Default::default()).scene.expect("a scene"))
    }

    /// Places on the frame before, by the projection to clip space, are those that the motion of layers tells.
    #[test]
    fn places_are_those_of_the_layer_of_motion() {
        let [then, now] = [DVec3::new(0.0, 0.0, -3.5), DVec3::new(0.3, -0.2, -3.1)].map(scene);
        let project = |scene: &Scene| Projected::new(scene, Vec2::splat(0.5)).expect("a projection");
        let (projected, filters) = (project(&now), Filters::new().expect("filters"));
        let before = Before { projected: project(&then), scene: then, filters };
        let (mut count, mut largest) = (0, 0.0_f32);
        for pixel in (0..32).flat_map(|y| (0..48).map(move |x| [x, y])) {
            let ray = projected.ray(&now, pixel);
            let Some(hit) = now.intersect(&ray) else { continue };
            let i = now.interaction(&ray, &hit);
            let place = before.place(&now, &i).expect("it was in front");
            let moved = now.moved_since(&before.scene, &i).expect("it was in front");
            let at = Vec2::new(pixel[0] as f32 + 0.5, pixel[1] as f32 + 0.5);
            assert!((at - place.at - moved.pixels).length() < 1e-3, "{place:?} {moved:?} at {at}");
            let deeper = projected.along_axis(i.surface.p) - place.depth;
            assert!((deeper - moved.depth).abs() < 1e-4, "{place:?} {moved:?}");
            (count, largest) = (count + 1, largest.max(moved.pixels.length()));
        }
        assert!(count > 200 && largest > 2.0, "{count} {largest}");
    }
}
