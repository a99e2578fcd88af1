//! Points at which functions are asked: grids, directions, and random numbers of fixed seeds.

use steradian_math::hash::HashRng;

/// All combinations of values, one list for each input.
pub(crate) fn grid(values: &[&[f64]]) -> Vec<Vec<f64>> {
    values.iter().fold(vec![Vec::new()], |points, values| {
        let extended = |p: Vec<f64>| values.iter().map(move |v| [&p[..], &[*v]].concat());
        points.into_iter().flat_map(extended).collect()
    })
}

/// Random numbers in `[0, 1)`, exact in single precision.
pub(crate) struct Random(HashRng);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(HashRng::new(seed))
    }

    pub fn unit(&mut self) -> f64 {
        f64::from(self.0.next_f32())
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A direction, evenly spread over the hemisphere above the surface.
    pub fn above(&mut self) -> [f64; 3] {
        let (z, phi) = (self.unit(), std::f64::consts::TAU * self.unit());
        let r = (1.0 - z * z).max(0.0).sqrt();
        [r * phi.cos(), r * phi.sin(), z]
    }

    /// A direction, evenly spread over the sphere.
    pub fn around(&mut self) -> [f64; 3] {
        let [x, y, z] = self.above();
        let sign = if self.unit() < 0.5 { -1.0 } else { 1.0 };
        [x, y, sign * z]
    }
}

/// The direction at so many degrees from the normal z, turned by `azimuth` degrees from x.
pub(crate) fn direction(angle: f64, azimuth: f64) -> [f64; 3] {
    let ((sin, cos), (y, x)) = (angle.to_radians().sin_cos(), azimuth.to_radians().sin_cos());
    [sin * x, sin * y, cos]
}

/// Pairs of directions on both sides of the surface: chosen ones first, then random ones above.
pub(crate) fn pairs(seed: u64, count: usize) -> Vec<[[f64; 3]; 2]> {
    let angles = [(0.0, 0.0), (45.0, 180.0), (60.0, 30.0), (30.0, 150.0), (80.0, 200.0), (120.0, 10.0), (150.0, 200.0)];
    let chosen = angles.map(|(angle, azimuth)| direction(angle, azimuth));
    let mut pairs: Vec<[[f64; 3]; 2]> = chosen.iter().flat_map(|a| chosen.iter().map(move |b| [*a, *b])).collect();
    let mut random = Random::new(seed);
    pairs.extend((0..count).map(|_| [random.above(), random.above()]));
    pairs
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Three numbers of a list of inputs, from the one at `first`.
pub(crate) fn vector(inputs: &[f64], first: usize) -> [f64; 3] {
    [0, 1, 2].map(|i| inputs.get(first + i).copied().unwrap_or(0.0))
}
