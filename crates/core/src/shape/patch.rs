//! Bilinear patches: the surfaces `p(u, v)` that interpolate four corners, planar or not.

use super::SurfacePoint;
use glam::DVec3;
use steradian_accel::UserHit;
use steradian_math::{Bounds3, Ray, Vec2, Vec3, hash::ONE_MINUS_EPSILON, ray::gamma, transform::Affine};
use steradian_scene::Mesh;

/// Distances to a patch are known to so much of its reach from the origin: far less than the coordinates of either.
const NOISE: f64 = 1e-10;
/// Tolerance of a parameter outside `[0, 1]` before the hit is dropped. It covers the rounding of `f64`, so that rays
/// do not slip between patches that share an edge.
const EDGE: f64 = 1e-9;

/// The bilinear patches of a mesh, placed in the space they are traced in.
#[derive(Clone, Debug, Default)]
pub struct PatchMesh {
    /// Vertex positions.
    pub positions: Vec<Vec3>,
    /// Unit vertex normals: none or one per vertex.
    pub normals: Vec<Vec3>,
    /// Texture coordinates: none or one per vertex.
    pub uvs: Vec<Vec2>,
    /// Vertex indices, in the order p00, p10, p01, p11.
    pub patches: Vec<[u32; 4]>,
    /// True if geometric normals point against `∂p/∂u × ∂p/∂v` (only without vertex normals to follow).
    pub flip: bool,
}

impl PatchMesh {
    /// Places the patches of a mesh whose indices are valid ([`Mesh::validate`]). `reverse` turns normals over; vertex
    /// normals are left out where `flat` is set.
    pub fn new(mesh: &Mesh, place: &Affine, swaps_handedness: bool, reverse: bool, flat: bool) -> Self {
        let sign = if reverse { -1.0 } else { 1.0 };
        let normals = if flat { &[][..] } else { &mesh.normals[..] };
        Self {
            positions: mesh.positions.iter().map(|&p| place.point(Vec3::from(p))).collect(),
            normals: normals.iter().map(|&n| (place.normal(Vec3::from(n)) * sign).normalize_or_zero()).collect(),
            uvs: mesh.uvs.iter().map(|&uv| Vec2::from(uv)).collect(),
            patches: mesh.patches.clone(),
            flip: reverse ^ swaps_handedness,
        }
    }

    /// The corners p00, p10, p01, p11 of a patch.
    #[inline]
    pub fn corners(&self, patch: u32) -> [Vec3; 4] {
        self.patches[patch as usize].map(|i| self.positions[i as usize])
    }

    /// The box around a patch: it lies in the hull of its corners.
    pub fn bounds(&self, patch: u32) -> Bounds3 {
        Bounds3::from_points(self.corners(patch))
    }

    /// The nearest hit in `(0, t_max)`, with the patch's own parameters (not its texture coordinates).
    ///
    /// The lines of constant `u` that meet the ray are the roots of a quadratic (Reshetov, "Cool Patches", Ray Tracing
    /// Gems, chapter 8); on each of them `v` and `t` are where the two lines come closest. All of it is done in `f64`,
    /// relative to the ray's origin, where differences of the input are all but exact.
    #[inline]
    pub fn intersect(&self, patch: u32, ray: &Ray) -> Option<UserHit> {
        let o = ray.origin.as_dvec3();
        let d = ray.direction.as_dvec3();
        let [p00, p10, p01, p11] = self.corners(patch).map(|p| p.as_dvec3() - o);

        // Nearer hits are rounding: of a ray that leaves the patch from a point that lies exactly on it, as on a floor
        // at y = 0, where nothing moves the origin off.
        let reach = [p00, p10, p01, p11].iter().fold(0.0_f64, |reach, p| reach.max(p.abs().max_element()));
        let least = NOISE * reach / d.abs().max_element();

        // The volume spanned by the ray and the line of constant u is zero where they meet: its values at u = 0 and u =
        // 1 and its leading coefficient.
        let c = p00.cross(d).dot(p01 - p00);
        let a = (p10 - p00).cross(p01 - p11).dot(d);
        let b = p10.cross(d).dot(p11 - p10) - (a + c);

        let mut best: Option<UserHit> = None;
        for u in quadratic_roots(a, b, c) {
            // Roots that are not real are NaN, which lies in no range.
            if !(-EDGE..=1.0 + EDGE).contains(&u) {
                continue;
            }
            let u = u.clamp(0.0, 1.0);
            let from = p00.lerp(p10, u);
            let along = p01.lerp(p11, u) - from;
            let normal = d.cross(along);
            let scale = 1.0 / normal.length_squared();
            let v = from.cross(d).dot(normal) * scale;
            let distance = from.cross(along).dot(normal) * scale;
            let t = distance as f32;
            if (-EDGE..=1.0 + EDGE).contains(&v)
                && distance > least
                && t > 0.0
                && t < best.map_or(ray.t_max, |hit| hit.t)
            {
                best = Some(UserHit { t, u: u as f32, v: v.clamp(0.0, 1.0) as f32 });
            }
        }
        best
    }

    /// The surface at the parameters of a patch.
    pub fn surface(&self, patch: u32, u: f32, v: f32) -> SurfacePoint {
        let corners = self.corners(patch);
        let weights = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
        let mut p = Vec3::ZERO;
        let mut magnitude = Vec3::ZERO;
        for (corner, w) in corners.iter().zip(weights) {
            p += *corner * w;
            magnitude += corner.abs() * w;
        }

        let sides = Sides::new(corners);
        let mut n = sides.normal(u, v).normalize_or_zero();
        if n == DVec3::ZERO {
            // A corner where two vertices coincide.
            n = sides.normal(0.5, 0.5).normalize_or_zero();
        }
        let mut n = n.as_vec3();
        let mut ns = n;
        if self.normals.is_empty() {
            n = if self.flip { -n } else { n };
            ns = n;
        } else {
            let s: Vec3 = self.blend(&self.normals, patch, weights);
            let len2 = s.length_squared();
            if len2 > 0.0 {
                ns = s / len2.sqrt();
                n = if n.dot(ns) < 0.0 { -n } else { n };
            }
        }

        let (dpdu, dpdv) = sides.derivatives(u, v);
        let mut surface = SurfacePoint { p, error: magnitude * gamma(7), n, ns, dpdu, uv: Vec2::new(u, v) };
        if !self.uvs.is_empty() {
            let [c00, c10, c01, c11] = self.patches[patch as usize].map(|i| self.uvs[i as usize]);
            surface.uv = self.blend(&self.uvs, patch, weights);
            // ∂p/∂s by the chain rule, where texture coordinates (s, t) are a parametrisation.
            let (du, dv) = ((c10 - c00).lerp(c11 - c01, v), (c01 - c00).lerp(c11 - c10, u));
            let det = du.perp_dot(dv);
            if det.abs() > 1e-20 {
                surface.dpdu = (dpdu * dv.y - dpdv * du.y) / det;
            }
        }
        surface
    }

    /// ∂p/∂v at the parameters of a patch, by its texture coordinates where it has any.
    pub fn dpdv(&self, patch: u32, u: f32, v: f32) -> Vec3 {
        let (dpdu, dpdv) = Sides::new(self.corners(patch)).derivatives(u, v);
        if self.uvs.is_empty() {
            return dpdv;
        }
        let [c00, c10, c01, c11] = self.patches[patch as usize].map(|i| self.uvs[i as usize]);
        let (du, dv) = ((c10 - c00).lerp(c11 - c01, v), (c01 - c00).lerp(c11 - c10, u));
        let det = du.perp_dot(dv);
        if det.abs() > 1e-20 { (dpdv * du.x - dpdu * dv.x) / det } else { dpdv }
    }

    /// Texture coordinates at the parameters of a patch.
    #[inline]
    pub fn uv(&self, patch: u32, u: f32, v: f32) -> Vec2 {
        if self.uvs.is_empty() {
            return Vec2::new(u, v);
        }
        self.blend(&self.uvs, patch, [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v])
    }

    /// The corner p00 and the sides to p10 and p01, where the patch is a rectangle (to a relative 10⁻⁴).
    pub fn rectangle(&self, patch: u32) -> Option<[Vec3; 3]> {
        let [p00, p10, p01, p11] = self.corners(patch);
        let (x, y) = (p10 - p00, p01 - p00);
        let (lx, ly) = (x.length(), y.length());
        let closes = (p11 - p10 - y).length() <= 1e-4 * lx.min(ly);
        (closes && lx > 0.0 && ly > 0.0 && x.dot(y).abs() <= 1e-4 * lx * ly).then_some([p00, x, y])
    }

    /// Surface area: exact for planar convex patches, by Gauss–Legendre quadrature with 4 × 4 points for others.
    pub fn area(&self, patch: u32) -> f32 {
        const NODES: [(f64, f64); 4] = [
            (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
            (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
            (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
            (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
        ];
        let sides = Sides::new(self.corners(patch));
        let mut area = 0.0;
        for (u, wu) in NODES {
            for (v, wv) in NODES {
                area += wu * wv * sides.normal(u as f32, v as f32).length();
            }
        }
        area as f32
    }

    /// A point for area lights and its density per area. Parameters are drawn with a density bilinear between the area
    /// elements at the corners, which is uniform over planar convex patches, and nearly so over others. The density is
    /// zero for a degenerate patch.
    pub fn sample(&self, patch: u32, u: Vec2) -> (SurfacePoint, f32) {
        let [w00, w10, w01, w11] = Sides::new(self.corners(patch)).corner_elements();
        let v = sample_linear(u.y, w00 + w10, w01 + w11);
        let u = sample_linear(u.x, w00 + (w01 - w00) * v, w10 + (w11 - w10) * v);
        (self.surface(patch, u, v), self.pdf(patch, Vec2::new(u, v)))
    }

    /// The density per area with which [`PatchMesh::sample`] gives the point with these parameters of the patch.
    pub fn pdf(&self, patch: u32, uv: Vec2) -> f32 {
        let sides = Sides::new(self.corners(patch));
        let [w00, w10, w01, w11] = sides.corner_elements();
        let sum = w00 + w10 + w01 + w11;
        let element = sides.normal(uv.x, uv.y).length() as f32;
        let weight = (w00 + (w10 - w00) * uv.x) * (1.0 - uv.y) + (w01 + (w11 - w01) * uv.x) * uv.y;
        let density = 4.0 * weight / (sum * element);
        if density.is_finite() { density } else { 0.0 }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        (self.positions.len() + self.normals.len()) * 12 + self.uvs.len() * 8 + self.patches.len() * 16
    }

    /// Vertex data interpolated with the weights of the four corners.
    #[inline]
    fn blend<T>(&self, data: &[T], patch: u32, weights: [f32; 4]) -> T
    where
        T: Copy + std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
    {
        let [a, b, c, d] = self.patches[patch as usize].map(|i| data[i as usize]);
        a * weights[0] + b * weights[1] + c * weights[2] + d * weights[3]
    }
}

/// A patch as `p00 + u x + v y + u v twist`.
struct Sides {
    x: DVec3,
    y: DVec3,
    twist: DVec3,
}

impl Sides {
    #[inline]
    fn new(corners: [Vec3; 4]) -> Self {
        let [p00, p10, p01, p11] = corners.map(|p| p.as_dvec3());
        Self { x: p10 - p00, y: p01 - p00, twist: (p11 - p10) - (p01 - p00) }
    }

    /// `∂p/∂u` and `∂p/∂v`.
    #[inline]
    fn derivatives(&self, u: f32, v: f32) -> (Vec3, Vec3) {
        let (u, v) = (f64::from(u), f64::from(v));
        ((self.x + self.twist * v).as_vec3(), (self.y + self.twist * u).as_vec3())
    }

    /// `∂p/∂u × ∂p/∂v`, whose length is the area element.
    #[inline]
    fn normal(&self, u: f32, v: f32) -> DVec3 {
        (self.x + self.twist * f64::from(v)).cross(self.y + self.twist * f64::from(u))
    }

    /// The area elements at the corners 00, 10, 01, 11.
    fn corner_elements(&self) -> [f32; 4] {
        [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(u, v)| self.normal(u, v).length() as f32)
    }
}

/// Roots of `a x² + b x + c`, without cancellation; infinite or NaN for those that are missing.
#[inline]
pub(super) fn quadratic_roots(a: f64, b: f64, c: f64) -> [f64; 2] {
    let q = -0.5 * (b + (b * b - 4.0 * a * c).sqrt().copysign(b));
    let (r0, r1) = (q / a, c / q);
    // A double root is reported once.
    if r0 == r1 { [r0, f64::NAN] } else { [r0, r1] }
}

/// A number in `[0, 1)` with density linear between `a` at 0 and `b` at 1 (Pharr, Jakob, Humphreys, PBR 4th ed.,
/// 2.3.2).
#[inline]
fn sample_linear(u: f32, a: f32, b: f32) -> f32 {
    let x = u * (a + b) / (a + (a * a + (b * b - a * a) * u).max(0.0).sqrt());
    // Both weights zero, or u and a: NaN.
    if x.is_finite() { x.min(ONE_MINUS_EPSILON) } else { u }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::{DVec3, Transform, hash::HashRng, warp};

    fn single(corners: [Vec3; 4]) -> PatchMesh {
        PatchMesh { positions: corners.to_vec(), patches: vec![[0, 1, 2, 3]], ..PatchMesh::default() }
    }

    fn vec3(rng: &mut HashRng) -> Vec3 {
        Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 2.0 - 1.0
    }

    fn vec2(rng: &mut HashRng) -> Vec2 {
        Vec2::new(rng.next_f32(), rng.next_f32())
    }

    /// Distance along the ray to a triangle, in `f64`.
    fn triangle(ray: &Ray, [a, b, c]: [Vec3; 3]) -> Option<f64> {
        let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let [a, b, c] = [a, b, c].map(|p| p.as_dvec3() - o);
        let [u, v, w] = [c.cross(b).dot(d), a.cross(c).dot(d), b.cross(a).dot(d)];
        let inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
        let t = (a * u + b * v + c * w).dot(d) / ((u + v + w) * d.length_squared());
        (inside && t > 0.0).then_some(t)
    }

    #[test]
    fn hits_lie_on_the_surface_and_agree_with_a_tessellation() {
        const N: usize = 64;
        let mut rng = HashRng::new(1);
        let (mut hits, mut disagree, mut rays) = (0, 0, 0);
        for _ in 0..12 {
            let patch = single(std::array::from_fn(|_| vec3(&mut rng)));
            let grid = |i: usize, j: usize| patch.surface(0, i as f32 / N as f32, j as f32 / N as f32).p;
            let mut triangles = Vec::new();
            for i in 0..N {
                for j in 0..N {
                    let [a, b, c, d] = [grid(i, j), grid(i + 1, j), grid(i, j + 1), grid(i + 1, j + 1)];
                    triangles.extend([[a, b, d], [a, d, c]]);
                }
            }
            for _ in 0..60 {
                let ray = Ray::new(vec3(&mut rng) * 3.0, vec3(&mut rng) * 2.0);
                let target = patch.surface(0, rng.next_f32(), rng.next_f32()).p;
                let ray = if rng.next_f32() < 0.7 { Ray::new(ray.origin, target - ray.origin) } else { ray };
                rays += 1;
                let expected = triangles.iter().filter_map(|&t| triangle(&ray, t)).reduce(f64::min);
                let found = patch.intersect(0, &ray);
                if let Some(hit) = found {
                    hits += 1;
                    let gap = (ray.at(hit.t) - patch.surface(0, hit.u, hit.v).p).length();
                    assert!(gap < 3e-6 * (1.0 + hit.t * ray.direction.length()), "{gap}");
                    // The hit is not in the interval that ends before it.
                    let before = Ray { t_max: hit.t, ..ray };
                    assert!(patch.intersect(0, &before).is_none_or(|other| other.t < hit.t));
                }
                // A chord of the tessellation is off by at most twist / (4 N²); near silhouettes that decides between
                // hit and miss.
                let same = match (found, expected) {
                    (Some(hit), Some(t)) => (f64::from(hit.t) - t).abs() < 0.02,
                    (None, None) => true,
                    _ => false,
                };
                disagree += usize::from(!same);
            }
        }
        assert!(hits > 400, "{hits}");
        assert!(disagree * 50 < rays, "{disagree} of {rays}");
    }

    #[test]
    fn planar_quads_are_exact() {
        // A parallelogram (a linear equation), a trapezoid, and a triangle with a doubled corner, all in z = 1.
        let at = |x: f32, y: f32| Vec3::new(x, y, 1.0);
        let quads = [
            [at(0.0, 0.0), at(2.0, 0.0), at(1.0, 1.0), at(3.0, 1.0)],
            [at(0.0, 0.0), at(4.0, 0.0), at(1.0, 1.0), at(2.0, 1.0)],
            [at(0.0, 0.0), at(2.0, 0.0), at(0.0, 0.0), at(0.0, 2.0)],
            [at(0.0, 0.0), at(2.0, 0.0), at(0.0, 2.0), at(0.0, 2.0)],
        ];
        let areas = [2.0, 2.5, 2.0, 2.0];
        let mut rng = HashRng::new(2);
        for (corners, area) in quads.into_iter().zip(areas) {
            let patch = single(corners);
            assert!((patch.area(0) - area).abs() < 1e-6);
            assert!(patch.rectangle(0).is_none());
            let ring = [corners[0], corners[1], corners[3], corners[2]];
            for _ in 0..2000 {
                let p = at(rng.next_f32() * 5.0 - 0.5, rng.next_f32() * 3.0 - 0.5);
                let side = |i: usize| (ring[(i + 1) % 4] - ring[i]).cross(p - ring[i]).z;
                let inside = (0..4).all(|i| side(i) >= 0.0) || (0..4).all(|i| side(i) <= 0.0);
                let ray = Ray::new(Vec3::new(0.3, -0.2, -4.0), p - Vec3::new(0.3, -0.2, -4.0));
                let hit = patch.intersect(0, &ray);
                assert_eq!(hit.is_some(), inside, "{p} {corners:?}");
                if let Some(hit) = hit {
                    assert!((hit.t - 1.0).abs() < 1e-6);
                    let s = patch.surface(0, hit.u, hit.v);
                    assert!((s.p - p).length() < 1e-5 && s.n.z.abs() > 0.999_999);
                    // Planar convex patches are sampled uniformly.
                    assert!((patch.pdf(0, Vec2::new(hit.u, hit.v)) * area - 1.0).abs() < 1e-3);
                }
            }
            // In its own plane a patch has no hit.
            assert!(patch.intersect(0, &Ray::new(at(-1.0, 0.5), Vec3::X)).is_none());
        }
    }

    #[test]
    fn no_ray_slips_through_shared_edges() {
        // A bumpy height field of patches seen from far away; every ray is aimed at an edge or a corner.
        const N: u32 = 6;
        let mut rng = HashRng::new(3);
        let mut mesh = PatchMesh::default();
        for j in 0..=N {
            for i in 0..=N {
                mesh.positions.push(Vec3::new(i as f32 + 0.3 * rng.next_f32(), j as f32, 0.3 * rng.next_f32()));
            }
        }
        for j in 0..N {
            for i in 0..N {
                let a = j * (N + 1) + i;
                mesh.patches.push([a, a + 1, a + N + 1, a + N + 2]);
            }
        }
        let count = mesh.patches.len() as u32;
        for k in 0..20_000 {
            let i = (k % (N - 1) + 1) as usize;
            let j = (k / (N - 1) % (N - 1) + 1) as usize;
            let a = mesh.positions[j * (N as usize + 1) + i];
            let b = mesh.positions[(j + k as usize % 2) * (N as usize + 1) + i + (k as usize + 1) % 2];
            let target = a.lerp(b, if k % 16 == 0 { 0.0 } else { rng.next_f32() });
            let origin = Vec3::new(3.0, 3.0, 500.0) + vec3(&mut rng) * 100.0;
            let ray = Ray::new(origin, (target - origin) * 0.37);
            assert!((0..count).any(|patch| mesh.intersect(patch, &ray).is_some()), "{k}");
        }
    }

    #[test]
    fn orientation_follows_flip_and_vertex_normals() {
        let mut mesh = Mesh {
            positions: vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, 1.0, 0.0]],
            patches: vec![[0, 1, 2, 3]],
            ..Mesh::default()
        };
        let identity = Affine::IDENTITY;
        assert_eq!(PatchMesh::new(&mesh, &identity, false, false, false).surface(0, 0.5, 0.5).n, Vec3::Z);
        assert_eq!(PatchMesh::new(&mesh, &identity, false, true, false).surface(0, 0.5, 0.5).n, -Vec3::Z);
        // Mirrored in x: the cross product turns over, and the flag turns it back.
        let mirror = Transform::scale(DVec3::new(-1.0, 1.0, 1.0));
        let mirrored = PatchMesh::new(&mesh, &mirror.affine().unwrap(), mirror.swaps_handedness(), false, false);
        assert_eq!(mirrored.surface(0, 0.5, 0.5).n, Vec3::Z);
        assert_eq!(mirrored.rectangle(0), Some([Vec3::ZERO, Vec3::X * -2.0, Vec3::Y]));

        mesh.normals = vec![[0.0, 0.6, -0.8]; 4];
        mesh.uvs = vec![[0.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [-1.0, 1.0]];
        let s = PatchMesh::new(&mesh, &identity, false, false, false).surface(0, 0.25, 0.5);
        assert_eq!(s.n, -Vec3::Z);
        assert!((s.ns - Vec3::new(0.0, 0.6, -0.8)).length() < 1e-6);
        // s runs along −y, t along x.
        assert!((s.dpdu - -Vec3::Y).length() < 1e-6 && (s.uv - Vec2::new(-0.5, 0.25)).length() < 1e-6);
        let reversed = PatchMesh::new(&mesh, &identity, false, true, false).surface(0, 0.25, 0.5);
        assert_eq!(reversed.n, Vec3::Z);
        assert_eq!(PatchMesh::new(&mesh, &identity, false, false, true).surface(0, 0.25, 0.5).ns, Vec3::Z);
    }

    #[test]
    fn samples_have_the_density_claimed() {
        let mut rng = HashRng::new(4);
        for _ in 0..6 {
            let patch = single(std::array::from_fn(|_| vec3(&mut rng)));
            // The area and the integral of u over it, by dense summation and as means over samples.
            let fine = 400;
            let sides = Sides::new(patch.corners(0));
            let (mut sum, mut moment) = (0.0, 0.0);
            for i in 0..fine * fine {
                let (u, v) = (((i % fine) as f32 + 0.5) / fine as f32, ((i / fine) as f32 + 0.5) / fine as f32);
                let element = sides.normal(u, v).length() / f64::from(fine * fine);
                sum += element;
                moment += element * f64::from(u);
            }
            assert!((f64::from(patch.area(0)) / sum - 1.0).abs() < 0.01, "{} {sum}", patch.area(0));
            let (mut mean, mut centre) = (0.0, 0.0);
            let count = 40_000;
            for _ in 0..count {
                let (s, pdf) = patch.sample(0, vec2(&mut rng));
                assert!(pdf > 0.0 && (patch.pdf(0, s.uv) - pdf).abs() <= 1e-5 * pdf);
                mean += 1.0 / f64::from(pdf) / f64::from(count);
                centre += f64::from(s.uv.x) / f64::from(pdf) / f64::from(count);
            }
            assert!((mean / sum - 1.0).abs() < 0.02, "{mean} {sum}");
            assert!((centre / moment - 1.0).abs() < 0.02, "{centre} {moment}");
        }
    }

    #[test]
    fn degenerate_and_hostile_patches_are_harmless() {
        let mut rng = HashRng::new(5);
        let p = Vec3::new(0.1, 0.2, 0.3);
        let line = |t: f32| p + Vec3::X * t;
        let cases = [
            [p; 4],
            [line(0.0), line(1.0), line(2.0), line(3.0)],
            [p, line(1.0), line(1.0), p],
            [Vec3::splat(f32::MAX), Vec3::splat(-f32::MAX), p, line(1.0)],
            [Vec3::splat(f32::NAN), p, line(1.0), p],
        ];
        for corners in cases {
            let patch = single(corners);
            let (_, pdf) = patch.sample(0, vec2(&mut rng));
            assert!(pdf.is_finite() && pdf >= 0.0);
            for _ in 0..200 {
                let d = warp::uniform_sphere(vec2(&mut rng));
                if let Some(hit) = patch.intersect(0, &Ray::new(p - d, d)) {
                    assert!(hit.t > 0.0 && (0.0..=1.0).contains(&hit.u) && (0.0..=1.0).contains(&hit.v));
                }
            }
        }
    }
}
