//! A thousand scenes that nobody would model: they are built and traced, and every way to ask gives one answer.

use super::{direction, in_cube, levels};
use crate::{Builder, Bvh, Geometry, Instance, TopLevel};
use steradian_math::{Ray, Vec3, hash::HashRng, transform::Transform};

/// Numbers that geometry should not have, and some that it may have.
const NUMBERS: [f32; 16] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    1e-45,
    1e-38,
    -1e-38,
    1e-20,
    1e20,
    3e38,
    -3e38,
    f32::MAX,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
];

/// A scene: the kind of mess by its number.
fn mess(number: u64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut rng = HashRng::new(number);
    let count = [0, 1, 2, 7, 8, 9, 33, 150][rng.next_u64() as usize % 8];
    let kind = number % 8;
    let size = [1e-30, 1e-3, 1.0, 1e6, 1e25, 1e37][rng.next_u64() as usize % 6];
    let mut positions = Vec::new();
    for _ in 0..count {
        let center = in_cube(&mut rng);
        let mut corner = |i: u64| match kind {
            // Anything from the table.
            0 => Vec3::from_array([0; 3].map(|_| NUMBERS[rng.next_u64() as usize % NUMBERS.len()])),
            // Slivers: two corners nearly equal, or three nearly in line.
            1 => (center + in_cube(&mut rng) * [1.0, 1e-7, 1.0][i as usize]) * size,
            2 => (center + Vec3::new(1.0, 2.0, -1.0) * rng.next_f32() + in_cube(&mut rng) * 1e-7) * size,
            // All at one place, on a coarse grid, or in a plane.
            3 => Vec3::new(i as f32, (i * i) as f32, 1.0) * size,
            4 => (in_cube(&mut rng) * 2.0).round() * size,
            5 => (in_cube(&mut rng) * Vec3::new(1.0, 0.0, 1.0)) * size,
            // Extents that differ by many orders, and clean triangles.
            6 => in_cube(&mut rng) * NUMBERS[rng.next_u64() as usize % 12] * size,
            _ => (center + in_cube(&mut rng) * 0.2) * size,
        };
        positions.extend([corner(0), corner(1), corner(2)]);
    }
    let mut indices: Vec<[u32; 3]> = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    // Duplicates, and indices that point nowhere.
    indices.extend_from_within(..indices.len() / 3);
    if number.is_multiple_of(5) {
        indices.push([0, 1, u32::MAX]);
        indices.push([0, 0, 0]);
    }
    (positions, indices)
}

/// Rays at the middles of triangles and anywhere, bad ones among them.
fn rays(positions: &[Vec3], rng: &mut HashRng) -> Vec<Ray> {
    let mut rays = Vec::new();
    for i in 0..48 {
        let from = if i % 3 == 0 { in_cube(rng) * 1e3 } else { in_cube(rng) };
        let toward = match positions.len() as u64 / 3 {
            0 => direction(rng),
            n => {
                let first = 3 * (rng.next_u64() % n) as usize;
                (positions[first] + positions[first + 1] + positions[first + 2]) / 3.0 - from
            }
        };
        let mut ray = Ray::new(from, if i % 4 == 0 { direction(rng) } else { toward });
        match i % 16 {
            13 => ray.direction[i / 16] = NUMBERS[rng.next_u64() as usize % NUMBERS.len()],
            14 => ray.origin[i / 16] = NUMBERS[rng.next_u64() as usize % NUMBERS.len()],
            15 => ray.t_max = NUMBERS[rng.next_u64() as usize % NUMBERS.len()],
            _ => {}
        }
        rays.push(ray);
    }
    rays
}

#[test]
fn a_thousand_messes_are_built_and_traced() {
    let mut hits = 0;
    for number in 0..1000 {
        let (positions, indices) = mess(number);
        let builder = Builder::ALL[number as usize / 8 % 4];
        let bvh = Bvh::build_by(builder, &[Geometry::triangles(&positions, &indices)]).expect("few primitives");
        assert!(bvh.bounds().is_empty() || bvh.bounds().min.is_finite() && bvh.bounds().max.is_finite());
        let rays = rays(&positions, &mut HashRng::new(number));
        let alone: Vec<_> = rays.iter().map(|ray| bvh.intersect(ray, &())).collect();
        for isa in levels() {
            let bvh = bvh.clone().with_isa(isa);
            let (mut together, mut occluded) = (vec![None; rays.len()], vec![false; rays.len()]);
            bvh.intersect_batch(&rays, &(), &mut together);
            bvh.occluded_batch(&rays, &(), &mut occluded);
            for (i, ray) in rays.iter().enumerate() {
                let what = || format!("{number} {isa:?} {ray:?}");
                let bits = |h: Option<crate::Hit>| h.map(|h| ([h.t, h.u, h.v].map(f32::to_bits), h.id));
                assert_eq!(bits(bvh.intersect(ray, &())), bits(alone[i]), "{}", what());
                assert_eq!(bits(together[i]), bits(alone[i]), "{}", what());
                assert_eq!([occluded[i], bvh.occluded(ray, &())], [alone[i].is_some(); 2], "{}", what());
                assert!(alone[i].is_none_or(|h| h.t > 0.0 && h.t < ray.t_max && ray.is_valid()), "{}", what());
            }
        }
        hits += alone.iter().flatten().count();
    }
    assert!(hits > 5000, "{hits}");
}

#[test]
fn messes_are_placed_and_traced() {
    let mut hits = 0;
    for number in 0..300 {
        let messes = [mess(number), mess(8 * number + 7), mess(number + 1)];
        let [first, second, world] = &messes;
        let build = |(positions, indices): &(Vec<Vec3>, Vec<[u32; 3]>)| {
            Bvh::build(&[Geometry::triangles(positions, indices)]).expect("few primitives")
        };
        let mut rng = HashRng::new(number);
        let mut place = |i: u32| {
            let (shift, turn) = (in_cube(&mut rng).as_dvec3(), in_cube(&mut rng).as_dvec3());
            let m = Transform::translate(shift) * Transform::rotate(turn, 200.0 * turn.x);
            Instance::new(i % 2, m.affine().expect("not singular"))
        };
        let mut instances: Vec<_> = (0..20).map(&mut place).collect();
        // Instances at one place tie.
        instances.extend_from_within(..5);
        let world_geometry = [Geometry::triangles(&world.0, &world.1)];
        let top = TopLevel::build(&world_geometry, vec![build(first), build(second)], &instances).expect("valid");
        // From places near each other, and any.
        let mut rng = HashRng::new(number + 1);
        let rays: Vec<_> = messes.iter().flat_map(|(positions, _)| rays(positions, &mut rng)).collect();
        let bundled = rays.iter().flat_map(|ray| {
            let mut rng = HashRng::new(u64::from(ray.direction.x.to_bits()));
            let shifted =
                move |_| Ray { origin: ray.origin + in_cube(&mut rng) * 1e-3, direction: direction(&mut rng), ..*ray };
            (0..9).map(shifted)
        });
        let rays: Vec<_> = rays.iter().copied().chain(bundled).collect();
        let bits = |h: Option<crate::Hit>| h.map(|h| ([h.t, h.u, h.v].map(f32::to_bits), h.id));
        let alone: Vec<_> = rays.iter().map(|ray| bits(top.intersect(ray, &()))).collect();
        for isa in levels() {
            let top = top.clone().with_isa(isa);
            let mut together = vec![None; rays.len()];
            top.intersect_batch(&rays, &(), &mut together);
            for (i, ray) in rays.iter().enumerate() {
                assert_eq!(bits(together[i]), alone[i], "{number} {isa:?} {ray:?}");
            }
        }
        hits += alone.iter().flatten().count();
    }
    assert!(hits > 5000, "{hits}");
}

#[test]
fn rays_that_are_no_rays_cost_nothing() {
    use crate::{Accel, Accelerator, Steps};
    let (positions, indices) = super::soup(3000, 0.1, 8);
    let geometries = [Geometry::triangles(&positions, &indices)];
    let good = super::assorted_rays(Vec3::ZERO, 1.0, 200, 5);
    for accelerator in Accelerator::ALL {
        let accel = Accel::build(accelerator, &geometries, Vec::new(), &[]).expect("few primitives");
        let costs = |rays: &[Ray]| {
            let both = |ray: &Ray| [accel.intersect_cost(ray, &()), accel.occluded_cost(ray, &())];
            rays.iter().flat_map(both).map(|Steps { steps, tests }| steps + tests).collect::<Vec<_>>()
        };
        let usual = costs(&good).iter().sum::<u64>() as f64 / (2 * good.len()) as f64;
        assert!(usual > 1.0, "{accelerator:?}");
        // One number of a ray at a time is none, or infinite, and all directions are.
        let mut bad = Vec::new();
        for number in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for (i, ray) in good.iter().take(70).enumerate() {
                let mut ray = *ray;
                match i % 7 {
                    6 => ray.t_max = if number > 0.0 { f32::NAN } else { number },
                    i if i < 3 => ray.origin[i] = number,
                    i => ray.direction[i - 3] = number,
                }
                bad.push(ray);
            }
        }
        let worst = costs(&bad).into_iter().max().unwrap_or(0) as f64;
        assert!(worst <= 2.5 * usual, "{accelerator:?}: {worst} steps, of good rays {usual}");
        assert!(bad.iter().all(|ray| accel.intersect(ray, &()).is_none() && !accel.occluded(ray, &())));
    }
}
