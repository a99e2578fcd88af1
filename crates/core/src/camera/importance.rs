//! Cameras that receive: where on the film light from a point arrives, and how dense camera rays are there (Veach 1997,
//! 8.3.2: importance).
//!
//! The film is measured in pixels, so that the importance of a camera integrates to the number of pixels of the frame:
//! one camera ray for each.

use super::{Camera, Projection, swap_yz};
use crate::film::FilmSpec;
use std::f32::consts::{PI, TAU};
use steradian_math::{Ray, Vec2, Vec3, transform::Affine, warp};

/// A point of the scene as the camera sees it.
#[derive(Clone, Copy, Debug)]
pub struct Received {
    /// Place on the full frame, pixels; may lie beyond the frame by the filter's radius.
    pub at: Vec2,
    /// Unit direction from the point to the camera.
    pub to_camera: Vec3,
    /// Distance within which nothing may stand.
    pub distance: f32,
    /// Pixels per unit area at the point, across the direction.
    pub density: f32,
}

/// Density of camera rays about a ray.
#[derive(Clone, Copy, Debug)]
pub struct RayDensity {
    /// Pixels per steradian; of parallel rays per unit area across them.
    pub density: f32,
    /// Distance from where rays diverge to where this one starts.
    pub start: f32,
    /// True if rays through a point of the lens are parallel, so that their density does not fall with distance.
    pub is_parallel: bool,
}

impl Camera {
    /// True if the camera can be connected to light subpaths: all but spherical cameras with a lens, lenses of several
    /// elements, and meters.
    pub fn can_receive(&self) -> bool {
        match self.projection {
            Projection::Perspective | Projection::Orthographic => true,
            Projection::SphericalEqualArea | Projection::SphericalEquirectangular => self.lens_radius <= 0.0,
            Projection::Realistic(_) | Projection::Ray | Projection::Patch(..) | Projection::Own(_) => false,
        }
    }

    /// Film position at which light from `p` through a point of the lens (`u` in the unit square) arrives; `None` if it
    /// misses the film.
    pub fn receive(&self, film: &FilmSpec, p: Vec3, lens: Vec2) -> Option<Received> {
        let local = self.world_from_camera.inverse().point(p);
        // A point of the lens by the concentric map (Shirley and Chiu 1997).
        let lens = if self.lens_radius > 0.0 { warp::concentric_disk(lens) * self.lens_radius } else { Vec2::ZERO };
        let (eye, at) = self.on_film(film, local, lens)?;
        let (margin, frame) = (film.filter.radius(), size(film));
        if !(at.cmpge(-margin).all() && at.cmple(frame + margin).all()) {
            return None;
        }
        let towards = eye - local;
        // The part of the way that lies before the near plane.
        let seen = if self.near > 0.0 && towards.z < 0.0 { 1.0 + self.near / towards.z } else { 1.0 };
        let to = self.world_from_camera.vector(towards);
        let distance = to.length();
        if seen <= 0.0 || -towards.z > self.far || !(distance > 0.0 && distance.is_finite()) {
            return None;
        }
        let to_camera = to / distance;
        // Pixels per area at the point: density per solid angle over the squared distance.
        let d = self.density(film, -to_camera);
        let density = if d.is_parallel { d.density } else { d.density / (distance * distance) };
        (density > 0.0 && density.is_finite()).then_some(Received { at, to_camera, distance: distance * seen, density })
    }

    /// Raster position, in pixels on the full frame or beyond it, of a world point seen through the middle of the lens
    /// at a moment of the exposure; `None` behind the camera, and for lenses of several elements and meters, whose
    /// projection is not known.
    pub fn project(&self, film: &FilmSpec, p: Vec3, time: f32) -> Option<Vec2> {
        self.on_film(film, self.place_at(time).inverse().point(p), Vec2::ZERO).map(|(_, at)| at)
    }

    /// Film position of a point infinitely far away in a direction, as [`Self::project`] gives it; `None` also for
    /// parallel rays.
    pub fn project_direction(&self, film: &FilmSpec, direction: Vec3, time: f32) -> Option<Vec2> {
        if matches!(self.projection, Projection::Orthographic) {
            return None;
        }
        let local = self.place_at(time).inverse().vector(direction);
        self.on_film(film, local, Vec2::ZERO).map(|(_, at)| at)
    }

    /// Depth of a world point: its distance from the eye along the view axis at a moment of the exposure.
    pub fn along_axis(&self, p: Vec3, time: f32) -> f32 {
        let place = self.place_at(time);
        place.inverse().point(p).z * place.vector(Vec3::Z).length()
    }

    /// Depth at which a ray of the camera begins: that of the near plane, where its rays begin there.
    pub fn start_of(&self, ray: &Ray) -> f32 {
        let begins_near = !matches!(self.projection, Projection::Realistic(_) | Projection::Patch(..));
        if self.near > 0.0 && begins_near { self.along_axis(ray.origin, ray.time).max(0.0) } else { 0.0 }
    }

    /// Camera-to-world transform at a moment of the exposure.
    fn place_at(&self, time: f32) -> Affine {
        self.motion.as_ref().and_then(|motion| motion.at(time)).unwrap_or(self.world_from_camera)
    }

    /// Through which point in camera space a point there is seen by a point of the lens, and where on the frame or
    /// beyond it.
    fn on_film(&self, film: &FilmSpec, local: Vec3, lens: Vec2) -> Option<(Vec3, Vec2)> {
        Some(match self.projection {
            Projection::Perspective => {
                let d = local - lens.extend(0.0);
                if d.z <= 0.0 {
                    return None;
                }
                // Where the ray through this point of the lens meets the plane in focus, as window coordinates.
                let w = Vec2::new(d.x, d.y) / d.z + lens / self.focal_distance;
                (lens.extend(0.0), self.of_window(film, w))
            }
            Projection::Orthographic => {
                if local.z <= 0.0 {
                    return None;
                }
                // The same for parallel rays, whose lens shifts origins.
                let w = Vec2::new(local.x, local.y) - lens * (1.0 - local.z / self.focal_distance);
                ((w + lens).extend(0.0), self.of_window(film, w))
            }
            // Which way through the lens leads to a point is not known.
            Projection::Realistic(_) => return None,
            Projection::SphericalEqualArea => {
                let d = swap_yz(local.try_normalize()?);
                (Vec3::ZERO, warp::equal_area_sphere_to_square(d) * size(film))
            }
            Projection::SphericalEquirectangular => {
                let d = swap_yz(local.try_normalize()?);
                // Inverse of the ray's map by longitude and latitude.
                let phi = d.y.atan2(d.x);
                let s = Vec2::new((phi / TAU).rem_euclid(1.0), d.z.clamp(-1.0, 1.0).acos() / PI);
                (Vec3::ZERO, s * size(film))
            }
            Projection::Ray | Projection::Patch(..) | Projection::Own(_) => return None,
        })
    }

    /// Density of camera rays about one that [`Camera::ray`] gave.
    pub fn ray_density(&self, film: &FilmSpec, ray: &Ray) -> RayDensity {
        self.density(film, ray.direction)
    }

    /// About a unit direction in the world, away from the camera.
    fn density(&self, film: &FilmSpec, direction: Vec3) -> RayDensity {
        let long = self.world_from_camera.inverse().vector(direction);
        let d = long.normalize_or(Vec3::Z);
        let [x0, x1, y0, y1] = self.window;
        let per_window = (film.width as f32 * film.height as f32 / ((x1 - x0) * (y1 - y0))).abs();
        let pixels = film.width as f32 * film.height as f32;
        let in_camera = match self.projection {
            // dω = cos³θ dA on the plane z = 1: density per solid angle grows with 1/cos³θ.
            Projection::Perspective | Projection::Realistic(_) => per_window / d.z.powi(3),
            Projection::Orthographic => {
                let m = &self.world_from_camera;
                let window = m.vector(Vec3::X).cross(m.vector(Vec3::Y)).dot(direction).abs();
                return RayDensity { density: per_window / window, start: self.start(long), is_parallel: true };
            }
            // Of a projection of a program's own as if it saw all directions evenly.
            Projection::SphericalEqualArea | Projection::Own(_) => pixels / (4.0 * PI),
            // As if the pixels shared a square of a unit's side in camera space.
            Projection::Ray | Projection::Patch(..) => {
                let side = self.world_from_camera.vector(Vec3::X).length();
                return RayDensity { density: pixels / (side * side), start: 0.0, is_parallel: true };
            }
            Projection::SphericalEquirectangular => pixels / (TAU * PI * d.x.hypot(d.z).max(1e-6)),
        };
        // A scaled placement changes solid angles.
        let density = in_camera / self.world_from_camera.solid_angle(d);
        RayDensity { density, start: self.start(long), is_parallel: false }
    }

    /// Distance in the world to the near plane, along a direction in camera space that is one long in the world.
    fn start(&self, long: Vec3) -> f32 {
        if self.near > 0.0 && long.z > 0.0 { self.near / long.z } else { 0.0 }
    }

    /// Film coordinates of window coordinates.
    fn of_window(&self, film: &FilmSpec, w: Vec2) -> Vec2 {
        let [x0, x1, y0, y1] = self.window;
        Vec2::new((w.x - x0) / (x1 - x0), (y1 - w.y) / (y1 - y0)) * size(film)
    }
}

fn size(film: &FilmSpec) -> Vec2 {
    Vec2::new(film.width as f32, film.height as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Crop, Filter, FilterKind};
    use steradian_math::{DVec3, Transform, hash::HashRng};

    fn film() -> FilmSpec {
        FilmSpec {
            width: 40,
            height: 30,
            crop: Crop { x0: 0, y0: 0, x1: 40, y1: 30 },
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

    /// Every projection, with and without a lens, placed by a transform that turns, moves and scales.
    fn cameras() -> Vec<Camera> {
        let look = Transform::look_at(DVec3::new(1.0, 2.0, 3.0), DVec3::new(-1.0, 0.3, 0.2), DVec3::Y).unwrap();
        let place = look * Transform::scale(DVec3::new(1.5, 1.5, 2.0));
        let mut all = Vec::new();
        for projection in [
            Projection::Perspective,
            Projection::Orthographic,
            Projection::SphericalEquirectangular,
            Projection::SphericalEqualArea,
        ] {
            let planar = matches!(projection, Projection::Perspective | Projection::Orthographic);
            for lens_radius in [0.0, 0.2].into_iter().take(if planar { 2 } else { 1 }) {
                all.push(Camera {
                    motion: None,
                    projection: projection.clone(),
                    lens_radius,
                    near: if planar { 0.05 } else { 0.0 },
                    far: f32::INFINITY,
                    world_from_camera: place.affine().unwrap(),
                    window: [-0.8, 0.8, -0.6, 0.6],
                    focal_distance: 2.5,
                    medium: None,
                });
            }
        }
        all
    }

    /// Light that goes back along a camera ray arrives where the ray came from, with the density of camera rays.
    #[test]
    fn rays_are_received_where_they_started() {
        let film = film();
        let mut rng = HashRng::new(5);
        for camera in cameras() {
            for _ in 0..200 {
                let at = Vec2::new(rng.next_f32() * 40.0, rng.next_f32() * 29.0 + 0.5);
                let lens = Vec2::new(rng.next_f32(), rng.next_f32());
                let (ray, t) = (camera.ray(&film, at, lens), 0.2 + 3.0 * rng.next_f32());
                let seen = camera.receive(&film, ray.at(t), lens).expect("a point on a camera ray");
                let what = format!("{:?}, lens {}", camera.projection, camera.lens_radius);
                assert!((seen.at - at).length() < 5e-3, "{what}: {} for {at}", seen.at);
                assert!((seen.to_camera + ray.direction).length() < 1e-4, "{what}");
                assert!((seen.distance - t).abs() < 1e-3, "{what}: {} for {t}", seen.distance);
                let d = camera.ray_density(&film, &ray);
                let distance = t + d.start;
                let density = if d.is_parallel { d.density } else { d.density / (distance * distance) };
                assert!((seen.density / density - 1.0).abs() < 2e-3, "{what}: {} for {density}", seen.density);
            }
            assert!(camera.can_receive());
        }
        assert!(!Camera { lens_radius: 0.1, ..cameras().pop().unwrap() }.can_receive());
    }

    /// A point just before the plane `far` is received, and on a camera ray; one just beyond it is neither.
    #[test]
    fn nothing_is_seen_beyond_the_far_plane() {
        let film = film();
        let lens = Vec2::new(0.3, 0.6);
        for camera in cameras().into_iter().filter(|c| c.near > 0.0) {
            let camera = Camera { far: 1.7, ..camera };
            for at in [Vec2::new(20.0, 15.0), Vec2::new(3.0, 27.0)] {
                let ray = camera.ray(&film, at, lens);
                let axis = camera.world_from_camera.inverse().vector(ray.direction).z;
                let left = 1.7 - camera.world_from_camera.inverse().point(ray.origin).z;
                let what = format!("{:?}, lens {}", camera.projection, camera.lens_radius);
                assert!((ray.t_max - left / axis).abs() < 1e-4, "{what}: {}", ray.t_max);
                assert!(camera.receive(&film, ray.at(ray.t_max * 0.999), lens).is_some(), "{what}");
                assert!(camera.receive(&film, ray.at(ray.t_max * 1.001), lens).is_none(), "{what}");
            }
        }
    }

    /// The importance of a camera integrates to the pixels of its frame: over directions, and of parallel rays over a
    /// plane across them.
    #[test]
    fn importance_integrates_to_the_pixels() {
        let film = film();
        let mut rng = HashRng::new(8);
        for camera in cameras() {
            let lens = Vec2::new(0.3, 0.6);
            let (n, mut sum, mut squares) = (200_000, 0.0, 0.0);
            // A plane for parallel rays, a sphere around the point of the lens for all others.
            let center = camera.ray(&film, Vec2::new(20.0, 15.0), lens);
            for _ in 0..n {
                let u = Vec2::new(rng.next_f32(), rng.next_f32());
                let (p, area, cos) = if matches!(camera.projection, Projection::Orthographic) {
                    let frame = steradian_math::Frame::from_z(center.direction);
                    let q = (u * 2.0 - 1.0) * 3.0;
                    (center.at(2.0) + frame.x * q.x + frame.y * q.y, 36.0, 1.0)
                } else {
                    let d = camera.density(&film, center.direction);
                    let eye = center.at(-d.start);
                    (eye + warp::uniform_sphere(u) * 2.0, 16.0 * PI, 1.0)
                };
                let seen = camera.receive(&film, p, lens);
                let inside = |r: &Received| r.at.cmpge(Vec2::ZERO).all() && r.at.cmple(size(&film)).all();
                let v = f64::from(seen.filter(inside).map_or(0.0, |r| r.density * area * cos));
                sum += v;
                squares += v * v;
            }
            let mean = sum / f64::from(n);
            let sigma = ((squares / f64::from(n) - mean * mean) / f64::from(n)).sqrt();
            let what = format!("{:?}, lens {}", camera.projection, camera.lens_radius);
            assert!((mean - 1200.0).abs() < 4.0 * sigma + 0.5, "{what}: {mean} ± {sigma}");
        }
    }
}
