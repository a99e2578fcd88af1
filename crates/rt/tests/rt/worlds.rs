//! Scenes and rays for tests.

use std::sync::Arc;
use steradian_math::{Vec3, hash::HashRng};
use steradian_rt::{
    BottomLevel, BuildOptions, Geometries, GeometryFlags, Instance, InstanceFlags, RayDesc, TopLevel, Transform3x4,
    TriangleGeometry,
};

/// A number in [−1, 1).
pub fn signed(rng: &mut HashRng) -> f32 {
    2.0 * rng.next_f32() - 1.0
}

/// A point in the cube [−1, 1)³.
pub fn in_cube(rng: &mut HashRng) -> Vec3 {
    Vec3::new(signed(rng), signed(rng), signed(rng))
}

/// Triangles about random places, three vertices each.
pub fn soup(rng: &mut HashRng, count: usize, size: f32) -> Vec<Vec3> {
    let triangle = |rng: &mut HashRng| {
        let center = in_cube(rng);
        [0; 3].map(|_| center + in_cube(rng) * size)
    };
    (0..count).flat_map(|_| triangle(rng)).collect()
}

/// A transform that turns, shears and at times mirrors; never singular.
pub fn transform(rng: &mut HashRng) -> Transform3x4 {
    let mut rows = [[0.0; 4]; 3];
    for (i, row) in rows.iter_mut().enumerate() {
        *row = [0; 4].map(|_| 0.4 * signed(rng));
        row[i] += if rng.next_f32() < 0.5 { 1.5 } else { -1.5 };
        row[3] *= 3.0;
    }
    Transform3x4 { rows }
}

/// A ray from somewhere around to somewhere within.
pub fn ray(rng: &mut HashRng) -> RayDesc {
    let origin = in_cube(rng) * 4.0;
    RayDesc::new(origin, in_cube(rng) * 1.5 - origin)
}

/// A bottom level of two geometries of triangles, of which only the first is opaque.
pub fn two_geometries(rng: &mut HashRng, count: usize) -> Arc<BottomLevel> {
    let (opaque, other) = (soup(rng, count, 0.5), soup(rng, count, 0.5));
    let geometries = [
        TriangleGeometry::new(&opaque),
        TriangleGeometry::new(&other).with_flags(GeometryFlags::NONE).with_transform(transform(rng)),
    ];
    Arc::new(BottomLevel::build(Geometries::Triangles(&geometries), BuildOptions::default()).expect("valid"))
}

/// Instances of some bottom levels with random places, masks, offsets and flags.
pub fn instances(rng: &mut HashRng, bottom_levels: &[Arc<BottomLevel>], count: usize) -> Vec<Instance> {
    let flags = |rng: &mut HashRng| {
        let flags = InstanceFlags::from_bits(rng.next_u64() as u8 & 0xf).expect("all are flags");
        let both = InstanceFlags::FORCE_OPAQUE | InstanceFlags::FORCE_NON_OPAQUE;
        if flags.contains(both) { InstanceFlags::NONE } else { flags }
    };
    let instance = |rng: &mut HashRng| {
        let which = (rng.next_u64() % bottom_levels.len() as u64) as usize;
        Instance::new(bottom_levels[which].clone())
            .with_transform(transform(rng))
            .with_mask(rng.next_u64() as u8)
            .with_custom_index(rng.next_u64() as u32 & 0xff_ffff)
            .with_hit_group_offset((rng.next_u64() % 5) as u32)
            .with_flags(flags(rng))
    };
    (0..count).map(|_| instance(rng)).collect()
}

/// A scene of some instances of two bottom levels.
pub fn scene(rng: &mut HashRng) -> (TopLevel, Vec<Instance>) {
    let bottom_levels = [two_geometries(rng, 12), two_geometries(rng, 12)];
    let instances = instances(rng, &bottom_levels, 7);
    (TopLevel::build(&instances, BuildOptions::default()).expect("valid"), instances)
}
