//! Positions of surface points in the scene of another frame of an animation.

use super::{Interaction, Scene, Shape};
use steradian_math::{Ray, Vec2, Vec3, geometry::barycentric, transform::Affine};

/// Motion of a point since the frame before.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moved {
    /// On the screen, in pixels: x to the right, y down.
    pub pixels: Vec2,
    /// Away from the camera along its axis.
    pub depth: f32,
}

impl Scene {
    /// Position of a surface point in an earlier scene of the same animation, at the same moment of the exposure:
    /// points of meshes with equal triangle counts are tracked by their triangle, others by the transform of their
    /// group.
    pub fn position_in(&self, earlier: &Self, i: &Interaction) -> Vec3 {
        let place = |of: &Self| of.placements().get(i.id.instance as usize).map_or(Affine::IDENTITY, |p| p.at(i.time));
        let (now, then) = (place(self), place(earlier));
        let corners = |of: &Self| {
            let Shape::Mesh(mesh) = &of.geometries().get(i.geometry as usize)?.shape else { return None };
            let triangles = mesh.triangles.len();
            ((i.id.prim as usize) < triangles).then(|| (mesh.corners(i.id.prim), triangles))
        };
        let moves = match (corners(self), corners(earlier)) {
            (Some((now, count)), Some((then, other))) if count == other && now != then => Some((now, then)),
            _ => None,
        };
        // What stands still has the same bits.
        if moves.is_none() && now.m == then.m {
            return i.surface.p;
        }
        let local = now.inverse().point(i.surface.p);
        then.point(moves.map_or(local, |(now, then)| moved(local, now, then)))
    }

    /// Motion of a surface point since an earlier frame of the same animation; `None` if one of the two cameras does
    /// not see in its direction, or has no projection to a plane or sphere.
    pub fn moved_since(&self, earlier: &Self, i: &Interaction) -> Option<Moved> {
        if self.origin() != earlier.origin() {
            return None;
        }
        let before = self.position_in(earlier, i);
        let [(at, depth), (at_before, depth_before)] = [(self, i.surface.p), (earlier, before)].map(|(scene, p)| {
            let camera = scene.camera();
            (camera.project(scene.film(), p, i.time), camera.along_axis(p, i.time))
        });
        let pixels = self.shortest(at? - at_before?);
        pixels.is_finite().then_some(Moved { pixels, depth: depth - depth_before })
    }

    /// Motion of a point infinitely far along a ray since an earlier frame, by the turn of the camera alone; `None` if
    /// it is not known.
    pub fn far_moved_since(&self, earlier: &Self, ray: &Ray) -> Option<Moved> {
        let [at, before] = [self, earlier].map(|s| s.camera().project_direction(s.film(), ray.direction, ray.time));
        let pixels = self.shortest(at? - before?);
        pixels.is_finite().then_some(Moved { pixels, depth: 0.0 })
    }

    /// A way on the frame; where the frame is all around, the shorter one of the two.
    fn shortest(&self, way: Vec2) -> Vec2 {
        if !matches!(self.camera().projection, crate::camera::Projection::SphericalEquirectangular) {
            return way;
        }
        let width = self.film().width as f32;
        Vec2::new(way.x - width * (way.x / width).round(), way.y)
    }
}

/// A point in the plane of a triangle, at its barycentric coordinates in another triangle.
fn moved(p: Vec3, now: [Vec3; 3], then: [Vec3; 3]) -> Vec3 {
    match barycentric::triangle_3d(now.map(Vec3::as_dvec3), p.as_dvec3()) {
        Some([a, b, c]) => then[0] * a as f32 + then[1] * b as f32 + then[2] * c as f32,
        None => p,
    }
}
