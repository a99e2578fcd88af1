//! User primitives and filters are asked as promised.

use super::{assorted_rays, icosphere, levels, soup};
use crate::{Bvh, Geometry, Hit, Instance, PrimId, TopLevel, UserHit, UserPrimitives, WORLD};
use steradian_math::{Bounds3, DVec3, Ray, Transform, Vec3, hash::HashRng};

/// Spheres as user primitives.
struct Spheres(Vec<(Vec3, f32)>);

impl Spheres {
    fn random(count: usize) -> Self {
        let mut rng = HashRng::new(21);
        Self((0..count).map(|_| (super::in_cube(&mut rng), 0.01 + 0.1 * rng.next_f32())).collect())
    }

    fn boxes(&self) -> Vec<Bounds3> {
        self.0.iter().map(|&(c, r)| Bounds3 { min: c - r * 1.001, max: c + r * 1.001 }).collect()
    }

    fn nearest(&self, ray: &Ray) -> Option<(f32, u32)> {
        let id = |prim| PrimId { instance: WORLD, geom: 0, prim };
        let hits = (0..self.0.len() as u32).filter_map(|prim| Some((self.intersect(id(prim), ray)?.t, prim)));
        hits.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
    }
}

impl UserPrimitives for Spheres {
    fn intersect(&self, id: PrimId, ray: &Ray) -> Option<UserHit> {
        let (center, radius) = self.0[id.prim as usize];
        let (o, d) = ((ray.origin - center).as_dvec3(), ray.direction.as_dvec3());
        let (a, b) = (d.dot(d), o.dot(d));
        let root = (b * b - a * (o.dot(o) - f64::from(radius * radius))).sqrt();
        let inside = |t: &f32| *t > 0.0 && *t < ray.t_max;
        let t = [(-b - root) / a, (-b + root) / a].map(|t| t as f32).into_iter().find(inside)?;
        Some(UserHit { t, u: 0.25, v: 0.75 })
    }
}

#[test]
fn user_primitives_are_found() {
    let spheres = Spheres::random(500);
    let bvh = Bvh::build(&[Geometry::boxes(&spheres.boxes())]).expect("few primitives");
    let mut hits = 0;
    for ray in assorted_rays(Vec3::ZERO, 1.5, 5000, 22) {
        let expected = spheres.nearest(&ray);
        hits += usize::from(expected.is_some());
        for isa in levels() {
            let bvh = bvh.clone().with_isa(isa);
            let hit = bvh.intersect(&ray, &spheres);
            assert_eq!(hit.map(|h| (h.t, h.id.prim)), expected, "{ray:?}");
            assert!(hit.is_none_or(|h| (h.u, h.v, h.id.geom) == (0.25, 0.75, 0)));
            assert_eq!(bvh.occluded(&ray, &spheres), expected.is_some());
        }
    }
    assert!(hits > 500);
}

#[test]
fn user_primitives_mix_with_triangles_and_instances() {
    let spheres = Spheres::random(100);
    let mesh = soup(300, 0.1, 23);
    let (boxes, triangles) = (spheres.boxes(), Geometry::triangles(&mesh.0, &mesh.1));
    let only_mesh = Bvh::build(&[triangles]).expect("few primitives");
    let both = [triangles, Geometry::boxes(&boxes)];
    let bvh = Bvh::build(&both).expect("few primitives");
    let m = Transform::translate(DVec3::new(5.0, 0.0, 0.0)).affine().expect("not singular");
    let instance = Instance::new(0, m);
    let top = TopLevel::build(&both, vec![bvh.clone()], &[instance]).expect("valid");
    for ray in assorted_rays(Vec3::ZERO, 1.0, 5000, 24) {
        let on_mesh = only_mesh.intersect(&ray, &()).map(|h| (h.t, 0, h.id.prim));
        let on_sphere = spheres.nearest(&ray).map(|(t, prim)| (t, 1, prim));
        let expected = [on_mesh, on_sphere].into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0));
        let hit = bvh.intersect(&ray, &spheres).map(|h| (h.t, h.id.geom, h.id.prim));
        assert_eq!(hit, expected);
        assert_eq!(bvh.occluded(&ray, &spheres), expected.is_some());
        if let Some(hit) = top.intersect(&ray, &spheres).filter(|hit| hit.id.instance == WORLD) {
            assert_eq!(Some((hit.t, hit.id.geom, hit.id.prim)), expected);
        }
        // Only the origin moves, by a number that rounds: hits agree up to that.
        let moved = Ray { origin: ray.origin + Vec3::X * 5.0, ..ray };
        let inner = Ray { origin: moved.origin - Vec3::X * 5.0, ..ray };
        let (a, b) = (top.intersect(&moved, &spheres), bvh.intersect(&inner, &spheres));
        if let Some(a) = a.filter(|a| a.id.instance == 0) {
            assert_eq!(Some((a.t, a.id.geom, a.id.prim)), b.map(|b| (b.t, b.id.geom, b.id.prim)));
        }
    }
}

/// Lets only triangles with an even index count, and remembers nothing.
struct EvenOnly;

impl UserPrimitives for EvenOnly {
    fn intersect(&self, _: PrimId, _: &Ray) -> Option<UserHit> {
        None
    }

    fn accept(&self, hit: &Hit, ray: &Ray) -> bool {
        assert!(hit.t > 0.0 && hit.t < ray.t_max && hit.u >= 0.0 && hit.v >= 0.0 && hit.u + hit.v <= 1.0 + 1e-6);
        hit.id.prim.is_multiple_of(2)
    }
}

#[test]
fn filtered_triangles_let_rays_through() {
    let (positions, indices) = icosphere(2);
    let even: Vec<_> = indices.iter().step_by(2).copied().collect();
    let filtered = Bvh::build(&[Geometry::triangles(&positions, &indices).filtered(true)]).expect("few primitives");
    let unfiltered = Bvh::build(&[Geometry::triangles(&positions, &indices)]).expect("few primitives");
    let expected = Bvh::build(&[Geometry::triangles(&positions, &even)]).expect("few primitives");
    for ray in assorted_rays(Vec3::ZERO, 1.5, 5000, 25) {
        let even_hit = expected.intersect(&ray, &()).map(|h| (h.t, 2 * h.id.prim));
        assert_eq!(filtered.intersect(&ray, &EvenOnly).map(|h| (h.t, h.id.prim)), even_hit);
        assert_eq!(filtered.occluded(&ray, &EvenOnly), even_hit.is_some());
        // Without the flag nobody is asked.
        assert_eq!(unfiltered.intersect(&ray, &EvenOnly), unfiltered.intersect(&ray, &()));
    }
}

#[test]
fn answers_outside_of_the_interval_are_ignored() {
    struct Liar(f32);
    impl UserPrimitives for Liar {
        fn intersect(&self, _: PrimId, _: &Ray) -> Option<UserHit> {
            Some(UserHit { t: self.0, u: 0.0, v: 0.0 })
        }
    }
    let bvh = Bvh::build(&[Geometry::boxes(&[Bounds3 { min: -Vec3::ONE, max: Vec3::ONE }])]).expect("few primitives");
    let ray = Ray { t_max: 10.0, ..Ray::new(Vec3::ZERO, Vec3::X) };
    for t in [f32::NAN, -1.0, 0.0, 10.0, f32::INFINITY] {
        assert!(bvh.intersect(&ray, &Liar(t)).is_none(), "{t}");
    }
    assert!(bvh.intersect(&ray, &Liar(9.0)).is_some());
}

#[test]
fn all_hits_are_found_in_order() {
    let spheres = Spheres::random(60);
    let mesh = soup(300, 0.5, 26);
    let boxes = spheres.boxes();
    let geometry = [Geometry::triangles(&mesh.0, &mesh.1), Geometry::boxes(&boxes)];
    let alone: Vec<_> = mesh.1.iter().map(|&t| super::build(&(mesh.0.clone(), vec![t]))).collect();
    let object = Bvh::build(&geometry).expect("few primitives");
    let still = Transform::translate(DVec3::ZERO).affine().expect("not singular");
    let instances = [0; 2].map(|object| Instance::new(object, still));
    let top = TopLevel::build(&geometry, vec![object.clone()], &instances).expect("valid");
    let mut most = 0;
    for ray in assorted_rays(Vec3::ZERO, 1.0, 1500, 27) {
        let id = |geom: u32, prim: usize| PrimId { instance: WORLD, geom, prim: prim as u32 };
        let on_triangles = alone
            .iter()
            .enumerate()
            .filter_map(|(i, bvh)| bvh.intersect(&ray, &()).map(|hit| Hit { id: id(0, i), ..hit }));
        let on_spheres = (0..60).filter_map(|i| {
            let UserHit { t, u, v } = spheres.intersect(id(1, i), &ray)?;
            Some(Hit { t, u, v, id: id(1, i) })
        });
        let mut expected: Vec<_> = on_triangles.chain(on_spheres).collect();
        expected.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.id.cmp(&b.id)));
        most = most.max(expected.len());
        for isa in levels() {
            assert_eq!(object.clone().with_isa(isa).all_hits(&ray, &spheres), expected, "{isa:?} {ray:?}");
        }
        // The world and two instances in the same place: each hit three times, the world's last.
        let thrice: Vec<_> = expected
            .iter()
            .flat_map(|&hit| [0, 1, WORLD].map(|instance| Hit { id: PrimId { instance, ..hit.id }, ..hit }))
            .collect();
        let mut found = top.all_hits(&ray, &spheres);
        // Equal distances of several primitives are ordered by instance first.
        let key = |h: &Hit| (h.t.to_bits(), h.id.geom, h.id.prim, h.id.instance);
        found.sort_by_key(key);
        let mut thrice = thrice;
        thrice.sort_by_key(key);
        assert_eq!(found, thrice);
        assert_eq!(object.all_hits(&ray, &spheres).first().copied(), object.intersect(&ray, &spheres));
    }
    assert!(most > 5, "{most}");
}
