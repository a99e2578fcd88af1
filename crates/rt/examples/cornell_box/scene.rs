//! The Cornell box: where it is, and what its surfaces are.

use std::{ops::ControlFlow, sync::Arc};
use steradian_math::{Bounds3, Vec3, hash::HashRng};
use steradian_rt::{context::IntersectionContext, *};

/// Local data of a hit-group record.
#[derive(Clone, Copy, Default)]
pub struct Surface {
    /// The part of light that it reflects, by colours.
    pub albedo: Vec3,
    /// Emitted radiance.
    pub emission: f32,
}

/// A point evenly distributed on the unit sphere, without trigonometry, whose bits differ from machine to machine.
pub fn on_sphere(rng: &mut HashRng) -> Vec3 {
    loop {
        let p = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 2.0 - 1.0;
        let square = p.length_squared();
        if square > 1e-4 && square <= 1.0 {
            return p / square.sqrt();
        }
    }
}

/// The sphere of radius one about the origin.
pub struct Sphere;
impl<I: Interface<Attributes = Vec3>> Intersection<I> for Sphere {
    fn run(&self, context: &mut IntersectionContext<I>) -> ControlFlow<EndSearch> {
        let (o, d) = (context.primitive().object_ray_origin(), context.primitive().object_ray_direction());
        let (a, b) = (d.dot(d), o.dot(d));
        // Well-conditioned: the square of the distance between the centre and the ray.
        let root = (a * (1.0 - (o - d * (b / a)).length_squared())).sqrt();
        if let (true, Some(kind)) = (root.is_finite(), HitKind::procedural(0)) {
            for t in [(-b - root) / a, (-b + root) / a] {
                context.report_hit(t, kind, o + d * t)?;
            }
        }
        ControlFlow::Continue(())
    }
}

/// Walls that begin behind the camera, far away, and spheres.
pub fn scene() -> Result<TopLevel, BuildError> {
    const FAR: f32 = -1000.0;
    let corner = |i: usize| {
        let side = |bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        Vec3::new(side(0), side(1), if i >> 2 & 1 == 1 { 1.0 } else { FAR })
    };
    let corners: Vec<Vec3> = (0..8).map(corner).collect();
    // Left, right, floor, ceiling, back.
    let walls: [[u16; 4]; 5] = [[0, 2, 6, 4], [1, 5, 7, 3], [0, 4, 5, 1], [2, 3, 7, 6], [4, 6, 7, 5]];
    let walls = walls.map(|[a, b, c, d]| [a, b, c, a, c, d]);
    let walls = walls
        .each_ref()
        .map(|wall| TriangleGeometry { indices: Indices::U16(wall), ..TriangleGeometry::new(&corners) });
    let walls = BottomLevel::build(Geometries::Triangles(&walls), BuildOptions::default())?;
    let around = [Bounds3::new(Vec3::NEG_ONE, Vec3::ONE)];
    let sphere = BottomLevel::build(Geometries::Boxes(&[BoxGeometry::new(&around)]), BuildOptions::default())?;
    let sphere = Arc::new(sphere);
    let place = |hit_group_offset: u32, [x, y, z]: [f32; 3]| {
        let rows = [[0.3, 0.0, 0.0, x], [0.0, 0.3, 0.0, y], [0.0, 0.0, 0.3, z]];
        Instance { hit_group_offset, transform: Transform3x4 { rows }, ..Instance::new(sphere.clone()) }
    };
    let instances = [Instance::new(Arc::new(walls)), place(5, [-0.5, -0.7, 0.25]), place(6, [0.5, -0.7, -0.25])];
    TopLevel::build(&instances, BuildOptions::default())
}

/// Records of hit groups: five walls, then two spheres.
pub fn records<K>(wall: Option<Handle<K>>, sphere: Option<Handle<K>>) -> Vec<Record<K, Surface>> {
    let surfaces = [
        (wall, [0.75, 0.1, 0.1], 0.0),
        (wall, [0.1, 0.6, 0.1], 0.0),
        (wall, [0.75, 0.75, 0.75], 0.0),
        (wall, [0.75, 0.75, 0.75], 1.0),
        (wall, [0.75, 0.75, 0.75], 0.0),
        (sphere, [0.85, 0.5, 0.65], 0.0),
        (sphere, [0.45, 0.75, 0.85], 0.0),
    ];
    let record = |(handle, albedo, emission): (_, [f32; 3], _)| Record {
        handle,
        local: Surface { albedo: albedo.into(), emission },
    };
    surfaces.map(record).into()
}
