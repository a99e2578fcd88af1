//! Derivatives of camera rays with respect to the film position.

use super::{Camera, Projection};
use crate::{film::FilmSpec, footprint::RayDifferential};
use steradian_math::{Frame, Ray, Vec2, Vec3};

/// The smallest changes of ray origin and direction from one sample to its neighbours over the whole film, in frames
/// whose z axis is the ray (Pharr, Jakob, Humphreys, § 10.1.3), with the spacing of samples.
#[derive(Clone, Copy, Debug)]
pub struct ViewFootprint {
    /// Distance between samples in pixels: 1/√spp, and not below an eighth.
    pub spacing: f32,
    /// Change of the origin to the right and below.
    origin: [Vec3; 2],
    /// Change of the direction.
    direction: [Vec3; 2],
}

impl Camera {
    /// The derivatives of a camera ray with respect to its place on the film, for samples that are `spacing` pixels
    /// apart. They follow from the ray itself: its direction, or its origin, tells the place on the film.
    pub fn differential(&self, film: &FilmSpec, ray: &Ray, spacing: f32) -> Option<RayDifferential> {
        // Recover camera coordinates from the ray: its place on the film follows from them.
        let inverse = self.world_from_camera.inverse();
        let d = inverse.vector(ray.direction);
        let [x0, x1, y0, y1] = self.window;
        let step = Vec2::new((x1 - x0) / film.width as f32, (y0 - y1) / film.height as f32) * spacing;
        // In camera space, before directions are made unit.
        let (origin, direction) = match self.projection {
            // A lens of several elements changes its rays about as a thin one does.
            Projection::Perspective | Projection::Realistic(_) => {
                if d.z <= 0.0 {
                    return None;
                }
                // All rays through a point of the lens change alike; the length of `d` below is that of z = 1.
                ([Vec3::ZERO; 2], [Vec3::X * step.x, Vec3::Y * step.y])
            }
            Projection::Orthographic => {
                // What is in focus moves along with the origin, whatever the point of the lens.
                ([Vec3::X * step.x, Vec3::Y * step.y], [Vec3::ZERO; 2])
            }
            Projection::SphericalEquirectangular => {
                // Tangents along longitude and latitude at the direction.
                let up = d.normalize_or_zero();
                let (right, sin) = (Vec3::new(-up.z, 0.0, up.x), up.x.hypot(up.z));
                let down = Vec3::new(up.x * up.y, -sin * sin, up.z * up.y) / sin.max(1e-6);
                let step = Vec2::new(std::f32::consts::TAU, std::f32::consts::PI)
                    / Vec2::new(film.width as f32, film.height as f32)
                    * spacing;
                ([Vec3::ZERO; 2], [right * step.x, down * step.y])
            }
            Projection::Ray | Projection::Patch(..) | Projection::Own(_) => return None,
            Projection::SphericalEqualArea => {
                // Pixels have equal solid angles; their shape, which varies, is taken to be square.
                let side = (4.0 * std::f32::consts::PI / (film.width as f32 * film.height as f32)).sqrt() * spacing;
                let frame = Frame::from_z(d.normalize_or_zero());
                ([Vec3::ZERO; 2], [frame.x * side, frame.y * side])
            }
        };
        let scale = if self.is_planar() { d.z } else { d.length() };
        // The direction with the length that the changes are stated for.
        let long = d / scale;
        let near = if self.near > 0.0 && d.z > 0.0 { self.near } else { 0.0 };
        let world = |v: Vec3| self.world_from_camera.vector(v);
        let length = world(long).length();
        Some(RayDifferential {
            origin: std::array::from_fn(|k| world(origin[k] + direction[k] * near)),
            direction: direction.map(|v| {
                // Of the unit vector: the part across it.
                let v = world(v) / length;
                v - ray.direction * v.dot(ray.direction)
            }),
        })
    }

    /// True if window coordinates lie on a plane, so for all but the spherical projections.
    fn is_planar(&self) -> bool {
        !matches!(self.projection, Projection::SphericalEqualArea | Projection::SphericalEquirectangular)
    }

    /// The smallest differentials over the film, for `spp` samples per pixel.
    pub fn view_footprint(&self, film: &FilmSpec, spp: u32) -> ViewFootprint {
        const STEPS: u32 = 512;
        let spacing = (1.0 / (spp.max(1) as f32).sqrt()).max(0.125);
        let mut least = ViewFootprint {
            spacing,
            origin: [Vec3::splat(f32::INFINITY); 2],
            direction: [Vec3::splat(f32::INFINITY); 2],
        };
        // Scan the film for the least differentials, each axis by itself.
        let inverse = self.world_from_camera.inverse();
        for i in 0..STEPS {
            let s = (i as f32 + 0.5) / STEPS as f32;
            // Along the diagonal; of the whole sphere along the horizon, since pixels shrink to nothing at its poles.
            let row = if self.is_planar() { s } else { 0.5 };
            let ray = self.ray(film, Vec2::new(film.width as f32 * s, film.height as f32 * row), Vec2::splat(0.5));
            let Some(differential) = self.differential(film, &ray, spacing) else { continue };
            let frame = upright(inverse.vector(ray.direction).normalize_or_zero());
            for k in 0..2 {
                let shorten = |least: &mut Vec3, v: Vec3| {
                    let v = frame.to_local(inverse.vector(v));
                    if v.length_squared() < least.length_squared() {
                        *least = v;
                    }
                };
                shorten(&mut least.origin[k], differential.origin[k]);
                shorten(&mut least.direction[k], differential.direction[k]);
            }
        }
        for v in least.origin.iter_mut().chain(&mut least.direction).filter(|v| !v.is_finite()) {
            *v = Vec3::ZERO;
        }
        least
    }
}

/// The frame of a camera-space direction whose z axis it is and whose x axis lies level, so that frames of neighbours
/// agree.
fn upright(z: Vec3) -> Frame {
    match Vec3::new(z.z, 0.0, -z.x).try_normalize() {
        Some(x) => Frame { x, y: z.cross(x), z },
        None => Frame::from_z(z),
    }
}

impl ViewFootprint {
    /// The displacements on the tangent plane with normal `n` at `p`, as if the camera saw the point directly.
    #[inline]
    pub fn displacements(&self, camera: &Camera, p: Vec3, n: Vec3) -> [Vec3; 2] {
        let inverse = &camera.world_from_camera.inv;
        let view = inverse.transform_point3(p);
        let distance = view.length();
        let z = if distance > 0.0 { view / distance } else { return [Vec3::ZERO; 2] };
        let frame = upright(z);
        let n = frame.to_local(camera.world_from_camera.m.transpose().transform_vector3(n));
        std::array::from_fn(|k| {
            // The neighbour's ray from near the eye to the plane n·(q − p) = 0, with p at (0, 0, distance).
            let (o, d) = (self.origin[k], Vec3::Z + self.direction[k]);
            let t = (n.z * distance - n.dot(o)) / n.dot(d);
            let moved = o + d * t - Vec3::Z * distance;
            camera.world_from_camera.m.transform_vector3(frame.to_world(moved))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Crop, Filter, FilterKind};
    use steradian_math::{DVec3, Transform};

    fn film() -> FilmSpec {
        FilmSpec {
            width: 64,
            height: 48,
            crop: Crop { x0: 0, y0: 0, x1: 64, y1: 48 },
            filter: Filter::new(FilterKind::Box, Vec2::splat(0.5)).unwrap(),
            imaging_ratio: 1.0,
            bands: None,
            layers: &[],
            unit_luminance: 1.0,
            max_component: f32::INFINITY,
            response: None,
            sensor: None,
        }
    }

    fn cameras() -> Vec<Camera> {
        let place = Transform::look_at(DVec3::new(1.0, 2.0, 3.0), DVec3::new(-1.0, 0.3, 0.2), DVec3::Y).unwrap();
        let base = Camera {
            motion: None,
            projection: Projection::Perspective,
            world_from_camera: place.affine().unwrap(),
            window: [-0.8, 0.8, -0.6, 0.6],
            lens_radius: 0.0,
            focal_distance: 2.5,
            near: 0.01,
            far: f32::INFINITY,
            medium: None,
        };
        let mut all = Vec::new();
        for projection in [
            Projection::Perspective,
            Projection::Orthographic,
            Projection::SphericalEquirectangular,
            Projection::SphericalEqualArea,
        ] {
            // All directions through a lens are not a camera of any use.
            let planar = matches!(projection, Projection::Perspective | Projection::Orthographic);
            for lens_radius in [0.0, 0.2].into_iter().take(if planar { 2 } else { 1 }) {
                let near = if planar { 0.01 } else { 0.0 };
                all.push(Camera { projection: projection.clone(), lens_radius, near, ..base.clone() });
            }
        }
        all
    }

    /// M65: the differentials are those of neighbouring rays.
    #[test]
    fn differentials_are_finite_differences() {
        let film = film();
        for camera in cameras().iter().filter(|c| !matches!(c.projection, Projection::SphericalEqualArea)) {
            for pixel in [Vec2::new(31.0, 20.0), Vec2::new(3.5, 44.25), Vec2::new(60.0, 7.0)] {
                let lens = Vec2::new(0.3, 0.8);
                let ray = camera.ray(&film, pixel, lens);
                let seen = camera.differential(&film, &ray, 1.0).unwrap();
                for (k, step) in [Vec2::X, Vec2::Y].into_iter().enumerate() {
                    let h = 0.125;
                    let (a, b) = (camera.ray(&film, pixel - step * h, lens), camera.ray(&film, pixel + step * h, lens));
                    let (o, d) = ((b.origin - a.origin) / (2.0 * h), (b.direction - a.direction) / (2.0 * h));
                    let what = format!("{:?} lens {} {pixel} axis {k}", camera.projection, camera.lens_radius);
                    assert!((seen.direction[k] - d).length() < 2e-3 * d.length().max(1e-3), "{what}: {seen:?} {d}");
                    assert!((seen.origin[k] - o).length() < 2e-3 * o.length().max(1e-2), "{what}: {seen:?} {o}");
                }
            }
        }
    }

    /// The approximation agrees with the ray's own differential where that is the smallest, and nowhere exceeds it
    /// much.
    #[test]
    fn approximate_displacements_are_those_of_the_smallest_pixel() {
        let film = film();
        for camera in &cameras() {
            let view = camera.view_footprint(&film, 1);
            // Towards the poles of a sphere of longitudes and latitudes the approximation is too wide.
            let poles = matches!(camera.projection, Projection::SphericalEquirectangular);
            for pixel in [Vec2::new(32.0, 24.0), Vec2::new(5.0, 40.0)].into_iter().take(if poles { 1 } else { 2 }) {
                let ray = camera.ray(&film, pixel, Vec2::splat(0.5));
                let n = (-ray.direction + Vec3::new(0.3, 0.2, -0.1)).normalize();
                let t = 4.0;
                let exact = camera.differential(&film, &ray, 1.0).unwrap().transfer(ray.direction, t, n);
                let seen = view.displacements(camera, ray.at(t), n);
                for k in 0..2 {
                    // Tangent-plane displacements, of about the size of a pixel: those at the rim of a wide view are
                    // larger.
                    assert!(seen[k].dot(n).abs() < 1e-3 * seen[k].length(), "{:?}", camera.projection);
                    let ratio = seen[k].length() / exact[k].length();
                    assert!((0.25..1.3).contains(&ratio), "{:?} {pixel} {k}: {ratio}", camera.projection);
                }
            }
        }
        let camera = &cameras()[0];
        let (one, many) = (camera.view_footprint(&film, 1), camera.view_footprint(&film, 16));
        assert!((many.direction[0] * 4.0 - one.direction[0]).length() < 1e-6);
        assert_eq!(camera.view_footprint(&film, 4096).spacing, 0.125);
    }
}
