//! Cameras: from a point on the film to a ray. Camera space has +x to the right, +y up and +z forward.
//!
//! A camera moves as objects do, by a transform that is a function of the ray's time. The share of radiance that a lens
//! of several elements (`lens`) lets through is a factor on the filter weight of the sample (`Camera::sample`).

mod differentials;
pub mod importance;
mod lens;
mod own;
mod patch;

pub use differentials::ViewFootprint;
pub use lens::{DOUBLE_GAUSS, LensElement, LensSystem, Stop};
pub use own::OwnCamera;
pub use patch::Patch;

use crate::film::FilmSpec;
use std::sync::Arc;
use steradian_math::{Motion, Ray, Vec2, Vec3, spectra::Wavelengths, transform::Affine, warp};

/// Projection of the film: the mapping from film positions to directions.
#[derive(Clone, Debug)]
pub enum Projection {
    /// Through a point: window coordinates are tangents.
    Perspective,
    /// Parallel: window coordinates are positions.
    Orthographic,
    /// All directions, by the equal-area octahedral map.
    SphericalEqualArea,
    /// All directions, by longitude and latitude.
    SphericalEquirectangular,
    /// Through a lens of several elements: window coordinates are tangents of the pinhole that its thin lens would be.
    /// The film is in the plane z = 0, and units of camera space are metres.
    Realistic(Arc<LensSystem>),
    /// One ray, from the origin along the axis, for every place on the film.
    Ray,
    /// Light that arrives on a patch, on its inner side if so. Points of the lens, whose radius is above zero, are
    /// directions: as dense as their cosine with the normal, so that π times the mean radiance is the irradiance.
    Patch(Patch, bool),
    /// A projection of a program's own.
    Own(Arc<dyn OwnCamera>),
}

/// A camera.
#[derive(Clone, Debug)]
pub struct Camera {
    /// Mapping from film positions to directions.
    pub projection: Projection,
    /// Places camera space in the world, as the shutter opens.
    pub world_from_camera: Affine,
    /// Motion while the shutter is open.
    pub motion: Option<Arc<Motion>>,
    /// Window on the plane z = 1 that the frame covers: x0, x1 (left to right), y0, y1 (bottom to top).
    pub window: [f32; 4],
    /// Radius of the thin lens, or of the stop of a lens of several elements; zero for a pinhole.
    pub lens_radius: f32,
    /// Distance of the plane in focus.
    pub focal_distance: f32,
    /// Distance from the eye, along the axis, where rays start.
    pub near: f32,
    /// Distance from the eye, along the axis, where rays end, and the background is seen; infinite where they do not.
    pub far: f32,
    /// Index of the medium the camera is in.
    pub medium: Option<u32>,
}

/// Extent of the frame that an angle of view spans.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FovAxis {
    /// The width.
    X,
    /// The height.
    Y,
    /// The shorter of both.
    Smaller,
    /// The longer of both.
    Larger,
    /// Corner to corner.
    Diagonal,
}

impl FovAxis {
    /// By name.
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "x" => Self::X,
            "y" => Self::Y,
            "smaller" => Self::Smaller,
            "larger" => Self::Larger,
            "diagonal" => Self::Diagonal,
            _ => return None,
        })
    }

    /// Half extents (x, y) of the window on z = 1 for a full angle of view in radians and an aspect (width over
    /// height).
    pub fn half_window(self, fov: f32, aspect: f32) -> Vec2 {
        // Window of half height tan(fov/2) on z = 1.
        let t = (fov * 0.5).tan();
        match self {
            Self::X => Vec2::new(t, t / aspect),
            Self::Y => Vec2::new(t * aspect, t),
            Self::Smaller => if aspect >= 1.0 { Self::Y } else { Self::X }.half_window(fov, aspect),
            Self::Larger => if aspect >= 1.0 { Self::X } else { Self::Y }.half_window(fov, aspect),
            Self::Diagonal => {
                // The diagonal of the window subtends the angle.
                let height = t / (1.0 + aspect * aspect).sqrt();
                Vec2::new(height * aspect, height)
            }
        }
    }
}

/// A perspective camera without lens and motion: what makes a ray of a point on the film.
#[derive(Clone, Copy, Debug)]
pub struct Pinhole {
    size: [f32; 2],
    window: [f32; 4],
    near: f32,
    view: View,
    /// Columns of the matrix that places it, the last of them its place.
    place: [Vec3; 4],
}

/// The width, in radians, of the cone of directions that [`Projection::Ray`] takes.
const ACCEPTANCE: f32 = 1e-6;

/// The view between the planes at [`Camera::near`] and [`Camera::far`].
#[derive(Clone, Copy, Debug)]
struct View {
    /// Distance from plane to plane; infinite without a far plane.
    depth: f32,
    /// Gradient of depth in camera space over positions in the world.
    axis: Vec3,
}

impl View {
    /// Ray parameter at the far plane, for a ray from the near plane in a unit direction.
    #[inline(always)]
    fn end(&self, direction: Vec3) -> f32 {
        let advance = self.axis.dot(direction);
        if self.depth < f32::INFINITY && advance > 0.0 { self.depth / advance } else { f32::INFINITY }
    }
}

impl Pinhole {
    /// `t_max` of a ray in a unit direction, with the bits of [`Camera::ray`].
    #[inline(always)]
    pub fn end(&self, direction: Vec3) -> f32 {
        self.view.end(direction)
    }

    /// Origin and unit direction of the ray through a point of the full frame, with the bits of [`Camera::ray`].
    #[inline(always)]
    pub fn ray(&self, pixel: Vec2) -> (Vec3, Vec3) {
        // Film to window coordinates: linear, with y up.
        let s = Vec2::new(pixel.x / self.size[0], pixel.y / self.size[1]);
        let [x0, x1, y0, y1] = self.window;
        let d = Vec3::new(x0 + (x1 - x0) * s.x, y1 - (y1 - y0) * s.y, 1.0);
        let vector = |v: Vec3| self.place[0] * v.x + self.place[1] * v.y + self.place[2] * v.z;
        (self.place[3] + vector(d * self.near), vector(d).normalize())
    }
}

impl Camera {
    /// The camera as one without a lens, if it is.
    pub fn pinhole(&self, film: &FilmSpec) -> Option<Pinhole> {
        let is_pinhole = matches!(self.projection, Projection::Perspective) && self.lens_radius <= 0.0;
        let m = &self.world_from_camera.m;
        (is_pinhole && self.motion.is_none()).then(|| Pinhole {
            size: [film.width as f32, film.height as f32],
            window: self.window,
            near: self.near.max(0.0),
            view: self.view(),
            place: [m.x_axis, m.y_axis, m.z_axis, m.w_axis].map(glam::Vec4::truncate),
        })
    }

    /// The ray through a point of the full frame in pixels (origin at the top left, y down) and a point of the lens
    /// (`u` in the unit square). Directions have unit length.
    #[inline]
    pub fn ray(&self, film: &FilmSpec, pixel: Vec2, lens: Vec2) -> Ray {
        // Film position in the unit square, then on the window.
        let s = Vec2::new(pixel.x / film.width as f32, pixel.y / film.height as f32);
        let [x0, x1, y0, y1] = self.window;
        let w = Vec2::new(x0 + (x1 - x0) * s.x, y1 - (y1 - y0) * s.y);
        let (mut origin, mut direction) = match &self.projection {
            Projection::Realistic(lenses) => return self.lens_ray(lenses, w, lens, lens::D_LINE).0,
            Projection::Patch(patch, is_inward) => return self.ray_of_patch(*patch, *is_inward, s, lens),
            // Opacity is decided by a hash of the ray: samples differ a little in direction, so that the mean is seen.
            Projection::Own(own) => return self.own_ray(&**own, s, lens),
            Projection::Ray => (Vec3::ZERO, ((s - Vec2::splat(0.5)) * ACCEPTANCE).extend(1.0)),
            Projection::Perspective => (Vec3::ZERO, Vec3::new(w.x, w.y, 1.0)),
            Projection::Orthographic => (Vec3::new(w.x, w.y, 0.0), Vec3::Z),
            Projection::SphericalEqualArea => (Vec3::ZERO, swap_yz(warp::equal_area_square_to_sphere(s))),
            Projection::SphericalEquirectangular => {
                let (theta, phi) = (std::f32::consts::PI * s.y, std::f32::consts::TAU * s.x);
                (Vec3::ZERO, swap_yz(Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())))
            }
        };
        // Thin lens: all rays of a film point meet in the plane in focus.
        if self.lens_radius > 0.0 && direction.z > 0.0 {
            let p = warp::concentric_disk(lens) * self.lens_radius;
            let focus = origin + direction * (self.focal_distance / direction.z);
            origin += Vec3::new(p.x, p.y, 0.0);
            direction = focus - origin;
        }
        // Start at the near plane, and end at the far one.
        if self.near > 0.0 && direction.z > 0.0 {
            origin += direction * (self.near / direction.z);
        }
        let d = self.world_from_camera.vector(direction).normalize();
        Ray { t_max: self.view().end(d), ..Ray::new(self.world_from_camera.point(origin), d) }
    }

    /// The part of space between near and far plane.
    #[inline]
    fn view(&self) -> View {
        View { depth: self.far - self.near.max(0.0), axis: self.world_from_camera.inv.row(2).truncate() }
    }

    /// [`Self::ray`] at a moment of the exposure.
    #[inline]
    fn ray_at(&self, film: &FilmSpec, pixel: Vec2, lens: Vec2, time: f32) -> Ray {
        self.moved(Ray { time, ..self.ray(film, pixel, lens) })
    }

    /// The ray of a sample, at the moment of its wavelengths, and what share of its radiance counts: 1 but for a lens
    /// of several elements, where it turns radiance into irradiance of the film. It is 0 where the lens stops the ray,
    /// and the ray is then that of a pinhole. A lens that disperses leaves the hero wavelength alone.
    #[inline]
    pub fn sample(&self, film: &FilmSpec, pixel: Vec2, lens: Vec2, lambda: &mut Wavelengths) -> (Ray, f32) {
        let Projection::Realistic(lenses) = &self.projection else {
            return (self.ray_at(film, pixel, lens, lambda.time), 1.0);
        };
        let s = Vec2::new(pixel.x / film.width as f32, pixel.y / film.height as f32);
        let [x0, x1, y0, y1] = self.window;
        let w = Vec2::new(x0 + (x1 - x0) * s.x, y1 - (y1 - y0) * s.y);
        // Dispersion: keep the hero wavelength and terminate the others.
        let is_split = lenses.is_dispersive() && *lambda != Wavelengths::RGB.at_time(lambda.time);
        if is_split {
            lambda.terminate_secondary();
        }
        let nm = if is_split { f64::from(lambda.lambda[0]) } else { lens::D_LINE };
        let (ray, weight) = self.lens_ray(lenses, w, lens, nm);
        (self.moved(Ray { time: lambda.time, ..ray }), weight)
    }

    /// A ray through a lens of several elements in the world, and its weight.
    fn lens_ray(&self, lenses: &LensSystem, window: Vec2, lens: Vec2, nm: f64) -> (Ray, f32) {
        let stopped = || (Vec3::Z * lenses.front(), window.extend(1.0), 0.0);
        let (origin, direction, weight) = lenses.ray(window, lens, nm).unwrap_or_else(stopped);
        let d = self.world_from_camera.vector(direction);
        (Ray::new(self.world_from_camera.point(origin), d.normalize()), weight)
    }

    /// A ray where the camera is at the ray's moment.
    #[inline]
    fn moved(&self, ray: Ray) -> Ray {
        let Some(place) = self.motion.as_ref().and_then(|motion| motion.at(ray.time)) else { return ray };
        // Undo the placement at the opening of the shutter and apply the one at the ray's time.
        let ray = place.ray(&self.world_from_camera.inverse().ray(&ray));
        let length = ray.direction.length();
        Ray { direction: ray.direction.normalize(), t_max: ray.t_max * length, ..ray }
    }

    /// The camera's forward axis in the world, unit length.
    pub fn forward(&self) -> Vec3 {
        self.world_from_camera.vector(Vec3::Z).normalize()
    }

    /// The camera's axis to the right in the world, unit length.
    pub fn right(&self) -> Vec3 {
        self.world_from_camera.vector(Vec3::X).normalize()
    }

    /// The lab's camera: origin O, left L, up U and forward F; the image plane spans O + F ± L ± U.
    pub fn lab(origin: Vec3, left: Vec3, up: Vec3, forward: Vec3) -> Option<Self> {
        let columns = [-left.normalize(), up.normalize(), forward.normalize()];
        let m = steradian_math::Transform {
            matrix: glam::DMat4::from_cols(
                columns[0].as_dvec3().extend(0.0),
                columns[1].as_dvec3().extend(0.0),
                columns[2].as_dvec3().extend(0.0),
                origin.as_dvec3().extend(1.0),
            ),
        };
        // Window from the ratios of the given axes.
        let (x, y) = (left.length() / forward.length(), up.length() / forward.length());
        Some(Self {
            projection: Projection::Perspective,
            world_from_camera: m.affine()?,
            motion: None,
            window: [-x, x, -y, y],
            lens_radius: 0.0,
            focal_distance: 1.0,
            near: 0.0,
            far: f32::INFINITY,
            medium: None,
        })
    }
}

/// The spherical maps have +z up; cameras have +y up.
fn swap_yz(v: Vec3) -> Vec3 {
    Vec3::new(v.x, v.z, v.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Crop, Filter, FilterKind};

    fn film(width: u32, height: u32) -> FilmSpec {
        FilmSpec {
            width,
            height,
            crop: Crop { x0: 0, y0: 0, x1: width, y1: height },
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

    /// M51: rays of the pinhole camera invert the perspective projection; M52: the lab's camera is the same one.
    #[test]
    fn pinhole_rays_invert_the_projection() {
        let o = Vec3::new(0.0, 0.0, -3.5);
        let lab = Camera::lab(o, -Vec3::X, Vec3::Y, Vec3::Z * 3.0).unwrap();
        let film = film(256, 256);
        for pixel in [Vec2::new(0.5, 0.5), Vec2::new(128.0, 128.0), Vec2::new(200.5, 13.5)] {
            let ray = lab.ray(&film, pixel, Vec2::splat(0.5));
            // Project a point of the ray onto the image plane z = -0.5, and back to pixels.
            let p = ray.at(2.7);
            let on_plane = o + (p - o) * (3.0 / (p.z - o.z));
            let back = Vec2::new((on_plane.x + 1.0) * 128.0, (1.0 - on_plane.y) * 128.0);
            assert!((back - pixel).length() < 1e-3, "{back} {pixel}");
        }
        // The lab's L = (-1, 0, 0) points to the left of the picture.
        assert!(lab.ray(&film, Vec2::new(0.5, 128.0), Vec2::ZERO).direction.x < 0.0);
        let fov = 2.0 * (1.0_f32 / 3.0).atan();
        assert!((FovAxis::X.half_window(fov, 1.0) - Vec2::splat(1.0 / 3.0)).length() < 1e-6);
    }

    #[test]
    fn angles_of_view_span_their_axis() {
        let fov = 1.0_f32;
        let t = 0.5_f32.tan();
        assert!((FovAxis::Smaller.half_window(fov, 2.0).y - t).abs() < 1e-6);
        assert!((FovAxis::Smaller.half_window(fov, 0.5).x - t).abs() < 1e-6);
        assert!((FovAxis::Larger.half_window(fov, 2.0).x - t).abs() < 1e-6);
        assert!((FovAxis::Diagonal.half_window(fov, 1.7).length() - t).abs() < 1e-6);
    }

    #[test]
    fn lens_rays_meet_in_the_plane_of_focus() {
        let mut c = Camera::lab(Vec3::ZERO, -Vec3::X, Vec3::Y, Vec3::Z).unwrap();
        (c.lens_radius, c.focal_distance) = (0.3, 4.0);
        let film = film(64, 64);
        let meet = |lens| {
            let r = c.ray(&film, Vec2::new(10.0, 20.0), lens);
            r.at((4.0 - r.origin.z) / r.direction.z)
        };
        assert!((meet(Vec2::new(0.1, 0.9)) - meet(Vec2::new(0.7, 0.2))).length() < 1e-5);
    }
}
