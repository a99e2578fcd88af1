//! The camera as a projection to clip space.

use steradian_core::{Scene, camera::Projection, scene::Geometry};
use steradian_math::{Ray, Vec2, Vec3, Vec4, transform::Affine};
use steradian_raster::{
    Extent,
    glam::{Mat3, Mat4},
    state::Viewport,
};

use crate::Error;

/// A camera that maps points to clip space, with reversed depth: 1 near, 0 far. What lies before the camera's start of
/// rays is cut.
#[derive(Clone, Copy, Debug)]
pub struct Projected {
    camera_from_world: Affine,
    /// x0 + x1, x1 − x0, y0 + y1, y1 − y0 of the window on z = 1 that the full frame shows.
    window: [f32; 4],
    perspective: bool,
    /// Start of the view along the axis, and its length where rays are parallel.
    near: f32,
    length: f32,
    /// The place in each pixel that is looked at.
    offset: Vec2,
    /// Frame of a light's view; `None` for the scene's camera.
    light: Option<LightFrame>,
    /// True if emitters are left out: for cameras from which lights are hidden.
    hide_emitters: bool,
}

/// The square picture of a light's view.
#[derive(Clone, Copy, Debug)]
struct LightFrame {
    /// Its side in texels.
    size: u32,
    /// Warp of the picture; `None` leaves it as it is.
    warp: Option<Warp>,
}

/// A homography of the picture plane. It maps (x, y, w) of clip space and leaves z, so that all points of a ray keep
/// one place, and their depths are divided by the same number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Warp {
    forward: Mat3,
    inverse: Mat3,
}

impl Warp {
    /// A homography, scaled so that depths stay in 0…1 within the frame; `None` where it has no inverse, or its horizon
    /// crosses the frame.
    pub fn new(forward: Mat3) -> Option<Self> {
        let inverse = forward.inverse();
        // The divisor is linear over the frame, so that its extremes are at the corners. It must be positive
        // everywhere, or the horizon would cross the frame.
        let corners = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];
        let scales = corners.map(|[x, y]| (inverse * Vec3::new(x, y, 1.0)).z);
        let (least, largest) = scales.iter().fold((f32::MAX, 0f32), |(a, b), s| (a.min(*s), b.max(*s)));
        let is_sound = inverse.is_finite() && least > 0.0 && largest < f32::MAX;
        is_sound.then(|| Self { forward: forward * largest, inverse: inverse * (1.0 / largest) })
    }

    /// The place before the warp of a place in the frame, and what depths there were divided by.
    fn undo(&self, x: f32, y: f32) -> (Vec2, f32) {
        // Apply the inverse homography and divide.
        let p = self.inverse * Vec3::new(x, y, 1.0);
        (Vec2::new(p.x, p.y) / p.z, 1.0 / p.z)
    }
}

impl Projected {
    /// This view, from which lights are hidden if so asked.
    pub fn hiding_emitters(self, hide_emitters: bool) -> Self {
        Self { hide_emitters, ..self }
    }

    /// True if this view leaves a geometry out.
    pub(crate) fn hides(&self, geometry: &Geometry) -> bool {
        self.hide_emitters && geometry.emitter.is_some()
    }

    /// The scene's camera, looking at this place of each pixel (0…1 from its top left).
    ///
    /// # Errors
    /// Cameras that see all directions, or a frame beyond what viewports hold.
    pub fn new(scene: &Scene, offset: Vec2) -> Result<Self, Error> {
        let (camera, film) = (scene.camera(), scene.film());
        let perspective = match camera.projection {
            Projection::Perspective => true,
            Projection::Orthographic => false,
            Projection::Realistic(_) => {
                return Err(Error::Scene(
                    "raster needs a perspective or orthographic camera, not one with a lens of several elements".into(),
                ));
            }
            _ => {
                return Err(Error::Scene(
                    "raster needs a perspective or orthographic camera, not one of all directions or a meter".into(),
                ));
            }
        };
        if film.width > steradian_raster::state::MAX_SIZE || film.height > steradian_raster::state::MAX_SIZE {
            let most = steradian_raster::state::MAX_SIZE;
            return Err(Error::Scene(format!("raster draws frames up to {most} x {most} pixels")));
        }
        // The far plane follows from the scene's extent along the axis.
        let [x0, x1, y0, y1] = camera.window;
        let camera_from_world = camera.world_from_camera.inverse();
        let (center, radius) = crate::extent(scene);
        let middle = camera_from_world.point(center).z;
        // A length of the scene in the camera's units.
        let radius = radius * camera_from_world.vector(camera.forward()).length();
        let far = (middle + radius).max(1e-6 * radius);
        // Reversed depths as floats keep their precision for any near plane.
        let near = if perspective { camera.near.max(1e-7 * (far + radius)) } else { camera.near.max(0.0) };
        // The pipeline looks at centres of pixels: the window moves instead.
        let moved = [(offset.x - 0.5) / film.width as f32, (offset.y - 0.5) / film.height as f32];
        let (dx, dy) = ((x1 - x0) * moved[0], -(y1 - y0) * moved[1]);
        Ok(Self {
            camera_from_world,
            window: [x0 + x1 + 2.0 * dx, x1 - x0, y0 + y1 + 2.0 * dy, y1 - y0],
            perspective,
            near,
            length: (far - near).max(1e-6 * radius),
            offset,
            light: None,
            hide_emitters: false,
        })
    }

    /// The square view of a light: from a place along unit axes (right, up, forward), `half` wide to each side (at
    /// distance 1, for perspective).
    pub fn of_light(place: Vec3, axes: [Vec3; 3], half: f32, perspective: bool, range: [f32; 2], size: u32) -> Self {
        // Orthonormal light space; its inverse is the view matrix.
        let [right, up, forward] = axes.map(|a| a.extend(0.0));
        let world_from_light = Mat4::from_cols(right, up, forward, place.extend(1.0));
        let camera_from_world = Affine { m: world_from_light.inverse(), inv: world_from_light };
        Self {
            camera_from_world,
            window: [0.0, 2.0 * half, 0.0, 2.0 * half],
            perspective,
            near: range[0],
            length: range[1] - range[0],
            offset: Vec2::splat(0.5),
            light: Some(LightFrame { size, warp: None }),
            hide_emitters: false,
        }
    }

    /// The view of a light, bent.
    pub(crate) fn warped(self, warp: Option<Warp>) -> Self {
        Self { light: self.light.map(|frame| LightFrame { warp, ..frame }), ..self }
    }

    /// The place on the picture plane (x right and y up, from −1 to 1 before any warp) that a place of the frame shows,
    /// and what depths there were divided by.
    pub(crate) fn unwarped(&self, x: f32, y: f32) -> (Vec2, f32) {
        match self.light.and_then(|frame| frame.warp) {
            Some(warp) => warp.undo(x, y),
            None => (Vec2::new(x, y), 1.0),
        }
    }

    /// True if rays start at one point.
    pub(crate) fn is_perspective(&self) -> bool {
        self.perspective
    }

    /// Start of the view along its axis.
    pub(crate) fn near(&self) -> f32 {
        self.near
    }

    /// Distance of a point from the eye along the axis of the view.
    pub(crate) fn along_axis(&self, p: Vec3) -> f32 {
        self.camera_from_world.point(p).z
    }

    /// Half the width of the window: in space where rays are parallel, at distance 1 otherwise.
    pub(crate) fn half(&self) -> f32 {
        self.window[1] / 2.0
    }

    /// The place of the eye, and the direction it looks in (not of unit length).
    pub(crate) fn eye(&self) -> (Vec3, Vec3) {
        let world = self.camera_from_world.inverse();
        (world.point(Vec3::ZERO), world.vector(Vec3::Z))
    }

    /// A point of the view's own coordinates in the world.
    pub(crate) fn world(&self, local: Vec3) -> Vec3 {
        self.camera_from_world.inverse().point(local)
    }

    /// Right and up on the plane at distance 1 (in space where rays are parallel) of the corners of the frame: least
    /// and largest.
    pub(crate) fn window(&self) -> [f32; 4] {
        let [x_sum, x_size, y_sum, y_size] = self.window;
        [(x_sum - x_size) / 2.0, (x_sum + x_size) / 2.0, (y_sum - y_size) / 2.0, (y_sum + y_size) / 2.0]
    }

    /// Normalised distance along the axis, from 0 at the start of the view to 1 at its end, clamped.
    pub(crate) fn share_of(&self, distance: f32) -> f32 {
        ((distance - self.near) / self.length).clamp(0.0, 1.0)
    }

    /// A point with weight `w`, or with 0 a direction, in clip space. Depths are not held to the range.
    pub(crate) fn clip_homogeneous(&self, p: Vec4) -> Vec4 {
        // As `clip`, for homogeneous points: w = 0 is a direction, whose image is its vanishing point.
        let c = self.camera_from_world.m * p;
        let [x_sum, x_size, y_sum, y_size] = self.window;
        if self.perspective {
            let (x, y) = ((2.0 * c.x - x_sum * c.z) / x_size, (2.0 * c.y - y_sum * c.z) / y_size);
            Vec4::new(x, y, self.near * c.w, c.z)
        } else {
            // Parallel rays: depth falls linearly from 1 to 0.
            let depth = c.w - (c.z - self.near * c.w) / self.length;
            Vec4::new((2.0 * c.x - x_sum * c.w) / x_size, (2.0 * c.y - y_sum * c.w) / y_size, depth, c.w)
        }
    }

    /// Size of the picture, and where the view lies in it.
    pub(crate) fn frame(&self, scene: &Scene) -> (Extent, Viewport) {
        if let Some(LightFrame { size, .. }) = self.light {
            return (Extent::new(size, size), Viewport::new(size as f32, size as f32));
        }
        let (film, crop) = (scene.film(), scene.film().crop);
        let viewport = Viewport::new(film.width as f32, film.height as f32);
        (Extent::new(crop.width(), crop.height()), Viewport { x: -(crop.x0 as f32), y: -(crop.y0 as f32), ..viewport })
    }

    /// True if pictures are mirrored against space: a counter-clockwise triangle appears clockwise.
    pub(crate) fn is_mirrored(&self) -> bool {
        // Right, up and forward are a left-handed system.
        self.camera_from_world.m.determinant() > 0.0
    }

    /// A point in the view's own coordinates: right, up, forward.
    pub fn local(&self, p: Vec3) -> Vec3 {
        self.camera_from_world.point(p)
    }

    /// A direction in the view's own coordinates.
    pub fn turn(&self, direction: Vec3) -> Vec3 {
        self.camera_from_world.vector(direction)
    }

    /// Distance along the axis of what has this depth; infinite where nothing was drawn.
    pub fn distance_of(&self, depth: f32) -> f32 {
        if depth <= 0.0 {
            f32::INFINITY
        } else if self.perspective {
            self.near / depth
        } else {
            self.near + (1.0 - depth) * self.length
        }
    }

    /// A point of the world in clip space.
    #[inline]
    pub fn clip(&self, p: Vec3) -> Vec4 {
        // From camera space to clip space: x and y relative to the window, w the distance along the axis. Perspective
        // depth is near/z, reversed (Lapidous, Jiao 1999).
        let c = self.camera_from_world.point(p);
        let [x_sum, x_size, y_sum, y_size] = self.window;
        let clip = if self.perspective {
            let (x, y) = ((2.0 * c.x - x_sum * c.z) / x_size, (2.0 * c.y - y_sum * c.z) / y_size);
            Vec4::new(x, y, self.near, c.z)
        } else {
            let depth = 1.0 - (c.z - self.near) / self.length;
            Vec4::new((2.0 * c.x - x_sum) / x_size, (2.0 * c.y - y_sum) / y_size, depth, 1.0)
        };
        match self.light {
            // The warp acts on (x, y, w) and leaves z.
            Some(LightFrame { warp: Some(warp), .. }) => {
                let bent = warp.forward * Vec3::new(clip.x, clip.y, clip.w);
                Vec4::new(bent.x, bent.y, clip.z, bent.z)
            }
            _ => clip,
        }
    }

    /// Depth in the window of a point of the world.
    #[inline]
    pub fn depth(&self, p: Vec3) -> f32 {
        let clip = self.clip(p);
        clip.z / clip.w
    }

    /// The ray through a pixel of the picture.
    #[inline]
    pub fn ray(&self, scene: &Scene, [x, y]: [u32; 2]) -> Ray {
        // A light's view derives rays from its own frame.
        if let Some(LightFrame { size, .. }) = self.light {
            return self.light_ray([x, y], size);
        }
        let crop = scene.film().crop;
        let pixel = Vec2::new((crop.x0 + x) as f32, (crop.y0 + y) as f32) + self.offset;
        // The middle of the lens: no blur.
        scene.camera().ray(scene.film(), pixel, Vec2::splat(0.5))
    }

    /// The unit ray of the view towards a point, which need not be in the frame, and the distance to it: from the eye,
    /// or from its plane where rays are parallel.
    pub(crate) fn ray_to(&self, p: Vec3) -> (Ray, f32) {
        let (eye, axis) = self.eye();
        if self.perspective {
            let to = p - eye;
            return (Ray::new(eye, to.normalize_or_zero()), to.length());
        }
        let d = axis.normalize();
        let t = (p - eye).dot(d);
        (Ray::new(p - d * t, d), t)
    }

    fn light_ray(&self, [x, y]: [u32; 2], size: u32) -> Ray {
        // Unproject the texel's centre to the plane at distance 1.
        let at = |i: u32| (i as f32 + 0.5) / size as f32 * 2.0 - 1.0;
        let place = (self.unwarped(at(x), -at(y)).0 * self.half()).extend(0.0);
        let world = self.camera_from_world.inverse();
        if self.perspective {
            Ray::new(world.point(Vec3::ZERO), world.vector(place.with_z(1.0)).normalize())
        } else {
            Ray::new(world.point(place), world.vector(Vec3::Z).normalize())
        }
    }
}
