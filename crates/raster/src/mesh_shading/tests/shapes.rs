//! Meshes to test with, and random numbers.

use std::collections::HashMap;

use glam::Vec3;

pub struct Mesh {
    pub positions: Vec<Vec3>,
    pub indices: Vec<u32>,
}

impl Mesh {
    pub fn triangles(&self) -> &[[u32; 3]] {
        self.indices.as_chunks::<3>().0
    }
}

/// A square of n × n cells with bumps.
pub fn grid(n: u32) -> Mesh {
    let side = n + 1;
    let point = |i: u32| {
        let (x, y) = (i % side, i / side);
        Vec3::new(x as f32 / n as f32, y as f32 / n as f32, ((x * x + 3 * y) % 7) as f32 * 0.1 / 7.0)
    };
    let cell = |i: u32| {
        let a = i / n * side + i % n;
        [a, a + 1, a + side + 1, a, a + side + 1, a + side]
    };
    Mesh { positions: (0..side * side).map(point).collect(), indices: (0..n * n).flat_map(cell).collect() }
}

/// A torus of m × n cells, with radii 1 and 0.4.
pub fn torus(m: u32, n: u32) -> Mesh {
    // A rational parameter for each quarter of the circle.
    let circle = |i: u32, count: u32| {
        let t = (i * 4 % count) as f32 / count as f32;
        let (c, s) = ((1.0 - t * t) / (1.0 + t * t), 2.0 * t / (1.0 + t * t));
        [(c, s), (-s, c), (-c, -s), (s, -c)][(i * 4 / count) as usize]
    };
    let point = |i: u32| {
        let ((c, s), (u, v)) = (circle(i / n, m), circle(i % n, n));
        let r = 1.0 + 0.4 * u;
        Vec3::new(r * c, r * s, 0.4 * v)
    };
    let cell = |i: u32| {
        let (row, next) = (i / n * n, (i / n + 1) % m * n);
        let (j, k) = (i % n, (i + 1) % n);
        [row + j, next + j, next + k, row + j, next + k, row + k]
    };
    Mesh { positions: (0..m * n).map(point).collect(), indices: (0..m * n).flat_map(cell).collect() }
}

/// A sphere of 20·4ᵏ triangles.
pub fn icosphere(k: u32) -> Mesh {
    let g = 0.5 * (1.0 + 5.0f32.sqrt());
    let corners = |i: usize| {
        let (s, t) = ([-1.0, 1.0][i & 1], [-g, g][i >> 1 & 1]);
        [Vec3::new(s, t, 0.0), Vec3::new(0.0, s, t), Vec3::new(t, 0.0, s)][i / 4].normalize()
    };
    let mut positions: Vec<Vec3> = (0..12).map(corners).collect();
    let near = |a: usize, b: usize| positions[a].distance(positions[b]) < 1.1;
    let mut triangles = Vec::new();
    for (a, b, c) in (0..12).flat_map(|a| (0..12).flat_map(move |b| (0..12).map(move |c| (a, b, c)))) {
        let [p, q, r] = [a, b, c].map(|i: usize| positions[i]);
        if a < b && a < c && b != c && near(a, b) && near(b, c) && near(c, a) && (q - p).cross(r - p).dot(p) > 0.0 {
            triangles.push([a, b, c].map(|i| i as u32));
        }
    }
    for _ in 0..k {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push((positions[a as usize] + positions[b as usize]).normalize());
                positions.len() as u32 - 1
            })
        };
        let split = |[a, b, c]: [u32; 3]| {
            let [d, e, f] = [middle(a, b), middle(b, c), middle(c, a)];
            [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
        };
        triangles = triangles.into_iter().flat_map(split).collect();
    }
    Mesh { positions, indices: triangles.into_flattened() }
}

/// Triangles between random vertices of few, many of them degenerate or repeated.
pub fn soup(vertices: usize, triangles: usize, random: &mut Random) -> Mesh {
    let positions = (0..vertices).map(|_| random.point(1.0)).collect();
    Mesh { positions, indices: (0..3 * triangles).map(|_| random.below(vertices) as u32).collect() }
}

/// A generator of numbers that are the same each time (SplitMix64).
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [−size, size).
    pub fn point(&mut self, size: f32) -> Vec3 {
        Vec3::from_array(std::array::from_fn(|_| size * ((self.bits() >> 40) as f32 / (1u64 << 23) as f32 - 1.0)))
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }
}
