//! Streams: rays in any order, sorted so that neighbours go nearly the same way from nearly the same place.
//!
//! The key of a ray is the signs of its direction and its greatest axis, then the cell of its origin along a Z-order
//! curve, then the cell of its direction along another (Pharr et al., "Rendering Complex Scenes with Memory-Coherent
//! Ray Tracing", 1997; Garanzha and Loop, "Fast Ray Sorting and Breadth-First Packet Traversal for GPU Ray Tracing",
//! 2010).

use steradian_math::{Bounds3, Ray, Vec3};

/// Rays that are copied together and traced before the next ones.
const CHUNK: usize = 1 << 10;
/// Bits of a cell of the origins along each axis.
const ORIGIN_BITS: u32 = 5;
/// Bits of a cell of the directions along both axes.
const DIRECTION_BITS: u32 = 6;
/// Bits of a digit of the sort.
const DIGIT: u32 = 11;

/// Calls `trace` with rays in sorted order, chunk by chunk, and puts the answers where they belong.
pub(crate) fn in_order<T: Copy>(rays: &[Ray], answers: &mut [T], none: T, mut trace: impl FnMut(&[Ray], &mut [T])) {
    assert_eq!(rays.len(), answers.len(), "as many answers as rays");
    // Sort places, not rays: a ray is gathered once, when its chunk is traced.
    let order = sorted(rays);
    let mut sorted_rays = Vec::with_capacity(CHUNK.min(rays.len()));
    let mut of_sorted = vec![none; CHUNK.min(rays.len())];
    for places in order.chunks(CHUNK) {
        sorted_rays.clear();
        sorted_rays.extend(places.iter().map(|&place| rays[place as u32 as usize]));
        let of_sorted = &mut of_sorted[..places.len()];
        trace(&sorted_rays, of_sorted);
        for (&place, &answer) in places.iter().zip(&*of_sorted) {
            answers[place as u32 as usize] = answer;
        }
    }
}

/// Keys above, places below, by the keys; of equal keys the order stays. At most 2^32 rays.
fn sorted(rays: &[Ray]) -> Vec<u64> {
    // Quantise origins relative to the bounds of all valid rays.
    let usable = |ray: &&Ray| ray.is_valid();
    let bounds = rays.iter().filter(usable).fold(Bounds3::EMPTY, |b, ray| b.union_point(ray.origin));
    let cells = (1 << ORIGIN_BITS) as f32;
    let scale = (bounds.max * 0.5 - bounds.min * 0.5).recip() * (0.5 * cells);
    let scale = Vec3::select(scale.is_finite_mask(), scale, Vec3::ZERO);
    let key = |ray: &Ray| u64::from(key(ray, bounds.min, scale)) << 32;
    let mut keys: Vec<u64> = rays.iter().zip(0_u64..).map(|(ray, place)| key(ray) | place).collect();
    // Few keys: a comparison sort is cheaper than clearing the histograms.
    if keys.len() < 1 << DIGIT {
        keys.sort_unstable();
        return keys;
    }
    let mut other = vec![0; keys.len()];
    // Radix sort, least significant digit first; each pass is stable.
    for shift in (32..64).step_by(DIGIT as usize) {
        let digit = |key: u64| (key >> shift) as usize & ((1 << DIGIT) - 1);
        let mut starts = vec![0_usize; 1 << DIGIT];
        for &key in &keys {
            starts[digit(key)] += 1;
        }
        // Exclusive prefix sums of the histogram are the first places of the digits.
        let mut sum = 0;
        for start in &mut starts {
            sum += std::mem::replace(start, sum);
        }
        for &key in &keys {
            let start = &mut starts[digit(key)];
            other[*start] = key;
            *start += 1;
        }
        std::mem::swap(&mut keys, &mut other);
    }
    keys
}

/// The key of a ray. Numbers that are not finite give any key.
fn key(ray: &Ray, corner: Vec3, scale: Vec3) -> u32 {
    let (d, a) = (ray.direction, ray.direction.abs());
    let [z, x, y] = if a.x >= a.y && a.x >= a.z {
        [0, 1, 2]
    } else if a.y >= a.z {
        [1, 2, 0]
    } else {
        [2, 0, 1]
    };
    // Octant and dominant axis decide which plane of a slab is near and how triangles are sheared: they lead the key.
    let constants = (d.to_array().into_iter().fold(0, |signs, x| signs << 1 | u32::from(x < 0.0)) * 3) + z as u32;
    let cell = |x: f32, bits: u32| (x as u32).min((1 << bits) - 1);
    let half = (1 << DIRECTION_BITS) as f32;
    // Project the direction onto the face of its dominant axis, as in a cube map.
    let direction = [a[x] / a[z] * half, a[y] / a[z] * half].map(|x| cell(x, DIRECTION_BITS));
    let origin = ((ray.origin - corner) * scale).to_array().map(|x| cell(x, ORIGIN_BITS));
    (constants << (3 * ORIGIN_BITS) | interleaved(origin)) << (2 * DIRECTION_BITS) | interleaved(direction)
}

/// The bits of several numbers in turn.
fn interleaved<const N: usize>(numbers: [u32; N]) -> u32 {
    let mut bits = 0;
    for bit in (0..32 / N as u32).rev() {
        for number in numbers {
            bits = bits << 1 | number >> bit & 1;
        }
    }
    bits
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_go_in_turn() {
        assert_eq!(interleaved([0b101, 0b011]), 0b10_01_11);
        assert_eq!(interleaved([0b11, 0b00, 0b01]), 0b100_101);
    }

    #[test]
    fn every_ray_keeps_its_answer() {
        let mut rng = steradian_math::hash::HashRng::new(4);
        let mut number = || rng.next_f32() * 2.0 - 1.0;
        for len in [0, 1, 100, 5000] {
            let mut ray =
                |_| Ray::new(Vec3::new(number(), number(), number()), Vec3::new(number(), number(), number()));
            let mut rays: Vec<_> = (0..len).map(&mut ray).collect();
            if len > 3 {
                (rays[1].origin.x, rays[2].direction, rays[3].origin.y) = (f32::NAN, Vec3::ZERO, f32::INFINITY);
            }
            let mut answers = vec![0; rays.len()];
            let mut greatest = 0;
            in_order(&rays, &mut answers, 0, |rays, answers| {
                for (ray, answer) in rays.iter().zip(answers) {
                    *answer = ray.direction.x.to_bits();
                    // What cannot be traced may be anywhere.
                    if ray.is_valid() {
                        let constants = key(ray, Vec3::ZERO, Vec3::ZERO) >> 27;
                        assert!(constants >= greatest);
                        greatest = constants;
                    }
                }
            });
            assert!(rays.iter().zip(answers).all(|(ray, answer)| ray.direction.x.to_bits() == answer));
        }
    }
}
