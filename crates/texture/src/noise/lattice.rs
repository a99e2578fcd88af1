//! Value noise and Perlin's gradient noise on the integer lattice.
//!
//! Perlin, "Improving Noise", SIGGRAPH 2002: at each lattice point one of twelve gradients to the edges of a cube,
//! chosen by a permutation of 0…255; the products of gradient and offset are interpolated by the quintic fade. Noise is
//! zero at lattice points and lies in [−1.04, 1.04]. (In two dimensions with unit gradients the range is ±√½: E38.)
//! Seed 0 is Perlin's own permutation, which pbrt uses too; other seeds hash the lattice.

use super::quintic_fade;
use steradian_math::{
    Vec3,
    hash::{combine32, mix32},
};

/// The permutation of Perlin's reference implementation.
#[rustfmt::skip]
const PERMUTATION: [u8; 256] = [
    151, 160, 137, 91, 90, 15, 131, 13, 201, 95, 96, 53, 194, 233, 7, 225, 140, 36, 103, 30, 69, 142, 8, 99, 37, 240, 21, 10, 23,
    190, 6, 148, 247, 120, 234, 75, 0, 26, 197, 62, 94, 252, 219, 203, 117, 35, 11, 32, 57, 177, 33, 88, 237, 149, 56, 87, 174,
    20, 125, 136, 171, 168, 68, 175, 74, 165, 71, 134, 139, 48, 27, 166, 77, 146, 158, 231, 83, 111, 229, 122, 60, 211, 133, 230,
    220, 105, 92, 41, 55, 46, 245, 40, 244, 102, 143, 54, 65, 25, 63, 161, 1, 216, 80, 73, 209, 76, 132, 187, 208, 89, 18, 169,
    200, 196, 135, 130, 116, 188, 159, 86, 164, 100, 109, 198, 173, 186, 3, 64, 52, 217, 226, 250, 124, 123, 5, 202, 38, 147, 118,
    126, 255, 82, 85, 212, 207, 206, 59, 227, 47, 16, 58, 17, 182, 189, 28, 42, 223, 183, 170, 213, 119, 248, 152, 2, 44, 154,
    163, 70, 221, 153, 101, 155, 167, 43, 172, 9, 129, 22, 39, 253, 19, 98, 108, 110, 79, 113, 224, 232, 178, 185, 112, 104, 218,
    246, 97, 228, 251, 34, 242, 193, 238, 210, 144, 12, 191, 179, 162, 241, 81, 51, 145, 235, 249, 14, 239, 107, 49, 192, 214, 31,
    181, 199, 106, 157, 184, 84, 204, 176, 115, 121, 50, 45, 127, 4, 150, 254, 138, 236, 205, 93, 222, 114, 67, 29, 24, 72, 243,
    141, 128, 195, 78, 66, 215, 61, 156, 180,
];

/// A cell of the lattice and where in it a point lies. Far from the origin the lattice is taken modulo 2³⁰, as pbrt has
/// it; what is not finite counts as zero.
#[inline]
fn cell(p: Vec3) -> ([i32; 3], Vec3) {
    let p = if p.is_finite() { p.to_array() } else { [0.0; 3] };
    let p = p.map(|v| v % 1_073_741_824.0);
    let floor = p.map(f32::floor);
    (floor.map(|v| v as i32), Vec3::new(p[0] - floor[0], p[1] - floor[1], p[2] - floor[2]))
}

/// The hash of a lattice point.
#[inline]
pub(crate) fn hash(seed: u32, c: [i32; 3]) -> u32 {
    combine32(combine32(combine32(seed, c[0] as u32), c[1] as u32), c[2] as u32)
}

#[inline]
fn edge(seed: u32, [x, y, z]: [i32; 3], d: Vec3) -> f32 {
    let h = if seed == 0 {
        let at = |i: i32| i32::from(PERMUTATION[(i & 255) as usize]);
        at(at(at(x).wrapping_add(y)).wrapping_add(z)) & 15
    } else {
        (hash(seed, [x, y, z]) & 15) as i32
    };
    let u = if h < 8 || h == 12 || h == 13 { d.x } else { d.y };
    let v = if h < 4 || h == 12 || h == 13 { d.y } else { d.z };
    (if h & 1 == 0 { u } else { -u }) + (if h & 2 == 0 { v } else { -v })
}

#[inline]
fn lerp(t: f32, a: f32, b: f32) -> f32 {
    (1.0 - t) * a + t * b
}

/// Interpolates the values at the corners of a cell.
#[inline]
fn blend(d: Vec3, corner: impl Fn(i32, i32, i32) -> f32) -> f32 {
    let (wx, wy, wz) = (quintic_fade(d.x), quintic_fade(d.y), quintic_fade(d.z));
    let row = |y, z| lerp(wx, corner(0, y, z), corner(1, y, z));
    let plane = |z| lerp(wy, row(0, z), row(1, z));
    lerp(wz, plane(0), plane(1))
}

/// Perlin's gradient noise.
pub fn gradient_noise(p: Vec3, seed: u32) -> f32 {
    let ([x, y, z], d) = cell(p);
    blend(d, |i, j, k| {
        edge(
            seed,
            [x.wrapping_add(i), y.wrapping_add(j), z.wrapping_add(k)],
            Vec3::new(d.x - i as f32, d.y - j as f32, d.z - k as f32),
        )
    })
}

/// Value noise: a random number in [−1, 1) at each lattice point, interpolated.
pub fn value_noise(p: Vec3, seed: u32) -> f32 {
    let ([x, y, z], d) = cell(p);
    blend(d, |i, j, k| {
        let h = hash(mix32(seed ^ 0x5bd1_e995), [x.wrapping_add(i), y.wrapping_add(j), z.wrapping_add(k)]);
        (h >> 8) as f32 * (2.0 / 16_777_216.0) - 1.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::hash::HashRng;

    #[test]
    fn gradient_noise_vanishes_on_the_lattice_where_its_slope_is_the_gradient() {
        for seed in [0, 7] {
            for (x, y, z) in [(0, 0, 0), (3, -2, 5), (-1, -1, -1), (255, 256, 257)] {
                let p = Vec3::new(x as f32, y as f32, z as f32);
                assert_eq!(gradient_noise(p, seed), 0.0);
                let h = 1.0 / 256.0;
                let slope = |e: Vec3| (gradient_noise(p + e * h, seed) - gradient_noise(p - e * h, seed)) / (2.0 * h);
                let g = [slope(Vec3::X), slope(Vec3::Y), slope(Vec3::Z)];
                // The twelve edges: two components of ±1, one of 0.
                let ones = g.iter().filter(|v| (v.abs() - 1.0).abs() < 1e-3).count();
                let zeros = g.iter().filter(|v| v.abs() < 1e-3).count();
                assert_eq!((ones, zeros), (2, 1), "{g:?}");
            }
        }
    }

    #[test]
    fn noise_is_twice_differentiable_across_cells() {
        // A second difference that spans the face of a cell is as small as within.
        for noise in [gradient_noise, value_noise] {
            for seed in [0, 3] {
                let f = |x: f32| f64::from(noise(Vec3::new(x, 0.37, 0.81), seed));
                let h = 1.0 / 128.0;
                let second = |x: f32| (f(x + h) - 2.0 * f(x) + f(x - h)) / f64::from(h * h);
                for x in [1.0_f32, 2.0, -3.0] {
                    assert!(second(x).abs() < 3.0, "{} at {x}", second(x));
                    assert!((second(x + 2.0 * h) - second(x - 2.0 * h)).abs() < 8.0);
                }
            }
        }
    }

    /// E38: products of gradients and offsets joined by the fade, not a bicubic patch; in two dimensions with unit
    /// gradients they reach √½, in the middle of a cell whose gradients all point there, so that ½(v + 1) leaves [0, 1]
    /// nowhere and fills it nowhere either.
    #[test]
    fn gradient_noise_in_the_plane_reaches_the_root_of_a_half() {
        let corner = |x: f32, y: f32, i: u8, j: u8| {
            // A gradient towards the middle.
            let (ox, oy) = (x - f32::from(i), y - f32::from(j));
            (ox * (0.5 - f32::from(i)) + oy * (0.5 - f32::from(j))) * std::f32::consts::SQRT_2
        };
        let noise = |x: f32, y: f32| {
            let (u, v) = (quintic_fade(x), quintic_fade(y));
            let row = |j| corner(x, y, 0, j) * (1.0 - u) + corner(x, y, 1, j) * u;
            row(0) * (1.0 - v) + row(1) * v
        };
        assert!((noise(0.5, 0.5) - 0.5_f32.sqrt()).abs() < 1e-6);
        let most = (0..=100 * 100).map(|i| noise((i % 101) as f32 / 100.0, (i / 101) as f32 / 100.0));
        assert!(most.fold(0.0, f32::max) <= 0.5_f32.sqrt() + 1e-6);
        assert_eq!((quintic_fade(0.0), quintic_fade(0.5), quintic_fade(1.0)), (0.0, 0.5, 1.0));
    }

    #[test]
    fn value_noise_takes_random_values_on_the_lattice() {
        let values: Vec<f32> = (0..2000).map(|i| value_noise(Vec3::new(i as f32, 2.0, 3.0), 1)).collect();
        let mean = values.iter().sum::<f32>() / 2000.0;
        let square = values.iter().map(|v| v * v).sum::<f32>() / 2000.0;
        // Uniform in [−1, 1): variance 1/3; four standard errors.
        assert!(mean.abs() < 4.0 * (1.0_f32 / 3.0 / 2000.0).sqrt());
        assert!((square - 1.0 / 3.0).abs() < 4.0 * (4.0_f32 / 45.0 / 2000.0).sqrt());
    }

    #[test]
    fn the_range_holds_and_seeds_differ() {
        let mut rng = HashRng::new(5);
        let mut most = 0.0_f32;
        for _ in 0..200_000 {
            let p = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 200.0 - 100.0;
            most = most.max(gradient_noise(p, 0).abs());
        }
        assert!(most > 0.8 && most < 1.04, "{most}");
        let p = Vec3::new(0.3, 0.6, 0.2);
        assert_ne!(gradient_noise(p, 1), gradient_noise(p, 2));
        for far in [Vec3::splat(3e38), Vec3::splat(-1e12), Vec3::splat(f32::NAN), Vec3::splat(f32::INFINITY)] {
            assert!(gradient_noise(far, 0).is_finite() && value_noise(far, 9).is_finite());
        }
    }

    /// By hand from the permutation: cell (0, 0, 0), all corners.
    #[test]
    fn a_value_by_hand() {
        let at = |i: usize| usize::from(PERMUTATION[i & 255]);
        let directions: [[f32; 3]; 16] = [
            [1., 1., 0.],
            [-1., 1., 0.],
            [1., -1., 0.],
            [-1., -1., 0.],
            [1., 0., 1.],
            [-1., 0., 1.],
            [1., 0., -1.],
            [-1., 0., -1.],
            [0., 1., 1.],
            [0., -1., 1.],
            [0., 1., -1.],
            [0., -1., -1.],
            [1., 1., 0.],
            [-1., 1., 0.],
            [0., -1., 1.],
            [0., -1., -1.],
        ];
        let mut sum = 0.0;
        for (x, y, z) in (0..8).map(|i| (i & 1, i >> 1 & 1, i >> 2)) {
            let g = directions[at(at(at(x) + y) + z) & 15];
            sum += (0.5 - x as f32) * g[0] + (0.5 - y as f32) * g[1] + (0.5 - z as f32) * g[2];
        }
        assert!((gradient_noise(Vec3::splat(0.5), 0) - sum / 8.0).abs() < 1e-6);
    }
}
