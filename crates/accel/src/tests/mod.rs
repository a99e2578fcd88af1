//! Properties of every hierarchy, tested through the public interface: fixtures here, one property in each file.

mod batch;
mod brute_force;
mod builders;
mod degenerate;
mod determinism;
mod garbage;
mod instances;
mod update;
mod users;
mod watertight;

use crate::{Bvh, Geometry, Isa};
use steradian_math::{Ray, Vec3, hash::HashRng};

/// A mesh: vertex positions and triangles.
pub(crate) type Mesh = (Vec<Vec3>, Vec<[u32; 3]>);

/// The levels this machine has.
fn levels() -> impl Iterator<Item = Isa> {
    Isa::ALL.into_iter().filter(|isa| isa.is_supported())
}

fn build(mesh: &Mesh) -> Bvh {
    Bvh::build(&[Geometry::triangles(&mesh.0, &mesh.1)]).expect("few primitives")
}

/// Uniform in the cube `[-1, 1]³`.
pub(crate) fn in_cube(rng: &mut HashRng) -> Vec3 {
    Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 2.0 - 1.0
}

/// Uniform on the sphere, nearly.
pub(crate) fn direction(rng: &mut HashRng) -> Vec3 {
    loop {
        let v = in_cube(rng);
        if (0.01..1.0).contains(&v.length_squared()) {
            return v.normalize();
        }
    }
}

/// Small triangles at random places in the unit cube, each with its own vertices.
pub(crate) fn soup(count: u32, size: f32, seed: u64) -> Mesh {
    let mut rng = HashRng::new(seed);
    let mut positions = Vec::new();
    for _ in 0..count {
        let center = in_cube(&mut rng);
        positions.extend((0..3).map(|_| center + in_cube(&mut rng) * size));
    }
    (positions, (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

/// A closed sphere: an icosahedron whose triangles are divided into four, `levels` times.
pub(crate) fn icosphere(levels: u32) -> Mesh {
    let g = (1.0 + 5.0_f32.sqrt()) / 2.0;
    let mut positions = Vec::new();
    for (a, b) in [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)] {
        positions.extend([Vec3::new(0.0, a, b), Vec3::new(a, b, 0.0), Vec3::new(b, 0.0, a)].map(Vec3::normalize));
    }
    // Faces of the icosahedron: all triples of vertices at the smallest distance from each other.
    let edge = positions[1..].iter().map(|p| p.distance(positions[0])).fold(f32::MAX, f32::min) * 1.01;
    let near = |i: u32, j: u32| positions[i as usize].distance(positions[j as usize]) < edge;
    let mut indices = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            indices.extend((b + 1..12).filter(|&c| near(a, b) && near(b, c) && near(a, c)).map(|c| [a, b, c]));
        }
    }
    assert_eq!(indices.len(), 20);
    for _ in 0..levels {
        let mut middles = std::collections::HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push(((positions[a as usize] + positions[b as usize]) * 0.5).normalize());
                positions.len() as u32 - 1
            })
        };
        let divided = indices.iter().flat_map(|&[a, b, c]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        });
        indices = divided.collect();
    }
    (positions, indices)
}

/// Rays of many kinds through a region: inside out, outside in, along axes, in planes, unnormalised and bounded.
pub(crate) fn assorted_rays(center: Vec3, size: f32, count: usize, seed: u64) -> Vec<Ray> {
    let mut rng = HashRng::new(seed);
    let mut ray = |i: usize| {
        let origin = center + in_cube(&mut rng) * size;
        let d = direction(&mut rng);
        match i % 8 {
            0 => Ray::new(origin, Vec3::X * d.x.signum()),
            1 => Ray::new(origin, Vec3::new(d.x, 0.0, d.z)),
            2 => Ray::new(origin, Vec3::new(-0.0, d.y, 0.0)),
            3 => Ray::new(center + d * size * 3.0, origin - (center + d * size * 3.0)),
            4 => Ray { t_max: 300.0 * size, ..Ray::new(origin, d * 1e-3) },
            5 => Ray { t_max: 1e-3 * size, ..Ray::new(origin, d * 1e3) },
            _ => Ray::new(origin, d),
        }
    };
    (0..count).map(&mut ray).collect()
}
