//! Meshes to unwrap.

use steradian_unwrap::Mesh;

/// Positions and triangles.
#[derive(Debug)]
pub struct Shape {
    pub positions: Vec<[f32; 3]>,
    pub triangles: Vec<[u32; 3]>,
}

impl Shape {
    pub fn mesh(&self) -> Mesh<'_> {
        Mesh { positions: &self.positions, triangles: &self.triangles, seams: &[] }
    }

    /// Positions rounded to a fraction, so that ends meet.
    pub fn rounded(mut self, steps: f32) -> Self {
        self.positions.iter_mut().flatten().for_each(|x| *x = (*x * steps).round() / steps);
        self
    }

    /// The triangles of an OBJ file.
    pub fn read(text: &str) -> Self {
        let mut shape = Self { positions: Vec::new(), triangles: Vec::new() };
        for line in text.lines() {
            let words: Vec<&str> = line.split_whitespace().collect();
            match words[..] {
                ["v", x, y, z] => shape.positions.push([x, y, z].map(|w| w.parse().unwrap())),
                ["f", a, b, c] => {
                    let index = |w: &str| w.split('/').next().unwrap().parse::<u32>().unwrap() - 1;
                    shape.triangles.push([a, b, c].map(index));
                }
                _ => {}
            }
        }
        shape
    }
}

pub fn cube() -> Shape {
    let positions = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(|b| b as f32)).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Shape { positions, triangles: quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect() }
}

/// A surface over a grid of quads, which may close in either direction.
pub fn grid(n: u32, m: u32, closes_u: bool, closes_v: bool, at: impl Fn(f64, f64) -> [f64; 3]) -> Shape {
    let (columns, rows) = (if closes_u { n } else { n + 1 }, if closes_v { m } else { m + 1 });
    let vertices = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
    let positions = vertices.map(|(i, j)| at(i as f64 / n as f64, j as f64 / m as f64).map(|x| x as f32)).collect();
    let index = |i: u32, j: u32| j % rows * columns + i % columns;
    let quads = (0..m).flat_map(|j| (0..n).map(move |i| (i, j)));
    let halves = |(i, j): (u32, u32)| {
        let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    Shape { positions, triangles: quads.flat_map(halves).collect() }
}

/// Random triangles over random vertices.
pub fn soup(vertices: u32, triangles: u32, seed: u64) -> Shape {
    let mut state = seed;
    let mut random = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as u32
    };
    let positions = (0..vertices).map(|_| [0; 3].map(|_| (random() % 1000) as f32 / 1000.0)).collect();
    Shape { positions, triangles: (0..triangles).map(|_| [0; 3].map(|_| random() % vertices)).collect() }
}
