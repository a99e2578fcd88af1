//! Projections to clip space: central, parallel and oblique ones, and the ranges of depth that graphics interfaces
//! have.
//!
//! Eye space has +x to the right, +y up and looks along −z. Clip space `(x, y, z, w)` shows what has `|x| ≤ w`,
//! `|y| ≤ w` and its depth `z/w` in the range of [`Depth`]. A [`View`] is a window on the plane z = −1, or for parallel
//! views anywhere, between two planes. [`View::steps`] has the central projection as three maps, each of which shows
//! what it is for.

use glam::{DMat4, DVec3, DVec4};

/// Range of depths of clip space after division, from the near plane to the far one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// −1 to 1, as OpenGL has it.
    MinusOneToOne,
    /// 0 to 1, as Vulkan, Direct3D, Metal and WebGPU have it.
    ZeroToOne,
    /// 1 to 0: floating-point numbers are dense near 0, so that distant depths keep their precision (Lapidous and Jiao,
    /// "Optimal depth buffer for low-cost graphics hardware", 1999).
    Reversed,
}

impl Depth {
    /// Depths of the near plane and of the far one.
    pub fn range(self) -> (f64, f64) {
        match self {
            Self::MinusOneToOne => (-1.0, 1.0),
            Self::ZeroToOne => (0.0, 1.0),
            Self::Reversed => (1.0, 0.0),
        }
    }
}

/// Part of eye space that a picture shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Left, right, bottom and top of the window: on the plane z = −1 for central projections.
    window: [f64; 4],
    /// Distances of the near and far plane.
    near: f64,
    far: f64,
}

impl View {
    /// A view by its window (left, right, bottom, top) and the distances of its near and far plane; the far one may be
    /// infinite. A window that is not symmetric makes an off-axis projection. `None` for windows without area and for
    /// planes that are not in order.
    pub fn new(window: [f64; 4], near: f64, far: f64) -> Option<Self> {
        let [left, right, bottom, top] = window;
        let is_sound = window.iter().all(|v| v.is_finite()) && left != right && bottom != top;
        (is_sound && near.is_finite() && near < far).then_some(Self { window, near, far })
    }

    /// A symmetric view by the full vertical angle in radians and the aspect (width over height). `None` for angles
    /// that are not between 0 and π.
    ///
    /// The window is linear in the tangents of half the angles: tan(φₓ/2) = aspect · tan(φᵧ/2).
    pub fn of_angle(vertical: f64, aspect: f64, near: f64, far: f64) -> Option<Self> {
        let y = (vertical / 2.0).tan();
        let is_sound = vertical > 0.0 && vertical < std::f64::consts::PI && aspect > 0.0;
        if is_sound { Self::new([-aspect * y, aspect * y, -y, y], near, far) } else { None }
    }

    /// Rows x and y of a projection whose w is −z (central) or 1 (parallel).
    fn window_rows(&self, is_central: bool) -> [DVec4; 2] {
        let [left, right, bottom, top] = self.window;
        [[left, right], [bottom, top]].map(|[low, high]| {
            // Maps low … high to −w … w.
            let (scale, shift) = (2.0 / (high - low), (high + low) / (high - low));
            if is_central { DVec4::new(scale, 0.0, shift, 0.0) } else { DVec4::new(scale, 0.0, 0.0, -shift) }
        })
    }

    /// Matrix of rows: x and y of the window, depth, and w.
    fn matrix(&self, is_central: bool, depth: DVec4, w: DVec4) -> DMat4 {
        let [x, y] = self.window_rows(is_central);
        // The scale of y stands in its own column.
        let y = DVec4::new(0.0, y.x, y.z, y.w);
        DMat4::from_cols(x, y, depth, w).transpose()
    }

    /// The central projection from the eye; `None` where the near plane is not in front of the eye.
    ///
    /// w is the distance −z along the axis, and depth `A + B/w` with A and B by the range: for −1 … 1 these are
    /// A = (f + n)/(f − n) and B = −2fn/(f − n), with an infinite far plane the limits 1 and −2n.
    pub fn perspective(&self, depth: Depth) -> Option<DMat4> {
        if self.near <= 0.0 {
            return None;
        }
        let (at_near, at_far) = depth.range();
        // A + B/n = at_near, A + B/f = at_far.
        let share = if self.far == f64::INFINITY { 1.0 } else { self.far / (self.far - self.near) };
        let b = (at_near - at_far) * self.near * share;
        let a = at_near - (at_near - at_far) * share;
        Some(self.matrix(true, DVec4::new(0.0, 0.0, -a, b), DVec4::new(0.0, 0.0, -1.0, 0.0)))
    }

    /// The parallel projection along −z; `None` with an infinite far plane. The near plane may lie behind the eye.
    pub fn orthographic(&self, depth: Depth) -> Option<DMat4> {
        if self.far == f64::INFINITY {
            return None;
        }
        // Depth is linear in the distance −z.
        let (at_near, at_far) = depth.range();
        let slope = (at_far - at_near) / (self.far - self.near);
        let row = DVec4::new(0.0, 0.0, -slope, at_near - slope * self.near);
        Some(self.matrix(false, row, DVec4::W))
    }

    /// The parallel projection along another direction, which shears space until that is −z and keeps the plane z = 0;
    /// cavalier and cabinet projections are such. `None` for directions along that plane, and as
    /// [`orthographic`](Self::orthographic).
    pub fn oblique(&self, direction: DVec3, depth: Depth) -> Option<DMat4> {
        let slide = direction.truncate() / -direction.z;
        if !slide.is_finite() {
            return None;
        }
        let shear = DMat4::from_cols(DVec4::X, DVec4::Y, slide.extend(1.0).extend(0.0), DVec4::W);
        Some(self.orthographic(depth)? * shear)
    }

    /// The central projection to −1 … 1 as three maps, the first one to be applied first: the frustum is made square
    /// (its sides become |x| = |y| = |z|), lines through the eye are made parallel to the axis (the planes of near and
    /// far stay where they are), and the box that this leaves is scaled to the cube. `None` as
    /// [`perspective`](Self::perspective), and with an infinite far plane.
    pub fn steps(&self) -> Option<[DMat4; 3]> {
        let (n, f) = (self.near, self.far);
        if n <= 0.0 || f == f64::INFINITY {
            return None;
        }
        let unchanged = DVec4::new(0.0, 0.0, 1.0, 0.0);
        let square = self.matrix(true, unchanged, DVec4::W);
        // z ↦ −(n + f) − nf/z has the fixed points −n and −f.
        let parallel =
            DMat4::from_cols(DVec4::X, DVec4::Y, DVec4::new(0.0, 0.0, n + f, -1.0), DVec4::new(0.0, 0.0, n * f, 0.0));
        // −n ↦ −1 and −f ↦ 1: depth grows away from the eye.
        let scale = -2.0 / (f - n);
        let cube = DMat4::from_cols(
            DVec4::X,
            DVec4::Y,
            DVec4::new(0.0, 0.0, scale, 0.0),
            DVec4::new(0.0, 0.0, -(f + n) / (f - n), 1.0),
        );
        Some([square, parallel, cube])
    }
}

/// Moves the near plane of a central projection with depths −1 … 1 to any plane `(a, b, c, d)` of eye space that the
/// eye is behind, a x + b y + c z + d ≥ 0 for what is kept: mirrors are drawn so, without what lies between them and
/// the mirrored eye (Lengyel, "Oblique view frustum depth projection and clipping", 2005). The far plane changes too,
/// so that it keeps the far corner of the frustum opposite to the plane. `None` for planes that do not cut the frustum.
pub fn with_near_plane(projection: &DMat4, plane: DVec4) -> Option<DMat4> {
    // The corner of clip space opposite to the plane, in eye space.
    let inverse = projection.inverse();
    let clip = inverse.transpose() * plane;
    let corner = inverse * DVec4::new(clip.x.signum(), clip.y.signum(), 1.0, 1.0);
    // The depth row M₃ = 2 (M₄·Q)/(C·Q) C − M₄ is −w on the plane and w in the corner.
    let w = projection.row(3);
    let z = plane * (2.0 * w.dot(corner) / plane.dot(corner)) - w;
    let m = projection.transpose();
    let result = DMat4::from_cols(m.x_axis, m.y_axis, z, m.w_axis).transpose();
    result.is_finite().then_some(result)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::Random;

    fn divided(m: &DMat4, p: DVec3) -> DVec3 {
        let c = *m * p.extend(1.0);
        c.truncate() / c.w
    }

    /// M29: corners of the near and far plane go to corners of the cube, whatever the range of depths and the window.
    #[test]
    fn planes_and_windows_are_mapped_exactly() {
        for window in [[-0.8, 0.8, -0.6, 0.6], [-0.3, 1.1, 0.2, 0.9]] {
            for depth in [Depth::MinusOneToOne, Depth::ZeroToOne, Depth::Reversed] {
                let (at_near, at_far) = depth.range();
                let view = View::new(window, 0.5, 20.0).unwrap();
                let (central, parallel) = (view.perspective(depth).unwrap(), view.orthographic(depth).unwrap());
                let endless = View::new(window, 0.5, f64::INFINITY).unwrap().perspective(depth).unwrap();
                for (x, cx) in [(window[0], -1.0), (window[1], 1.0)] {
                    for (y, cy) in [(window[2], -1.0), (window[3], 1.0)] {
                        for (distance, z) in [(0.5, at_near), (20.0, at_far)] {
                            let corner = DVec3::new(cx, cy, z);
                            let ray = DVec3::new(x, y, -1.0);
                            assert!((divided(&central, ray * distance) - corner).length() < 1e-13);
                            let at = DVec3::new(x, y, -distance);
                            assert!((divided(&parallel, at) - corner).length() < 1e-13);
                        }
                        assert!((divided(&endless, DVec3::new(x, y, -1.0) * 0.5).z - at_near).abs() < 1e-13);
                        assert!((divided(&endless, DVec3::new(x, y, -1.0) * 1e12).z - at_far).abs() < 1e-11);
                    }
                }
            }
        }
    }

    /// The matrix of OpenGL, by its entries; tan(φₓ/2) is the aspect times tan(φᵧ/2).
    #[test]
    fn the_matrix_is_that_of_opengl() {
        let (n, f, y) = (0.25, 8.0, 0.6f64);
        let m = View::of_angle(2.0 * y.atan(), 1.5, n, f).unwrap().perspective(Depth::MinusOneToOne).unwrap();
        let right = DMat4::from_cols(
            DVec4::X / (1.5 * y),
            DVec4::Y / y,
            DVec4::new(0.0, 0.0, -(f + n) / (f - n), -1.0),
            DVec4::new(0.0, 0.0, -2.0 * f * n / (f - n), 0.0),
        );
        assert!(m.abs_diff_eq(right, 1e-14), "{m}");
    }

    /// The three steps: the sides of the frustum become |x| = |z|, then lines through the eye are parallel to the axis
    /// with near and far in their places, then all is the cube. Their product is the projection.
    #[test]
    fn three_steps_are_the_projection() {
        let view = View::new([-0.5, 0.7, -0.4, 0.3], 0.5, 6.0).unwrap();
        let [square, parallel, cube] = view.steps().unwrap();
        let product = cube * parallel * square;
        assert!(product.abs_diff_eq(view.perspective(Depth::MinusOneToOne).unwrap(), 1e-14));
        for t in [0.5, 1.7, 6.0] {
            let side = divided(&square, DVec3::new(0.7, -0.4, -1.0) * t);
            assert!((side - DVec3::new(t, -t, -t)).length() < 1e-14, "{side}");
            // The line through the eye and this point keeps its x and y at all distances.
            let on_line = divided(&parallel, DVec3::new(0.3, -0.2, -1.0) * t);
            assert!((on_line.truncate() - glam::DVec2::new(0.3, -0.2)).length() < 1e-14);
        }
        for plane in [-0.5, -6.0] {
            assert!((divided(&parallel, DVec3::new(0.0, 0.0, plane)).z - plane).abs() < 1e-14);
        }
    }

    /// Parallel lines stay parallel, and those along the direction of an oblique projection become points.
    #[test]
    fn parallel_projections_keep_parallels() {
        let view = View::new([-2.0, 2.0, -1.0, 1.0], -3.0, 5.0).unwrap();
        let direction = DVec3::new(0.35, 0.35, -1.0);
        let mut random = Random::new(29);
        for m in [view.orthographic(Depth::ZeroToOne), view.oblique(direction, Depth::ZeroToOne)].map(Option::unwrap) {
            let along = DVec3::new(random.number(), random.number(), random.number());
            let image = |p: DVec3| divided(&m, p + along) - divided(&m, p);
            let (a, b) = (DVec3::new(0.3, 0.1, -2.0), DVec3::new(-0.7, 0.4, 1.0));
            assert!((image(a) - image(b)).length() < 1e-14);
        }
        let m = view.oblique(direction, Depth::ZeroToOne).unwrap();
        let (a, b) = (divided(&m, DVec3::new(0.1, 0.2, 0.0)), divided(&m, DVec3::new(0.1, 0.2, 0.0) + direction * 2.0));
        assert!((a.truncate() - b.truncate()).length() < 1e-14 && b.z > a.z);
    }

    /// Points of the plane have depth −1, those in front of it more, and no point of the frustum has more than 1.
    #[test]
    fn the_near_plane_moves_to_any_plane() {
        let view = View::new([-0.8, 0.8, -0.6, 0.6], 0.5, 20.0).unwrap();
        let projection = view.perspective(Depth::MinusOneToOne).unwrap();
        let plane = DVec4::new(0.2, -0.3, -0.9, -2.0);
        let moved = with_near_plane(&projection, plane).unwrap();
        let mut random = Random::new(30);
        for _ in 0..1000 {
            let ray = DVec3::new(0.8 * random.number(), 0.6 * random.number(), -1.0);
            let t = -plane.w / plane.truncate().dot(ray);
            assert!((divided(&moved, ray * t).z + 1.0).abs() < 1e-12);
            assert!((divided(&moved, ray * t).truncate() - divided(&projection, ray * t).truncate()).length() < 1e-12);
            let deeper = t + (20.0 - t) * random.number().abs();
            assert!((-1.0..=1.0 + 1e-9).contains(&divided(&moved, ray * deeper).z));
        }
    }

    #[test]
    fn views_that_are_none_are_refused() {
        assert!(View::new([0.0, 0.0, -1.0, 1.0], 1.0, 2.0).is_none());
        assert!(View::new([-1.0, 1.0, -1.0, 1.0], 2.0, 1.0).is_none());
        assert!(View::new([-1.0, f64::NAN, -1.0, 1.0], 1.0, 2.0).is_none());
        assert!(View::of_angle(std::f64::consts::PI, 1.0, 1.0, 2.0).is_none());
        let behind = View::new([-1.0, 1.0, -1.0, 1.0], -1.0, 2.0).unwrap();
        assert!(behind.perspective(Depth::Reversed).is_none() && behind.steps().is_none());
        let endless = View::new([-1.0, 1.0, -1.0, 1.0], 1.0, f64::INFINITY).unwrap();
        assert!(endless.orthographic(Depth::Reversed).is_none() && endless.steps().is_none());
        assert!(behind.oblique(DVec3::X, Depth::ZeroToOne).is_none());
    }
}
