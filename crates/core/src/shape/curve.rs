//! Curves with a width, such as hair and grass: cubic Béziers that are met where a ray passes within half a width of
//! them (Nakamaru and Ohno 2002; Pharr, Jakob, Humphreys, PBR 4th ed., 6.7).

use super::SurfacePoint;
use std::f32::consts::{FRAC_PI_2, SQRT_2};
use steradian_accel::UserHit;
use steradian_math::{Bounds3, Frame, Ray, Vec2, Vec3, transform::Affine};

/// Basis of a curve's control points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveBasis {
    /// Bézier segments; neighbours share a control point.
    Bezier,
    /// A uniform B-spline; neighbouring segments share all control points but one.
    BSpline,
}

/// Cross section of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveKind {
    /// A strip that faces the ray.
    Flat,
    /// A flat strip with normals that turn over the width as they would on a cylinder.
    Cylinder,
    /// A strip that faces the ray, with the outward normals of a round strand.
    Round,
    /// A strip that faces along given normals.
    Ribbon,
}

/// A curve in object space.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveParams {
    /// Control points.
    pub points: Vec<Vec3>,
    /// Polynomial degree, 2 or 3.
    pub degree: u32,
    /// Basis of the control points.
    pub basis: CurveBasis,
    /// Cross section.
    pub kind: CurveKind,
    /// Full width at the start and at the end, linear between.
    pub width: [f32; 2],
    /// For ribbons a normal at each end of each segment, shared with the neighbour; ignored for other kinds.
    pub normals: Vec<Vec3>,
}

impl CurveParams {
    /// Number of segments.
    ///
    /// # Errors
    /// A message about the first thing that is wrong with the curve.
    pub fn segments(&self) -> Result<usize, String> {
        let (n, degree) = (self.points.len(), self.degree as usize);
        if !(2..=3).contains(&degree) {
            return Err(format!("a curve of degree {degree}: only 2 and 3 are supported"));
        }
        if n <= degree {
            return Err(format!("{n} control points: a curve of degree {degree} needs at least {}", degree + 1));
        }
        let segments = match self.basis {
            CurveBasis::BSpline => n - degree,
            CurveBasis::Bezier if (n - 1) % degree == 0 => (n - 1) / degree,
            CurveBasis::Bezier => {
                return Err(format!(
                    "{n} control points: a Bézier curve of degree {degree} has k·{degree} + 1 of them"
                ));
            }
        };
        if !self.points.iter().chain(&self.normals).all(|p| p.is_finite()) {
            return Err("a control point or normal of a curve is not finite".into());
        }
        if !self.width.iter().all(|w| w.is_finite() && *w >= 0.0) {
            return Err(format!(
                "curve widths {} and {}: they must be finite and not negative",
                self.width[0], self.width[1]
            ));
        }
        let (found, needed) = (self.normals.len(), segments + 1);
        if self.kind == CurveKind::Ribbon && found != needed {
            return Err(format!("{found} normals on a ribbon of {segments} segments: {needed} are needed"));
        }
        Ok(segments)
    }

    /// A segment as a cubic Bézier.
    pub(super) fn bezier(&self, segment: usize) -> [Vec3; 4] {
        let degree = self.degree as usize;
        let first = if self.basis == CurveBasis::Bezier { segment * degree } else { segment };
        let p = &self.points[first..=first + degree];
        match (self.basis, p) {
            (CurveBasis::Bezier, &[a, b, c]) => elevate(a, b, c),
            (CurveBasis::BSpline, &[a, b, c]) => elevate(a.midpoint(b), b, b.midpoint(c)),
            (CurveBasis::BSpline, &[a, b, c, d]) => [
                (a + b * 4.0 + c) / 6.0, //
                (b * 2.0 + c) / 3.0,
                (b + c * 2.0) / 3.0,
                (b + c * 4.0 + d) / 6.0,
            ],
            _ => [p[0], p[1], p[2], p[degree]],
        }
    }
}

/// A quadratic Bézier as a cubic.
fn elevate(a: Vec3, b: Vec3, c: Vec3) -> [Vec3; 4] {
    [a, a.lerp(b, 2.0 / 3.0), c.lerp(b, 2.0 / 3.0), c]
}

/// Most levels by which a ray's search halves a piece.
const MAX_DEPTH: usize = 10;
/// Largest [`Curves::new`] split depth.
const MAX_SPLIT_DEPTH: u32 = 10;
/// Most pieces in one [`Curves`].
const MAX_PIECES: u64 = 1 << 28;

/// One cubic Bézier.
#[derive(Clone, Copy, Debug)]
struct Segment {
    /// Index of the first of its four control points.
    first: u32,
    /// Width at both ends.
    width: [f32; 2],
}

impl Segment {
    #[inline]
    fn width(&self, u: f32) -> f32 {
        self.width[0] + (self.width[1] - self.width[0]) * u
    }
}

/// The normals at both ends of a ribbon's segment, between which it turns at constant speed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Twist {
    n: [Vec3; 2],
    angle: f32,
}

impl Twist {
    pub(super) fn new(a: Vec3, b: Vec3) -> Self {
        let n = [a.normalize_or_zero(), b.normalize_or_zero()];
        Self { n, angle: n[0].cross(n[1]).length().atan2(n[0].dot(n[1])) }
    }

    #[inline]
    pub(super) fn at(&self, u: f32) -> Vec3 {
        let sin = self.angle.sin();
        if sin.abs() < 1e-4 {
            // Parallel, where the interpolation is linear, or opposed, where there is no shortest way.
            return (self.n[0] * (1.0 - u) + self.n[1] * u).try_normalize().unwrap_or(self.n[0]);
        }
        (self.n[0] * ((1.0 - u) * self.angle).sin() + self.n[1] * (u * self.angle).sin()) / sin
    }
}

/// Curves of one kind under one placement. Each primitive is a piece of a segment: segments are cut so that boxes are
/// tight.
///
/// Everything is stored and intersected in object space, where widths are meant: under a placement that is not a
/// similarity, curves are stretched as pbrt does it.
#[derive(Clone, Debug)]
pub struct Curves {
    /// Control points of cubic Béziers; neighbours share theirs.
    points: Vec<Vec3>,
    segments: Vec<Segment>,
    /// For ribbons, one per segment.
    twists: Vec<Twist>,
    kind: CurveKind,
    place: Affine,
    split_depth: u32,
    flip: bool,
}

impl Curves {
    /// A curve placed by `place`, each segment cut into `2^split_depth` pieces. `reverse` turns normals over.
    ///
    /// # Errors
    /// A message, where the curve is not valid ([`CurveParams::segments`]) or cut into too many pieces.
    pub fn new(
        curve: &CurveParams,
        place: &Affine,
        split_depth: u32,
        swaps_handedness: bool,
        reverse: bool,
    ) -> Result<Self, String> {
        if split_depth > MAX_SPLIT_DEPTH {
            return Err(format!("curve split depth {split_depth}: at most {MAX_SPLIT_DEPTH} is supported"));
        }
        let mut curves = Self {
            points: Vec::new(),
            segments: Vec::new(),
            twists: Vec::new(),
            kind: curve.kind,
            place: *place,
            split_depth,
            flip: reverse ^ swaps_handedness,
        };
        curves.push(curve)?;
        Ok(curves)
    }

    /// Adds a curve of the same kind, under the same placement. Hair comes as many curves; together they take a
    /// fraction of the memory.
    ///
    /// # Errors
    /// A message, where the curve is not valid, of another kind, or one too many; nothing is added then.
    pub fn push(&mut self, curve: &CurveParams) -> Result<(), String> {
        let count = curve.segments()?;
        if curve.kind != self.kind {
            return Err("curves of different kinds cannot be kept together".into());
        }
        if ((self.segments.len() + count) as u64) << self.split_depth > MAX_PIECES {
            return Err(format!("more than {MAX_PIECES} pieces of curves in one shape"));
        }
        let first = self.points.len() as u32;
        for i in 0..count {
            let p = curve.bezier(i);
            self.points.extend_from_slice(if i == 0 { &p } else { &p[1..] });
            let width = [i, i + 1].map(|j| {
                let at = j as f32 / count as f32;
                curve.width[0] * (1.0 - at) + curve.width[1] * at
            });
            self.segments.push(Segment { first: first + 3 * i as u32, width });
        }
        if self.kind == CurveKind::Ribbon {
            self.twists.extend(curve.normals.windows(2).map(|n| Twist::new(n[0], n[1])));
        }
        Ok(())
    }

    /// Number of primitives.
    pub fn count(&self) -> u32 {
        (self.segments.len() as u32) << self.split_depth
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.points.len() * size_of::<Vec3>()
            + self.segments.len() * size_of::<Segment>()
            + self.twists.len() * size_of::<Twist>()
            + size_of::<Self>()
    }

    /// Index of the segment of a primitive, and its parameter interval there.
    #[inline]
    fn piece(&self, prim: u32) -> (usize, f32, f32) {
        let pieces = 1u32 << self.split_depth;
        let at = prim & (pieces - 1);
        let step = 1.0 / pieces as f32;
        ((prim >> self.split_depth) as usize, at as f32 * step, (at + 1) as f32 * step)
    }

    #[inline]
    fn control_points(&self, segment: &Segment) -> [Vec3; 4] {
        let first = segment.first as usize;
        [self.points[first], self.points[first + 1], self.points[first + 2], self.points[first + 3]]
    }

    /// The box around a primitive, where it is placed.
    pub fn bounds(&self, prim: u32) -> Bounds3 {
        let (index, u0, u1) = self.piece(prim);
        let segment = &self.segments[index];
        let points = sub_bezier(&self.control_points(segment), u0, u1);
        let hull = Bounds3::from_points(points.map(|p| self.place.point(p)));
        // The image of a ball reaches as far along an axis as the matching row of the linear part is long.
        let [x, y, z] = [self.place.m.x_axis, self.place.m.y_axis, self.place.m.z_axis].map(|c| c.truncate());
        let rows = (x * x + y * y + z * z).map(f32::sqrt);
        let reach = rows * (0.5 * segment.width(u0).max(segment.width(u1)));
        let reach = reach + (hull.min.abs().max(hull.max.abs()) + reach) * 1e-6;
        Bounds3 { min: hull.min - reach, max: hull.max + reach }
    }

    /// The nearest hit in `(0, t_max)` on a primitive: `u` along its segment, `v` across the width, both in `[0, 1]`.
    ///
    /// The control points are seen along the ray, where the curve is halved until it is as good as straight, following
    /// only the halves whose boxes hold the ray.
    pub fn intersect(&self, prim: u32, ray: &Ray) -> Option<UserHit> {
        let (index, u0, u1) = self.piece(prim);
        let segment = &self.segments[index];
        let twist = self.twists.get(index);
        let origin = self.place.inv.transform_point3(ray.origin);
        let direction = self.place.inv.transform_vector3(ray.direction);
        let length = direction.length();
        let widest = segment.width[0].max(segment.width[1]);
        if !(length > 0.0 && length.is_finite() && widest > 0.0) {
            return None;
        }

        // Coordinates in which the ray is the z axis and the piece lies along x, which makes its boxes thin.
        let points = sub_bezier(&self.control_points(segment), u0, u1);
        let z = direction / length;
        let y = z.cross(points[3] - points[0]).try_normalize().unwrap_or_else(|| Frame::from_z(z).x);
        let x = y.cross(z);
        let points = points.map(|p| {
            let q = p - origin;
            Vec3::new(x.dot(q), y.dot(q), z.dot(q))
        });

        // One halving cuts the distance to the chord by four: halve until it is below a twentieth of the width.
        let bend = (points[0] - points[1] * 2.0 + points[2]).abs().max((points[1] - points[2] * 2.0 + points[3]).abs());
        let levels = floor_log2(SQRT_2 * 6.0 * bend.max_element() / (8.0 * 0.05 * widest)) / 2;
        let levels = levels.clamp(0, MAX_DEPTH as i32) as u32;

        let mut z_max = length * ray.t_max;
        let radius = |span: &Span| 0.5 * segment.width(span.u0).max(segment.width(span.u1));
        let whole = Span { points, u0, u1, levels };
        if !whole.may_meet(radius(&whole), z_max) {
            return None;
        }
        let mut stack = [whole; MAX_DEPTH + 1];
        let mut top = 1;
        let mut best = None;
        while top > 0 {
            top -= 1;
            let span = stack[top];
            if span.levels > 0 {
                for half in span.halves() {
                    if half.may_meet(radius(&half), z_max) {
                        stack[top] = half;
                        top += 1;
                    }
                }
            } else if let Some((depth, u, v)) = span.meet(segment, twist, z)
                && depth > 0.0
                && depth < z_max
            {
                z_max = depth;
                best = Some(UserHit { t: depth / length, u, v });
            }
        }
        best
    }

    /// The surface at a hit `(u, v)` of a primitive that a ray met at `t`.
    ///
    /// As in pbrt, normals of flat curves point along the ray, not against it, and `error` is the width, so that rays
    /// which leave the point clear the curve.
    pub fn surface(&self, prim: u32, u: f32, v: f32, ray: &Ray, t: f32) -> SurfacePoint {
        let (index, ..) = self.piece(prim);
        let segment = &self.segments[index];
        let points = self.control_points(segment);
        let origin = self.place.inv.transform_point3(ray.origin);
        let direction = self.place.inv.transform_vector3(ray.direction);
        let z = direction.normalize_or_zero();

        let mut dpdu = evaluate(&points, u).1;
        if dpdu == Vec3::ZERO {
            // Control points coincide at an end.
            dpdu = points[3] - points[0];
        }
        let mut width = segment.width(u);
        let along = dpdu.normalize_or_zero();
        let facing = match self.twists.get(index) {
            Some(twist) => {
                let n = twist.at(u);
                width *= n.dot(z).abs();
                n
            }
            None => z,
        };
        // Across the curve; any way across where the ray runs along it.
        let across = facing.cross(along).try_normalize().unwrap_or_else(|| Frame::from_z(facing).x);
        let mut n = along.cross(across);
        match self.kind {
            // The angle is linear in v, as in pbrt; turned to the ray, the normal leans to the other side.
            CurveKind::Cylinder => {
                let (sin, cos) = ((2.0 * v - 1.0) * FRAC_PI_2).sin_cos();
                n = n * cos + across * sin;
            }
            // The place across is the sine of the angle, on the side of the ray's origin.
            CurveKind::Round => {
                let sin = (2.0 * v - 1.0).clamp(-1.0, 1.0);
                n = across * sin - n * (1.0 - sin * sin).sqrt();
            }
            CurveKind::Flat | CurveKind::Ribbon => {}
        }

        let n = self.place.normal(n).normalize_or_zero() * if self.flip { -1.0 } else { 1.0 };
        let p = origin + direction * t;
        SurfacePoint {
            p: ray.at(t),
            error: self.place.point_error(p, Vec3::splat(width)),
            n,
            ns: n,
            dpdu: self.place.vector(dpdu),
            uv: Vec2::new(u, v),
        }
    }

    /// ∂p/∂v: across the curve, as long as it is wide.
    pub fn dpdv(&self, prim: u32, u: f32, n: Vec3, dpdu: Vec3) -> Vec3 {
        let width = self.segments[self.piece(prim).0].width(u);
        self.place.vector(Vec3::X * width).length() * dpdu.cross(n).normalize_or_zero()
    }
}

/// A part of a curve in coordinates in which the ray is the z axis.
#[derive(Clone, Copy)]
struct Span {
    points: [Vec3; 4],
    u0: f32,
    u1: f32,
    /// Number of halvings that remain.
    levels: u32,
}

impl Span {
    /// Tests whether the ray up to `z_max` passes through the box around the control points, widened by `radius`.
    #[inline]
    fn may_meet(&self, radius: f32, z_max: f32) -> bool {
        let [a, b, c, d] = self.points;
        let min = a.min(b).min(c.min(d)) - radius;
        let max = a.max(b).max(c.max(d)) + radius;
        min.x <= 0.0 && max.x >= 0.0 && min.y <= 0.0 && max.y >= 0.0 && max.z >= 0.0 && min.z <= z_max
    }

    /// De Casteljau's construction at the middle.
    #[inline]
    fn halves(&self) -> [Self; 2] {
        let [a, b, c, d] = self.points;
        let (ab, bc, cd) = ((a + b) * 0.5, (b + c) * 0.5, (c + d) * 0.5);
        let (abc, bcd) = ((ab + bc) * 0.5, (bc + cd) * 0.5);
        let middle = (abc + bcd) * 0.5;
        let u = 0.5 * (self.u0 + self.u1);
        let levels = self.levels - 1;
        [
            Self { points: [a, ab, abc, middle], u1: u, levels, ..*self },
            Self { points: [middle, bcd, cd, d], u0: u, levels, ..*self },
        ]
    }

    /// Intersection of the ray with a span that is all but straight: depth along the ray, `u` and `v`.
    #[inline]
    fn meet(&self, segment: &Segment, twist: Option<&Twist>, direction: Vec3) -> Option<(f32, f32, f32)> {
        let [a, b, c, d] = self.points.map(|p| p.truncate());
        // The origin must lie between the lines that cut the span off, at right angles to its ends.
        if (b - a).dot(-a) < 0.0 || (c - d).dot(-d) < 0.0 {
            return None;
        }
        // The point of the chord that is nearest stands for the one of the curve.
        let chord = d - a;
        let len2 = chord.length_squared();
        if len2 == 0.0 {
            return None;
        }
        let w = (-a.dot(chord) / len2).clamp(0.0, 1.0);
        let u = self.u0 + (self.u1 - self.u0) * w;
        let mut width = segment.width(u);
        if let Some(twist) = twist {
            width *= twist.at(u).dot(direction).abs();
        }
        let (p, tangent) = evaluate(&self.points, w);
        let distance2 = p.truncate().length_squared();
        if distance2 > 0.25 * width * width || width <= 0.0 {
            return None;
        }
        let side = tangent.y * p.x - tangent.x * p.y;
        let v = 0.5 + (distance2.sqrt() / width).copysign(side);
        Some((p.z, u, v.clamp(0.0, 1.0)))
    }
}

/// Point and derivative of a cubic Bézier.
#[inline]
pub(super) fn evaluate([a, b, c, d]: &[Vec3; 4], u: f32) -> (Vec3, Vec3) {
    let w = 1.0 - u;
    let (ab, bc, cd) = (*a * w + *b * u, *b * w + *c * u, *c * w + *d * u);
    let (abc, bcd) = (ab * w + bc * u, bc * w + cd * u);
    (abc * w + bcd * u, (bcd - abc) * 3.0)
}

/// The control points of the part of a cubic Bézier between two parameters, by blossoming.
#[inline]
fn sub_bezier([a, b, c, d]: &[Vec3; 4], u0: f32, u1: f32) -> [Vec3; 4] {
    let mix = |p: Vec3, q: Vec3, u: f32| p * (1.0 - u) + q * u;
    let blossom = |[ab, bc, cd]: [Vec3; 3], s: f32, t: f32| mix(mix(ab, bc, s), mix(bc, cd, s), t);
    let at = |u: f32| [mix(*a, *b, u), mix(*b, *c, u), mix(*c, *d, u)];
    let (from, to) = (at(u0), at(u1));
    [blossom(from, u0, u0), blossom(from, u0, u1), blossom(to, u0, u1), blossom(to, u1, u1)]
}

/// The binary exponent of a number that is not negative.
#[inline]
fn floor_log2(x: f32) -> i32 {
    (x.to_bits() >> 23) as i32 - 127
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::{DVec3, Transform, hash::HashRng, warp};

    fn vec3(rng: &mut HashRng) -> Vec3 {
        Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 2.0 - 1.0
    }

    fn cubic(points: Vec<Vec3>, kind: CurveKind, width: [f32; 2]) -> CurveParams {
        let normals = if kind == CurveKind::Ribbon { vec![Vec3::Z; (points.len() - 1) / 3 + 1] } else { vec![] };
        CurveParams { points, degree: 3, basis: CurveBasis::Bezier, kind, width, normals }
    }

    fn straight(kind: CurveKind) -> Curves {
        let points = (0..4).map(|i| Vec3::X * (i as f32 - 1.5)).collect();
        Curves::new(&cubic(points, kind, [0.5, 0.5]), &Affine::IDENTITY, 3, false, false).unwrap()
    }

    fn nearest(curves: &Curves, ray: &Ray) -> Option<(u32, UserHit)> {
        (0..curves.count())
            .filter_map(|prim| Some((prim, curves.intersect(prim, ray)?)))
            .min_by(|a, b| a.1.t.total_cmp(&b.1.t))
    }

    /// Distance of a point from a line.
    fn distance(ray: &Ray, p: Vec3) -> f32 {
        (p - ray.origin).cross(ray.direction.normalize()).length()
    }

    #[test]
    fn hits_agree_with_dense_sampling() {
        const DENSE: usize = 3000;
        let mut rng = HashRng::new(1);
        let (mut hits, mut misses) = (0, 0);
        for case in 0..30 {
            let width = [0.02 + 0.05 * rng.next_f32(), 0.02 + 0.05 * rng.next_f32()];
            let params = cubic((0..4).map(|_| vec3(&mut rng)).collect(), CurveKind::Flat, width);
            let points: [Vec3; 4] = params.points.clone().try_into().unwrap();
            let curves = Curves::new(&params, &Affine::IDENTITY, case % 4, false, false).unwrap();
            assert_eq!(curves.count(), 1 << (case % 4));
            let samples: Vec<Vec3> = (0..=DENSE).map(|i| evaluate(&points, i as f32 / DENSE as f32).0).collect();
            for _ in 0..60 {
                let origin = vec3(&mut rng) * 5.0;
                let near = samples[(rng.next_f32() * DENSE as f32) as usize] + vec3(&mut rng) * 0.05;
                let ray = Ray::new(origin, (near - origin) * 0.7);
                // How far within the width the ray passes, away from the ends.
                let depth = |i: usize| {
                    let w = width[0] + (width[1] - width[0]) * i as f32 / DENSE as f32;
                    distance(&ray, samples[i]) / (0.5 * w)
                };
                let closest = (0..=DENSE).min_by(|&i, &j| depth(i).total_cmp(&depth(j))).unwrap();
                match nearest(&curves, &ray) {
                    Some((prim, hit)) => {
                        hits += 1;
                        let (p, _) = evaluate(&points, hit.u);
                        let w = width[0] + (width[1] - width[0]) * hit.u;
                        assert!(distance(&ray, p) < 0.5 * w * 1.1);
                        assert!((ray.at(hit.t) - p).length() < 0.5 * w * 1.2);
                        let s = curves.surface(prim, hit.u, hit.v, &ray, hit.t);
                        assert!((s.n.length() - 1.0).abs() < 1e-5 && s.n.dot(s.dpdu).abs() < 1e-4 * s.dpdu.length());
                        // Just before it there is nothing, or another crossing.
                        let cut = Ray { t_max: hit.t * 0.999, ..ray };
                        assert!(nearest(&curves, &cut).is_none());
                        // The boxes hold the hit.
                        assert!(curves.bounds(prim).contains(ray.at(hit.t)), "{case}");
                    }
                    None => {
                        misses += 1;
                        let inner = (DENSE / 20..DENSE - DENSE / 20).contains(&closest);
                        assert!(!inner || depth(closest) > 0.85, "{case} {closest} {}", depth(closest));
                    }
                }
            }
        }
        assert!(hits > 500 && misses > 300, "{hits} {misses}");
    }

    #[test]
    fn flat_curves_face_the_ray_and_v_runs_across() {
        let curves = straight(CurveKind::Flat);
        let mut last = -1.0;
        for i in -24..=24 {
            let y = i as f32 / 100.0;
            let ray = Ray::new(Vec3::new(0.1, y, 8.0), Vec3::NEG_Z * 2.0);
            let (prim, hit) = nearest(&curves, &ray).unwrap();
            assert!((hit.t - 4.0).abs() < 1e-5 && (hit.u - 1.6 / 3.0).abs() < 1e-5);
            let s = curves.surface(prim, hit.u, hit.v, &ray, hit.t);
            assert!((s.n - ray.direction * 0.5).length() < 1e-5);
            assert!((s.dpdu - Vec3::X * 3.0).length() < 1e-5);
            assert!(s.error.min_element() >= 0.5);
            // v grows towards z × ∂p/∂u with z along the ray, here −y.
            assert!((hit.v - (0.5 - y / 0.5)).abs() < 1e-5);
            assert!(last < 0.0 || hit.v < last);
            last = hit.v;
        }
        for y in [0.26, -0.26] {
            assert!(nearest(&curves, &Ray::new(Vec3::new(0.1, y, 8.0), Vec3::NEG_Z)).is_none());
        }
        // Cut off square at the ends, and nothing behind the origin.
        assert!(nearest(&curves, &Ray::new(Vec3::new(1.51, 0.0, 8.0), Vec3::NEG_Z)).is_none());
        assert!(nearest(&curves, &Ray::new(Vec3::new(1.49, 0.0, 8.0), Vec3::NEG_Z)).is_some());
        assert!(nearest(&curves, &Ray::new(Vec3::new(0.0, 0.0, 8.0), Vec3::Z)).is_none());
    }

    #[test]
    fn cylinder_normals_turn_over_the_width() {
        let curves = straight(CurveKind::Cylinder);
        for y in [-0.24_f32, -0.1, 0.0, 0.17, 0.24] {
            let ray = Ray::new(Vec3::new(0.1, y, 8.0), Vec3::NEG_Z);
            let (prim, hit) = nearest(&curves, &ray).unwrap();
            let s = curves.surface(prim, hit.u, hit.v, &ray, hit.t);
            // The angle is linear in v, and normals at the rims point outward.
            let angle = y / 0.25 * FRAC_PI_2;
            assert!((s.n - Vec3::new(0.0, angle.sin(), -angle.cos())).length() < 1e-4, "{y} {}", s.n);
        }
    }

    #[test]
    fn round_strands_have_the_normals_of_a_tube() {
        let curves = straight(CurveKind::Round);
        for y in [-0.249_f32, -0.1, 0.0, 0.17, 0.249] {
            for (z, direction) in [(8.0, Vec3::NEG_Z), (-8.0, Vec3::Z)] {
                let ray = Ray::new(Vec3::new(0.1, y, z), direction);
                let (prim, hit) = nearest(&curves, &ray).unwrap();
                let s = curves.surface(prim, hit.u, hit.v, &ray, hit.t);
                let sin = y / 0.25;
                let expected = Vec3::new(0.0, sin, -direction.z * (1.0 - sin * sin).sqrt());
                assert!((s.n - expected).length() < 1e-3, "{y} {}", s.n);
            }
        }
    }

    #[test]
    fn ribbons_look_narrow_from_the_side() {
        let mut params = cubic((0..4).map(|i| Vec3::X * i as f32).collect(), CurveKind::Ribbon, [0.5, 0.5]);
        let curves = Curves::new(&params, &Affine::IDENTITY, 2, false, false).unwrap();
        for degrees in [0.0_f32, 30.0, 60.0, 80.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let direction = Vec3::new(0.0, sin, -cos);
            let across = Vec3::new(0.0, cos, sin);
            for (k, expected) in [(0.98, true), (1.02, false)] {
                let ray = Ray::new(Vec3::X * 1.4 + across * (0.25 * cos * k) - direction * 5.0, direction);
                let found = nearest(&curves, &ray);
                assert_eq!(found.is_some(), expected, "{degrees} {k}");
                if let Some((prim, hit)) = found {
                    let s = curves.surface(prim, hit.u, hit.v, &ray, hit.t);
                    assert!((s.n - Vec3::Z).length() < 1e-5, "{}", s.n);
                }
            }
        }
        // A quarter turn from one end to the other.
        params.normals = vec![Vec3::Z, Vec3::Y * 3.0];
        let curves = Curves::new(&params, &Affine::IDENTITY, 2, false, false).unwrap();
        let ray = Ray::new(Vec3::new(1.5, 2.0, 2.0), Vec3::new(0.0, -1.0, -1.0));
        let (prim, hit) = nearest(&curves, &ray).unwrap();
        let n = curves.surface(prim, hit.u, hit.v, &ray, hit.t).n;
        assert!((n - Vec3::new(0.0, 1.0, 1.0).normalize()).length() < 1e-3, "{n}");
    }

    #[test]
    fn bases_and_degrees_describe_the_same_curves() {
        let mut rng = HashRng::new(2);
        let points: Vec<Vec3> = (0..7).map(|_| vec3(&mut rng)).collect();
        let make = |degree, basis| CurveParams {
            points: points.clone(),
            degree,
            basis,
            kind: CurveKind::Flat,
            width: [1.0, 3.0],
            normals: vec![],
        };
        // Uniform B-splines by their basis functions.
        for (degree, count) in [(2, 5), (3, 4)] {
            let spline = make(degree, CurveBasis::BSpline);
            assert_eq!(spline.segments(), Ok(count));
            for i in 0..count {
                for u in [0.0, 0.3, 1.0_f32] {
                    let w = 1.0 - u;
                    let weights = match degree {
                        2 => vec![w * w / 2.0, 0.5 + u * w, u * u / 2.0],
                        _ => vec![
                            w.powi(3) / 6.0,
                            (3.0 * u.powi(3) - 6.0 * u * u + 4.0) / 6.0,
                            (3.0 * w.powi(3) - 6.0 * w * w + 4.0) / 6.0,
                            u.powi(3) / 6.0,
                        ],
                    };
                    let p: Vec3 = weights.iter().zip(&points[i..]).map(|(&w, &p)| p * w).sum();
                    assert!((evaluate(&spline.bezier(i), u).0 - p).length() < 1e-6);
                }
            }
        }
        let quadratic = make(2, CurveBasis::Bezier);
        assert_eq!(quadratic.segments(), Ok(3));
        let (u, w) = (0.3, 0.7);
        let p = points[2] * (w * w) + points[3] * (2.0 * u * w) + points[4] * (u * u);
        assert!((evaluate(&quadratic.bezier(1), u).0 - p).length() < 1e-6);

        // Segments share end points in memory, and widths run on from one to the next.
        let curves = Curves::new(&quadratic, &Affine::IDENTITY, 0, false, false).unwrap();
        assert_eq!(curves.points.len(), 10);
        assert_eq!(curves.segments[2].width[1], 3.0);
        assert_eq!(curves.segments[0].width[1], curves.segments[1].width[0]);
        assert_eq!(curves.control_points(&curves.segments[1])[0], points[2]);
        // A piece is the curve between its parameters.
        let whole = curves.control_points(&curves.segments[1]);
        let part = sub_bezier(&whole, 0.25, 0.5);
        assert!((evaluate(&part, 0.4).0 - evaluate(&whole, 0.35).0).length() < 1e-6);
    }

    #[test]
    fn placements_scale_widths_and_keep_distances() {
        let mut rng = HashRng::new(3);
        let params = cubic((0..7).map(|_| vec3(&mut rng)).collect(), CurveKind::Cylinder, [0.2, 0.1]);
        let plain = Curves::new(&params, &Affine::IDENTITY, 3, false, false).unwrap();
        let transform = Transform::translate(DVec3::new(5.0, -3.0, 2.0))
            * Transform::rotate(DVec3::new(1.0, 2.0, -1.0), 0.7)
            * Transform::scale(DVec3::new(4.0, -2.0, 1.0));
        let place = transform.affine().unwrap();
        let placed = Curves::new(&params, &place, 3, transform.swaps_handedness(), false).unwrap();
        let mut hits = 0;
        for _ in 0..3000 {
            let ray = Ray::new(vec3(&mut rng) * 4.0, vec3(&mut rng));
            let target = plain.bounds((rng.next_f32() * 16.0) as u32).center();
            let ray = Ray::new(ray.origin, target - ray.origin);
            let (a, b) = (nearest(&plain, &ray), nearest(&placed, &place.ray(&ray)));
            if let (Some((prim, a)), Some((_, b))) = (a, b)
                && (a.t - b.t).abs() < 1e-3
            {
                hits += 1;
                let p = place.point(ray.at(a.t));
                assert!(placed.bounds(prim).contains(p));
                let s = placed.surface(prim, a.u, a.v, &place.ray(&ray), a.t);
                let local = plain.surface(prim, a.u, a.v, &ray, a.t);
                assert!((s.p - p).length() < 1e-4 && s.n.dot(s.dpdu).abs() < 1e-4 * s.dpdu.length());
                // The mirrored placement flips normals, which follow the inverse transpose.
                assert!((s.n + place.normal(local.n).normalize()).length() < 1e-3);
            }
        }
        assert!(hits > 1000, "{hits}");
    }

    #[test]
    fn bad_curves_are_refused_and_degenerate_ones_harmless() {
        let good = cubic(vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z], CurveKind::Flat, [1.0, 1.0]);
        let fails = |change: &dyn Fn(&mut CurveParams), depth: u32, part: &str| {
            let mut c = good.clone();
            change(&mut c);
            let error = Curves::new(&c, &Affine::IDENTITY, depth, false, false).unwrap_err();
            assert!(error.contains(part), "{error}");
        };
        fails(&|c| c.degree = 4, 0, "degree 4");
        fails(&|c| c.points.truncate(3), 0, "3 control points");
        fails(&|c| c.points.push(Vec3::ONE), 0, "5 control points");
        fails(&|c| c.points.clear(), 0, "0 control points");
        fails(&|c| c.points[2].y = f32::NAN, 0, "not finite");
        fails(&|c| c.width[1] = -1.0, 0, "-1");
        fails(&|c| c.kind = CurveKind::Ribbon, 0, "0 normals on a ribbon of 1 segments: 2");
        fails(&|_| (), 11, "split depth 11");
        let mut curves = Curves::new(&good, &Affine::IDENTITY, 10, false, false).unwrap();
        assert!(curves.push(&cubic(good.points.clone(), CurveKind::Ribbon, [1.0, 1.0])).is_err());
        curves.push(&good).unwrap();
        assert_eq!(curves.count(), 2048);

        let mut rng = HashRng::new(4);
        let big = f32::MAX;
        for points in [
            [Vec3::ONE; 4],
            [Vec3::ZERO, Vec3::ZERO, Vec3::X, Vec3::X],
            [Vec3::ZERO, Vec3::X, Vec3::X * 2.0, Vec3::ZERO],
            [Vec3::splat(big), Vec3::splat(-big), Vec3::X * big, Vec3::ZERO],
        ] {
            for kind in [CurveKind::Flat, CurveKind::Cylinder, CurveKind::Ribbon] {
                for width in [[0.0, 0.0], [0.3, 0.0], [1e30, 1.0]] {
                    let curves =
                        Curves::new(&cubic(points.to_vec(), kind, width), &Affine::IDENTITY, 1, false, false).unwrap();
                    for _ in 0..50 {
                        let d = warp::uniform_sphere(Vec2::new(rng.next_f32(), rng.next_f32()));
                        let ray = Ray::new(Vec3::new(0.5, 0.0, 0.0) - d, d);
                        for along in [ray, Ray::new(Vec3::NEG_X, Vec3::X)] {
                            if let Some((prim, hit)) = nearest(&curves, &along) {
                                assert!(hit.t > 0.0 && (0.0..=1.0).contains(&hit.u) && (0.0..=1.0).contains(&hit.v));
                                let n = curves.surface(prim, hit.u, hit.v, &along, hit.t).n;
                                assert!(!n.is_nan());
                            }
                        }
                    }
                }
            }
        }
    }
}
