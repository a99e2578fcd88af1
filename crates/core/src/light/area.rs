//! Emission of surfaces.
//!
//! Every emitting triangle is a light of its own; two triangles that form a rectangle are one. Triangles and rectangles
//! that look large are sampled uniformly in solid angle, small ones uniformly in area; spheres by the cone they subtend
//! (Shirley, Wang, Zimmerman 1996).

use super::{LightSample, moving::Moving, tree::LightBounds};
use crate::shape::{Quadric, QuadricKind, TriMesh, level::Swept, quadric::one_minus_cos_max};
use std::{borrow::Cow, sync::Arc};
use steradian_math::{
    Bounds3, Frame, Ray, Spectrum, Vec2, Vec3,
    hash::ONE_MINUS_EPSILON,
    spectra::{ColorMode, Wavelengths, role::Color},
    warp,
};
use steradian_texture::{FloatTexture, SpectrumTexture, TextureContext, Textures};

/// Emission of a surface.
#[derive(Clone, Debug)]
pub struct Emitter {
    /// Radiance.
    pub radiance: SpectrumTexture,
    /// Factor on it.
    pub scale: f32,
    /// Enables emission on the back side, against the normal.
    pub two_sided: bool,
    /// Luminance of the radiance (of the mean of a texture), scale included.
    pub luminance: f32,
    /// Opacity of the surface, which shines where it is there.
    pub alpha: Option<FloatTexture>,
}

impl Emitter {
    /// Radiance at a point of the surface in direction `w`; `at` says where a texture is looked up.
    #[inline]
    pub fn radiance<'a>(
        &self,
        n: Vec3,
        w: Vec3,
        at: impl FnOnce() -> TextureContext<'a>,
        lambda: &Wavelengths,
        textures: &Textures,
    ) -> Spectrum {
        // One-sided emitters are dark from behind.
        if !self.two_sided && n.dot(w) <= 0.0 {
            return Spectrum::ZERO;
        }
        let radiance = match &self.radiance {
            SpectrumTexture::Constant(color) => color.eval(lambda),
            texture => texture.eval(textures, &TextureContext { time: lambda.time, ..at() }, lambda),
        };
        radiance * self.scale
    }

    /// Radiance at a point that was drawn, in the mean over rays: rays meet the surface as often as it is opaque.
    #[inline]
    pub fn drawn<'a>(
        &self,
        n: Vec3,
        w: Vec3,
        at: impl Fn() -> TextureContext<'a>,
        lambda: &Wavelengths,
        textures: &Textures,
    ) -> Spectrum {
        let radiance = self.radiance(n, w, &at, lambda, textures);
        // Expected emission: radiance times opacity, since samples do not test the mask themselves.
        match &self.alpha {
            Some(alpha) if !radiance.is_black() => {
                radiance * alpha.eval(textures, &TextureContext { n, ..at() }).clamp(0.0, 1.0)
            }
            _ => radiance,
        }
    }

    /// The radiance, if it is the same at all points.
    #[inline]
    pub fn everywhere(&self, lambda: &Wavelengths) -> Option<Spectrum> {
        match &self.radiance {
            SpectrumTexture::Constant(color) if self.alpha.is_none() => Some(color.eval(lambda) * self.scale),
            _ => None,
        }
    }

    /// A constant emitter.
    pub fn constant(color: Color, two_sided: bool, mode: ColorMode) -> Self {
        let luminance = color.luminance(mode);
        Self { radiance: SpectrumTexture::Constant(color), scale: 1.0, two_sided, luminance, alpha: None }
    }

    /// True if the radiance depends on the position.
    pub fn is_textured(&self) -> bool {
        !self.radiance.is_constant()
    }

    /// True if the emission of a point depends on its position, by radiance or opacity.
    pub fn varies(&self) -> bool {
        self.is_textured() || matches!(self.alpha, Some(FloatTexture::Texture(_)))
    }
}

/// The part of a surface that is one light.
#[derive(Clone, Debug)]
pub enum AreaShape {
    /// A triangle of a mesh: corners, unit normal (oriented), area.
    Triangle([Vec3; 3], Vec3, f32),
    /// Corner, edges, unit normal (oriented), area; the two triangles of the mesh that make it up.
    Rectangle {
        /// A corner.
        corner: Vec3,
        /// First edge.
        ex: Vec3,
        /// Second edge, orthogonal to the first.
        ey: Vec3,
        /// Unit normal, oriented.
        n: Vec3,
        /// Area.
        area: f32,
    },
    /// A whole sphere: centre, radius, whether it shines inwards.
    Sphere(Vec3, f32, bool),
    /// Any other quadric, and spheres whose points differ.
    Quadric(Arc<Quadric>),
    /// A quadric of revolution.
    Swept(Arc<Swept>),
    /// A moving shape.
    Moving(Arc<Moving>),
}

/// A part of a surface that emits.
#[derive(Clone, Debug)]
pub struct AreaLight {
    /// Its shape.
    pub shape: AreaShape,
    /// Index of what it emits.
    pub emitter: u32,
    /// The mesh and triangle to look textures up on, where it is one.
    pub mesh: Option<(Arc<TriMesh>, u32)>,
    /// The probability with which a point outside a whole sphere samples its far side: above zero where rays pass the
    /// near side (by its alpha, or since it is culled) and the far side shines at the point.
    pub far_share: f32,
}

/// From this (rough) solid angle on, in sr, sampling by solid angle pays for its cost.
const SOLID_ANGLE_FROM: f32 = 0.25;

/// A point of the sphere with centre `c` and radius `r` as seen from `p`: direction, distance, outward normal, and
/// density per solid angle. A share of the samples is on the far side, where it is seen through the near one.
fn sample_sphere(c: Vec3, r: f32, p: Vec3, u: Vec2, far_share: f32) -> (Vec3, f32, Vec3, f32) {
    let to_center = c - p;
    let d2 = to_center.length_squared();
    // Outside the sphere sample the cone that it subtends: sin θ_max = r/d (PBR 4th ed., 6.2.4).
    if d2 > r * r * 1.000_01 {
        let m = one_minus_cos_max(r, d2);
        let is_far = u.x < far_share;
        let share = if is_far { far_share } else { 1.0 - far_share };
        // Reuse the number that chose near or far side: stretch its part back to [0, 1).
        let u = Vec2::new(if is_far { u.x / share } else { (u.x - far_share) / share }, u.y);
        let w = warp::uniform_cone(Vec2::new(u.x.min(ONE_MINUS_EPSILON), u.y), m);
        let wi = Frame::from_z(to_center / d2.sqrt()).to_world(w);
        // The point along wi; tangent rays count as touching.
        let b = to_center.dot(wi);
        let h2 = (r * r - (to_center - wi * b).length_squared()).max(0.0);
        let distance = if is_far { b + h2.sqrt() } else { b - h2.sqrt() };
        let n = (p + wi * distance - c) / r;
        (wi, distance, n, warp::uniform_cone_pdf(m) * share)
    } else {
        // Inside, or nearly on it, sample the area uniformly and convert: p_ω = d²/(|cos θ|·4πr²).
        let n = warp::uniform_sphere(u);
        let to = c + n * r - p;
        let t2 = to.length_squared();
        let distance = t2.sqrt();
        let wi = to / distance;
        (wi, distance, n, t2 / (n.dot(wi).abs() * 4.0 * std::f32::consts::PI * r * r))
    }
}

/// Centre and radius of a quadric that is a sphere.
fn whole_sphere(q: &Quadric) -> Option<(Vec3, f32)> {
    let QuadricKind::Sphere { radius, .. } = q.kind else { return None };
    let scale = q.is_whole_sphere().then(|| q.similarity()).flatten()?;
    Some((q.place.point(Vec3::ZERO), radius * scale))
}

/// A rectangle, or a triangle that looks small, by a corner and two edges.
#[derive(Clone, Copy, Debug)]
pub struct FlatLight {
    /// The corner.
    pub corner: Vec3,
    /// The edges.
    pub edges: [Vec3; 2],
    /// Unit normal.
    pub n: Vec3,
    /// Area.
    pub area: f32,
    /// True for a triangle, false for a rectangle.
    pub is_triangle: bool,
}

/// A point of a flat light.
#[derive(Clone, Copy, Debug)]
pub struct FlatSample {
    /// The point.
    pub q: Vec3,
    /// Position on the light, along both edges.
    pub uv: Vec2,
    /// Unit direction to it.
    pub wi: Vec3,
    /// Distance to it.
    pub distance: f32,
    /// Density per solid angle; zero where the light cannot be sampled.
    pub pdf: f32,
}

impl FlatLight {
    /// True for a rectangle that is sampled by the solid angle it subtends at a point.
    #[inline(always)]
    pub fn is_large(&self, p: Vec3) -> bool {
        let Self { corner, edges: [ex, ey], n, area, is_triangle } = *self;
        !is_triangle && AreaLight::looks_large(corner + (ex + ey) * 0.5, n, area, p)
    }

    /// A point of it as seen from `p`. `may_be_large` spares what is dear where it is known not to be
    /// [large](Self::is_large).
    #[inline(always)]
    pub fn sample(&self, p: Vec3, u: Vec2, may_be_large: bool) -> FlatSample {
        let Self { corner, edges: [ex, ey], n, area, is_triangle } = *self;
        // Large rectangles are sampled by solid angle (Ureña, Fajardo, King 2013), small ones by area.
        let is_large = may_be_large && self.is_large(p);
        let b = warp::uniform_triangle(u);
        let (mut s, mut t) = if is_triangle { (b[1], b[2]) } else { (u.x, u.y) };
        let mut by_angle = 0.0;
        if may_be_large {
            let rectangle = warp::SphericalRectangle::new(corner, ex, ey, p);
            let at = rectangle.sample_coordinates(u);
            (s, t) = if is_large { at } else { (s, t) };
            by_angle = if rectangle.solid_angle > 0.0 { 1.0 / rectangle.solid_angle } else { 0.0 };
        }
        let q = corner + ex * s + ey * t;
        let to = q - p;
        let d2 = to.length_squared();
        // p_ω = d²/(|cos θ|·A).
        let distance = d2.sqrt();
        let wi = to / distance;
        let cos = n.dot(wi).abs();
        let pdf = if is_large { by_angle } else { d2 / (cos * area) };
        // Grazing views and coincident points have no density: such samples count as failed.
        let is_sound = (d2 > 0.0) & (cos != 0.0) & (pdf > 0.0) & (pdf < f32::INFINITY);
        FlatSample { q, uv: Vec2::new(s, t), wi, distance, pdf: if is_sound { pdf } else { 0.0 } }
    }
}

impl AreaLight {
    /// The light as it is at a moment of the exposure.
    #[inline(always)]
    pub fn at(&self, time: f32) -> Cow<'_, Self> {
        match &self.shape {
            AreaShape::Moving(moving) => Cow::Owned(Self { shape: moving.at(time), mesh: self.mesh.clone(), ..*self }),
            _ => Cow::Borrowed(self),
        }
    }

    /// The light, if it is a rectangle, or a triangle that does not look large from `p`.
    #[inline(always)]
    pub fn flat(&self, p: Vec3) -> Option<FlatLight> {
        match &self.shape {
            AreaShape::Triangle(v, n, area) => {
                let center = (v[0] + v[1] + v[2]) * (1.0 / 3.0);
                // A small triangle is flat too: a corner and two edges, sampled by area.
                let flat = || FlatLight {
                    corner: v[0],
                    edges: [v[1] - v[0], v[2] - v[0]],
                    n: *n,
                    area: *area,
                    is_triangle: true,
                };
                (!Self::looks_large(center, *n, *area, p)).then(flat)
            }
            AreaShape::Rectangle { corner, ex, ey, n, area } => {
                Some(FlatLight { corner: *corner, edges: [*ex, *ey], n: *n, area: *area, is_triangle: false })
            }
            _ => None,
        }
    }

    /// True if the light looks large from `p`: a pure function of `p`, so that sampling and density agree.
    #[inline(always)]
    fn looks_large(center: Vec3, n: Vec3, area: f32, p: Vec3) -> bool {
        let d = p - center;
        let d2 = d.length_squared();
        // area·|cos|/d² > limit, without the root: |n·d| area > limit d³.
        let c = n.dot(d).abs() * area;
        c * c > SOLID_ANGLE_FROM * SOLID_ANGLE_FROM * d2 * d2 * d2
    }

    /// Light that arrives at `p`.
    #[inline]
    pub fn sample(
        &self,
        emitter: &Emitter,
        p: Vec3,
        u: Vec2,
        lambda: &Wavelengths,
        textures: &Textures,
    ) -> Option<LightSample> {
        if let Some(flat) = self.flat(p) {
            let FlatSample { q, uv, wi, distance, pdf } = flat.sample(p, u, flat.is_large(p));
            if pdf <= 0.0 {
                return None;
            }
            let radiance = emitter.drawn(flat.n, -wi, || self.texture_context(q, uv), lambda, textures);
            return (!radiance.is_black()).then_some(LightSample { wi, distance, radiance, pdf, is_delta: false });
        }
        let (q, n, pdf, uv) = match &self.shape {
            AreaShape::Triangle(v, n, area) => {
                // Large triangles are sampled by spherical area; where that degenerates, by area.
                let (b, pdf) = match warp::spherical_triangle(*v, p, u) {
                    Some((b, pdf)) => (b, Ok(pdf)),
                    None => (warp::uniform_triangle(u), Err(*area)),
                };
                // Interpolate the corners by the barycentric coordinates.
                let q = v[0] + (v[1] - v[0]) * b[1] + (v[2] - v[0]) * b[2];
                (q, *n, pdf, Vec2::new(b[1], b[2]))
            }
            AreaShape::Rectangle { .. } => return None,
            AreaShape::Sphere(c, r, inward) => {
                // Spheres take the cone; their samples carry the density in solid angle already.
                let (wi, distance, n, pdf) = sample_sphere(*c, *r, p, u, self.far_share);
                if !(pdf > 0.0 && pdf.is_finite() && distance > 0.0) {
                    return None;
                }
                let n = if *inward { -n } else { n };
                let at = || TextureContext::new(p + wi * distance, Vec2::ZERO);
                let radiance = emitter.drawn(n, -wi, at, lambda, textures);
                return (!radiance.is_black()).then_some(LightSample { wi, distance, radiance, pdf, is_delta: false });
            }
            AreaShape::Quadric(q) => match whole_sphere(q) {
                // A quadric that is a whole sphere after placement is sampled as a sphere.
                Some((c, r)) => {
                    let (wi, distance, n, pdf) = sample_sphere(c, r, p, u, self.far_share);
                    let s = q.surface_at(q.place.inverse().vector(n * r));
                    (p + wi * distance, s.n, Ok(pdf), s.uv)
                }
                None => {
                    // Other quadrics are sampled by area in object space, with the stretch of the placement in the
                    // density.
                    let s = q.surface_at(q.sample(u));
                    (s.p, s.n, Err(q.area_at(s.n)), s.uv)
                }
            },
            AreaShape::Swept(swept) => {
                // Swept surfaces are sampled by area, with a density that depends on the normal.
                let s = swept.sample(u);
                (s.p, s.n, Err(swept.area_at(s.n)), s.uv)
            }
            AreaShape::Moving(_) => return self.at(lambda.time).sample(emitter, p, u, lambda, textures),
        };
        let to = q - p;
        let d2 = to.length_squared();
        if d2 <= 0.0 {
            return None;
        }
        let distance = d2.sqrt();
        let wi = to / distance;
        // Convert a density per area to one per solid angle.
        let cos = n.dot(wi).abs();
        let pdf = match pdf {
            Ok(pdf) => pdf,
            Err(area) => d2 / (cos * area),
        };
        if !(pdf > 0.0 && pdf.is_finite()) || cos == 0.0 {
            return None;
        }
        let radiance = emitter.drawn(n, -wi, || self.texture_context(q, uv), lambda, textures);
        (!radiance.is_black()).then_some(LightSample { wi, distance, radiance, pdf, is_delta: false })
    }

    /// Texture context of a sampled point. `uv` are barycentric coordinates on triangles, surface parameters on
    /// quadrics.
    pub(super) fn texture_context(&self, q: Vec3, uv: Vec2) -> TextureContext<'_> {
        match (&self.mesh, &self.shape) {
            (Some((mesh, t)), AreaShape::Triangle(..)) => {
                TextureContext { mesh: Some((&**mesh, *t, uv)), ..TextureContext::new(q, mesh.uv(*t, uv.x, uv.y)) }
            }
            _ => TextureContext::new(q, uv),
        }
    }

    /// The density per solid angle at `p` of the point at `distance` in direction `wi`, where the normal is `n`, at a
    /// moment of the exposure.
    #[inline]
    pub fn pdf(&self, p: Vec3, wi: Vec3, distance: f32, n: Vec3, time: f32) -> f32 {
        // The same conversion for a point that another strategy has found.
        let by_area = |area: f32| {
            let pdf = distance * distance / (n.dot(wi).abs() * area);
            if pdf.is_finite() { pdf } else { 0.0 }
        };
        let of_sphere = |c: Vec3, r: f32| {
            let d2 = (c - p).length_squared();
            if d2 > r * r * 1.000_01 {
                // The exit point of the ray lies on the far side.
                let is_far = self.far_share > 0.0 && (p + wi * distance - c).dot(wi) > 0.0;
                let share = if is_far { self.far_share } else { 1.0 - self.far_share };
                warp::uniform_cone_pdf(one_minus_cos_max(r, d2)) * share
            } else {
                by_area(4.0 * std::f32::consts::PI * r * r)
            }
        };
        match &self.shape {
            AreaShape::Triangle(v, n, area) => {
                let center = (v[0] + v[1] + v[2]) * (1.0 / 3.0);
                let solid =
                    // Repeat the decision that sampling made, so that the density is that of the strategy used.
                    if Self::looks_large(center, *n, *area, p) { warp::spherical_triangle_pdf(*v, p) } else { None };
                solid.unwrap_or_else(|| by_area(*area))
            }
            AreaShape::Rectangle { corner, ex, ey, n, area } => {
                if Self::looks_large(*corner + (*ex + *ey) * 0.5, *n, *area, p) {
                    let s = warp::SphericalRectangle::new(*corner, *ex, *ey, p).solid_angle;
                    if s > 0.0 { 1.0 / s } else { 0.0 }
                } else {
                    by_area(*area)
                }
            }
            AreaShape::Sphere(c, r, _) => of_sphere(*c, *r),
            AreaShape::Quadric(q) => match whole_sphere(q) {
                Some((c, r)) => of_sphere(c, r),
                None => by_area(q.area_at(n)),
            },
            AreaShape::Swept(swept) => by_area(swept.area_at(n)),
            AreaShape::Moving(_) => self.at(time).pdf(p, wi, distance, n, time),
        }
    }

    /// For emission along the normal alone: the point of the surface that shines at `p`, if any.
    pub fn along_normal(
        &self,
        emitter: &Emitter,
        p: Vec3,
        lambda: &Wavelengths,
        textures: &Textures,
    ) -> Option<LightSample> {
        let (n, inside, distance) = match &self.shape {
            AreaShape::Triangle(v, n, _) => {
                // Project the point onto the plane and test it against the three edges.
                let distance = n.dot(p - v[0]);
                let q = p - *n * distance;
                let side = |a: Vec3, b: Vec3| (b - a).cross(q - a).dot((v[1] - v[0]).cross(v[2] - v[0]));
                let inside = side(v[0], v[1]) >= 0.0 && side(v[1], v[2]) >= 0.0 && side(v[2], v[0]) >= 0.0;
                (*n, inside, distance)
            }
            AreaShape::Rectangle { corner, ex, ey, n, .. } => {
                let distance = n.dot(p - *corner);
                let q = p - *n * distance - *corner;
                // Coordinates along the two orthogonal edges.
                let (s, t) = (q.dot(*ex) / ex.length_squared(), q.dot(*ey) / ey.length_squared());
                (*n, (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t), distance)
            }
            AreaShape::Quadric(q) => {
                // The plane through the middle of the quadric; a ray back along its normal tells whether the point lies
                // before it.
                let center = q.surface_at(q.sample(Vec2::splat(0.5)));
                let distance = center.n.dot(p - center.p);
                let hit = q.intersect(&Ray::new(p, -center.n));
                (center.n, hit.is_some(), distance)
            }
            AreaShape::Moving(_) => return self.at(lambda.time).along_normal(emitter, p, lambda, textures),
            AreaShape::Sphere(..) | AreaShape::Swept(_) => return None,
        };
        if !inside || distance <= 0.0 {
            return None;
        }
        let at = || TextureContext::new(p - n * distance, Vec2::ZERO);
        // The light leaves along the normal alone: a delta distribution, without density.
        let radiance = emitter.drawn(n, n, at, lambda, textures);
        (!radiance.is_black()).then_some(LightSample { wi: -n, distance, radiance, pdf: 1.0, is_delta: true })
    }

    /// Bounds for choosing among lights.
    pub fn bounds(&self, emitter: &Emitter) -> LightBounds {
        let (bounds, axis, cos_o, area) = match &self.shape {
            AreaShape::Triangle(v, n, area) => (Bounds3::from_points(*v), *n, 1.0, *area),
            AreaShape::Rectangle { corner, ex, ey, n, area } => {
                let c = [*corner, *corner + *ex, *corner + *ey, *corner + *ex + *ey];
                (Bounds3::from_points(c), *n, 1.0, *area)
            }
            // A sphere shines everywhere; what a point sees of it is its disk.
            AreaShape::Sphere(c, r, _) => {
                let b = Bounds3::new(*c - Vec3::splat(*r), *c + Vec3::splat(*r));
                (b, Vec3::Z, -1.0, std::f32::consts::PI * r * r)
            }
            AreaShape::Quadric(q) => match q.kind {
                QuadricKind::Disk { .. } => (q.bounds(), q.surface_at(q.sample(Vec2::ZERO)).n, 1.0, q.area()),
                // Convex surfaces show a quarter of their area in the mean over directions (Cauchy).
                _ => (q.bounds(), Vec3::Z, -1.0, q.area() * 0.25),
            },
            AreaShape::Swept(swept) => (swept.level().bounds(), Vec3::Z, -1.0, swept.area() * 0.25),
            // Bounds over all moments of the exposure.
            AreaShape::Moving(moving) => {
                let of = |shape| Self { shape, mesh: None, ..*self }.bounds(emitter);
                return moving.bounds(of);
            }
        };
        LightBounds {
            bounds,
            axis,
            cos_o,
            cos_e: 0.0,
            intensity: emitter.luminance.max(0.0) * area,
            two_sided: emitter.two_sided,
        }
    }
}
