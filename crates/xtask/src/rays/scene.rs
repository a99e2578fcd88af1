//! The meshes and rays of the measurement. Only `+ − × ÷ √` in `f64` in a fixed order and an integer generator decide
//! them, so that other programs can be measured with the very same input.

use crate::generate::Mesh;
use std::collections::HashMap;
use steradian_math::{Bounds3, DMat4, DVec3, Ray, Transform, Vec3, transform::Affine};

/// SplitMix64.
struct Rng(u64);

impl Rng {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in `[0, 1)`.
    fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 / 9_007_199_254_740_992.0
    }

    /// Uniform in `[-1, 1)`.
    fn signed(&mut self) -> f64 {
        2.0 * self.uniform() - 1.0
    }
}

/// Value noise: random values at integer points, smoothly interpolated.
fn noise(p: DVec3) -> f64 {
    let cell = p.floor();
    let f = p - cell;
    let w = DVec3::new(f.x * f.x * (3.0 - 2.0 * f.x), f.y * f.y * (3.0 - 2.0 * f.y), f.z * f.z * (3.0 - 2.0 * f.z));
    let at = |dx: i64, dy: i64, dz: i64| {
        let h = ((cell.x as i64 + dx) as u64)
            .wrapping_mul(0x8DA6_B343)
            .wrapping_add(((cell.y as i64 + dy) as u64).wrapping_mul(0xD816_3841))
            .wrapping_add(((cell.z as i64 + dz) as u64).wrapping_mul(0xCB1A_B31F));
        Rng(h).uniform() * 2.0 - 1.0
    };
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let plane = |dz| mix(mix(at(0, 0, dz), at(1, 0, dz), w.x), mix(at(0, 1, dz), at(1, 1, dz), w.x), w.y);
    mix(plane(0), plane(1), w.z)
}

/// A sphere with six octaves of noise, of `12 n²` triangles.
pub fn displaced_sphere(n: i32) -> Mesh {
    let mut positions = Vec::new();
    let mut known = HashMap::new();
    let mut vertex = |key: [i32; 3]| {
        *known.entry(key).or_insert_with(|| {
            let [x, y, z] = key.map(|i| 2.0 * f64::from(i) / f64::from(n) - 1.0);
            let (x2, y2, z2) = (x * x, y * y, z * z);
            let p = DVec3::new(
                x * (1.0 - y2 * 0.5 - z2 * 0.5 + y2 * z2 / 3.0).sqrt(),
                y * (1.0 - z2 * 0.5 - x2 * 0.5 + z2 * x2 / 3.0).sqrt(),
                z * (1.0 - x2 * 0.5 - y2 * 0.5 + x2 * y2 / 3.0).sqrt(),
            );
            let (mut sum, mut amplitude, mut frequency) = (0.0, 0.12, 3.0);
            for _ in 0..6 {
                sum += amplitude * noise(p * frequency);
                amplitude *= 0.5;
                frequency *= 2.0;
            }
            positions.push((p * (1.0 + sum)).as_vec3());
            positions.len() as u32 - 1
        })
    };
    let mut indices = Vec::new();
    for face in 0..6 {
        for b in 0..n {
            for a in 0..n {
                let mut at = |s, t| {
                    vertex(match face {
                        0 => [n, s, t],
                        1 => [0, t, s],
                        2 => [t, n, s],
                        3 => [s, 0, t],
                        4 => [s, t, n],
                        _ => [t, s, 0],
                    })
                };
                let [p, q, r, s] = [at(a, b), at(a + 1, b), at(a + 1, b + 1), at(a, b + 1)];
                indices.extend([[p, q, r], [p, r, s]]);
            }
        }
    }
    (positions, indices)
}

/// Placements of 1000 instances: a lattice with random rotations and sizes.
pub fn instances() -> Vec<Affine> {
    let mut rng = Rng(77);
    let mut place = |i: i32| {
        let (q, length2) = loop {
            let q = [rng.signed(), rng.signed(), rng.signed(), rng.signed()];
            let length2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
            if (0.01..=1.0).contains(&length2) {
                break (q, length2);
            }
        };
        let [a, b, c, d] = q.map(|x| x * (1.0 / length2.sqrt()));
        let size = 0.7 + 0.6 * rng.uniform();
        let at = |i: i32| (f64::from(i) - 4.5) * 2.6;
        let column = |x: f64, y: f64, z: f64| (DVec3::new(x, y, z) * size).extend(0.0);
        Transform {
            matrix: DMat4::from_cols(
                column(1.0 - 2.0 * (c * c + d * d), 2.0 * (b * c + a * d), 2.0 * (b * d - a * c)),
                column(2.0 * (b * c - a * d), 1.0 - 2.0 * (b * b + d * d), 2.0 * (c * d + a * b)),
                column(2.0 * (b * d + a * c), 2.0 * (c * d - a * b), 1.0 - 2.0 * (b * b + c * c)),
                DVec3::new(at(i % 10), at(i / 10 % 10), at(i / 100)).extend(1.0),
            ),
        }
        .affine()
    };
    (0..1000).filter_map(&mut place).collect()
}

/// Viewpoint of the rays, and the light that shadow rays go to.
#[derive(Clone, Copy, Debug)]
pub struct View {
    pub name: &'static str,
    pub eye: DVec3,
    pub at: DVec3,
    /// Tangent of half the angle of view.
    pub tan_half: f64,
    /// Centre and half the side of a square light that faces down.
    pub light: (DVec3, f64),
    /// By how much rays that leave a surface begin above it.
    pub offset: f64,
}

impl View {
    /// Views of the displaced sphere: at it, and out of its middle.
    pub const SPHERE: [Self; 2] = [
        Self {
            name: "outside",
            eye: DVec3::new(1.1, 0.8, 2.2),
            at: DVec3::ZERO,
            tan_half: 0.42,
            light: (DVec3::new(0.0, 3.0, 1.0), 0.7),
            offset: 1e-4,
        },
        Self {
            name: "inside",
            eye: DVec3::new(0.1, 0.05, -0.08),
            at: DVec3::new(0.5, 0.3, 1.0),
            tan_half: 1.0,
            light: (DVec3::new(0.0, 0.3, 0.0), 0.1),
            offset: 1e-4,
        },
    ];

    /// At the instances.
    pub const INSTANCES: [Self; 1] = [Self {
        name: "outside",
        eye: DVec3::new(24.0, 15.0, 26.0),
        at: DVec3::ZERO,
        tan_half: 0.45,
        light: (DVec3::new(0.0, 40.0, 20.0), 10.0),
        offset: 1e-4,
    }];

    /// At all of a mesh, along its thinnest side.
    pub fn of(mesh: &Mesh) -> Self {
        let bounds = mesh.0.iter().fold(Bounds3::EMPTY, |bounds, &p| bounds.union_point(p));
        let (least, greatest) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let (center, half) = ((least + greatest) * 0.5, (greatest - least) * 0.5);
        let (radius, tan_half) = (half.max_element(), 0.42);
        let thinnest = DVec3::AXES.into_iter().min_by(|a, b| a.dot(half).total_cmp(&b.dot(half))).unwrap_or(DVec3::Z);
        Self {
            name: "outside",
            eye: center + thinnest * (half.min_element() + radius / tan_half),
            at: center,
            tan_half,
            light: (center + (DVec3::Y * 3.0 + thinnest) * radius, 0.7 * radius),
            offset: 1e-4 * radius,
        }
    }

    /// One ray through each pixel of a picture of `size` × `size`, in tiles of 4 × 4.
    pub fn primary(&self, size: i32) -> Vec<Ray> {
        let w = normalize(self.at - self.eye);
        let u = normalize(w.cross(if w.y.abs() < 0.99 { DVec3::Y } else { DVec3::Z }));
        let v = u.cross(w);
        let tiles = (0..size / 4).flat_map(|y| (0..size / 4).map(move |x| (4 * x, 4 * y)));
        let pixels = tiles.flat_map(|(x, y)| (0..16).map(move |i| (x + i % 4, y + i / 4)));
        let ray = |(x, y)| {
            let px = (2.0 * (f64::from(x) + 0.5) / f64::from(size) - 1.0) * self.tan_half;
            let py = (1.0 - 2.0 * (f64::from(y) + 0.5) / f64::from(size)) * self.tan_half;
            Ray::new(self.eye.as_vec3(), normalize(w + u * px + v * py).as_vec3())
        };
        pixels.map(ray).collect()
    }

    /// Points a little above the surface where rays hit, of which distances and normals are given.
    pub fn spots(&self, rays: &[Ray], nearest: impl Fn(&Ray) -> Option<(f32, Vec3)>) -> Vec<Spot> {
        let spot = |ray: &Ray| {
            let (t, normal) = nearest(ray)?;
            let n = normalize(normal.as_dvec3());
            let n = if n.dot(ray.direction.as_dvec3()) > 0.0 { -n } else { n };
            Some((ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(t) + n * self.offset, n))
        };
        rays.iter().filter_map(spot).collect()
    }

    /// Rays from the spots to points on the light.
    pub fn shadow(&self, spots: &[Spot], seed: u64) -> Vec<Ray> {
        let mut rng = Rng(seed);
        let (center, half) = self.light;
        let ray = |&(p, _): &Spot| {
            let to = DVec3::new(center.x + rng.signed() * half, center.y, center.z + rng.signed() * half);
            Ray { t_max: 0.9999, ..Ray::new(p.as_vec3(), (to - p).as_vec3()) }
        };
        spots.iter().map(ray).collect()
    }
}

fn normalize(v: DVec3) -> DVec3 {
    v * (1.0 / v.dot(v).sqrt())
}

/// A point a little above a surface, and the normal there.
pub type Spot = (DVec3, DVec3);

/// Cosine-distributed rays from the spots.
pub fn bounce(spots: &[Spot], seed: u64) -> Vec<Ray> {
    let mut rng = Rng(seed);
    let ray = |&(p, n): &Spot| {
        let (a, b) = loop {
            let (a, b) = (rng.signed(), rng.signed());
            if a * a + b * b < 1.0 {
                break (a, b);
            }
        };
        let u = normalize(n.cross(if n.x.abs() > 0.5 { DVec3::Y } else { DVec3::X }));
        let v = n.cross(u);
        let d = u * a + v * b + n * (1.0 - a * a - b * b).sqrt();
        Ray::new(p.as_vec3(), d.as_vec3())
    };
    spots.iter().map(ray).collect()
}
