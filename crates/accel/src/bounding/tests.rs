//! Laws of all bounding volumes: they contain their points, tighter ones lie in looser ones, and their tests are
//! conservative.

use super::*;
use crate::tests::{direction, in_cube, soup};
use crate::{Bvh, Geometry};
use steradian_math::{Ray, Vec3, hash::HashRng};

/// Sets of points of many shapes, some far from the origin, some flat.
fn sets() -> Vec<Vec<Vec3>> {
    let mut rng = HashRng::new(111);
    let mut sets = Vec::new();
    for round in 0..24 {
        let stretch = [Vec3::ONE, Vec3::new(10.0, 1.0, 0.1), Vec3::new(1.0, 1.0, 0.0)][round % 3];
        let turn = glam::Mat3::from_axis_angle(direction(&mut rng), 6.0 * rng.next_f32());
        let shift = in_cube(&mut rng) * [0.0, 10.0, 1e4][round / 3 % 3];
        let scale = [1.0, 1e-3, 1e6][round / 9 % 3];
        sets.push((0..200).map(|_| (turn * (in_cube(&mut rng) * stretch) + shift) * scale).collect());
    }
    sets
}

/// All volumes of a set, with names.
struct All {
    ritter: Sphere,
    smallest: Sphere,
    aligned: Bounds3,
    principal: OrientedBox,
    flush: OrientedBox,
    dops: [KDop; 4],
    hull: Hull,
}

impl All {
    fn of(points: &[Vec3]) -> Self {
        let hull = Hull::around(points).expect("finite");
        Self {
            ritter: Sphere::ritter(points).expect("finite"),
            smallest: Sphere::smallest(points).expect("finite"),
            aligned: Bounds3::from_points(points.iter().copied()),
            principal: OrientedBox::principal(points).expect("finite"),
            flush: OrientedBox::flush(&hull),
            dops: Directions::SETS.map(|d| KDop::around(d, points).expect("finite")),
            hull,
        }
    }

    /// A question to each.
    fn ask<T>(&self, question: impl Fn(&dyn AnyVolume) -> T) -> Vec<T> {
        let all: [&dyn AnyVolume; 10] = [
            &self.ritter,
            &self.smallest,
            &self.aligned,
            &self.principal,
            &self.flush,
            &self.dops[0],
            &self.dops[1],
            &self.dops[2],
            &self.dops[3],
            &self.hull,
        ];
        all.into_iter().map(question).collect()
    }
}

/// [`Volume`] without what needs to know the kind.
trait AnyVolume {
    fn has(&self, p: DVec3) -> bool;
    fn hit(&self, origin: DVec3, direction: DVec3) -> Option<[f64; 2]>;
    fn measure(&self) -> f64;
}

impl<V: Volume> AnyVolume for V {
    fn has(&self, p: DVec3) -> bool {
        self.contains(p)
    }
    fn hit(&self, origin: DVec3, direction: DVec3) -> Option<[f64; 2]> {
        self.intersect(origin, direction)
    }
    fn measure(&self) -> f64 {
        self.volume()
    }
}

#[test]
fn every_point_is_inside_and_tight_ones_are_small() {
    for points in sets() {
        let all = All::of(&points);
        for p in &points {
            assert!(all.ask(|v| v.has(p.as_dvec3())).into_iter().all(|is_in| is_in), "{p}");
        }
        let [ritter, smallest, aligned, principal, flush, k6, k14, k18, k26, hull] = all.ask(|v| v.measure())[..]
        else {
            panic!("ten volumes")
        };
        // Up to the rounding of corners to `f32`, far from the origin.
        let far = points.iter().map(|p| p.abs().max_element()).fold(0.0, f32::max);
        let slack = f64::from(far).powi(3) * 1e-6;
        assert!(hull <= k26 + slack && k26 <= k18 + slack && k26 <= k14 + slack, "{hull} {k26} {k18} {k14}");
        assert!(k18 <= k6 + slack && k14 <= k6 + slack && (k6 - aligned).abs() <= slack, "{k18} {k14} {k6} {aligned}");
        assert!(hull <= flush + slack && hull <= principal + slack && hull <= smallest + slack);
        assert!(flush <= aligned * (1.0 + 1e-9) + slack && smallest <= ritter * (1.0 + 1e-9), "{flush} {aligned}");
    }
}

#[test]
fn the_turned_box_is_found_again() {
    let mut rng = HashRng::new(112);
    for _ in 0..20 {
        let turn = glam::DMat3::from_axis_angle(direction(&mut rng).as_dvec3().normalize(), 2.0);
        let corner = |i: u32| DVec3::new(f64::from(i & 1), 2.0 * f64::from(i >> 1 & 1), 3.0 * f64::from(i >> 2 & 1));
        let mut points: Vec<Vec3> = (0..8).map(|i| (turn * corner(i)).as_vec3()).collect();
        // The middle of a face does not mislead it, though it does mislead the principal axes.
        points.extend([(turn * DVec3::new(0.9, 0.1, 2.9)).as_vec3(); 20]);
        let flush = OrientedBox::flush(&Hull::around(&points).expect("finite"));
        assert!((flush.volume() - 6.0).abs() < 1e-4, "{}", flush.volume());
        assert!(OrientedBox::principal(&points).expect("finite").volume() > 6.01);
    }
}

#[test]
fn the_parts_of_lines_inside_are_inside() {
    let mut rng = HashRng::new(113);
    for points in sets() {
        let all = All::of(&points);
        let size = all.smallest.radius;
        for _ in 0..60 {
            let d = direction(&mut rng).as_dvec3() * 0.7;
            let through = points[rng.next_u64() as usize % points.len()].as_dvec3();
            let origin = through - d * size * 2.0;
            // A line through a point of the set hits all.
            for t in all.ask(|v| v.hit(origin, d)) {
                let [t0, t1] = t.expect("the line goes through a point of the set");
                assert!(t0 <= 2.0 * size * (1.0 + 1e-6) && t1 >= 2.0 * size * (1.0 - 1e-6), "{t0} {t1} {size}");
            }
            // Whatever is hit, its ends are on the surface: a little inside is in, a little outside is not.
            let line = all.smallest.center + (in_cube(&mut rng).as_dvec3()) * size * 1.5;
            let ends = all.ask(|v| {
                let Some([t0, t1]) = v.hit(line, d).filter(|[a, b]| b - a > 1e-3 * size) else { return true };
                let (e, at) = (1e-4 * size, |t: f64| line + d * t);
                v.has(at(t0 + e)) && v.has(at(t1 - e)) && !v.has(at(t0 - e)) && !v.has(at(t1 + e))
            });
            // Flat sets have no inside to speak of.
            assert!(ends.into_iter().all(|is_right| is_right) || all.hull.volume() < 1e-6 * size.powi(3));
        }
        let none = all.ask(|v| v.hit(DVec3::ZERO, DVec3::ZERO).is_none() && v.hit(DVec3::NAN, DVec3::X).is_none());
        assert!(none.into_iter().all(|is_none| is_none));
    }
}

#[test]
fn volumes_that_overlap_say_so() {
    let mut rng = HashRng::new(114);
    let mut apart = [0; 4];
    for _ in 0..300 {
        let center = in_cube(&mut rng) * 2.5;
        let mut set =
            |at: Vec3| -> Vec<Vec3> { (0..12).map(|_| at + in_cube(&mut rng) * Vec3::new(1.0, 0.3, 0.2)).collect() };
        let (a, b) = (All::of(&set(Vec3::ZERO)), All::of(&set(center)));
        // Hulls overlap where a point of one is in the other, and more.
        let shared = a.hull.vertices().iter().any(|p| b.hull.contains(*p))
            || b.hull.vertices().iter().any(|p| a.hull.contains(*p));
        let hulls = a.hull.overlaps(&b.hull);
        assert_eq!(hulls, b.hull.overlaps(&a.hull));
        assert!(hulls || !shared);
        let looser = [
            a.flush.overlaps(&b.flush),
            a.principal.overlaps(&b.principal),
            a.smallest.overlaps(&b.smallest),
            a.aligned.overlaps(&b.aligned),
            a.dops[3].overlaps(&b.dops[3]),
        ];
        assert!(!hulls || looser.into_iter().all(|yes| yes), "{looser:?}");
        assert!(!a.dops[3].overlaps(&b.dops[3]) || a.dops[0].overlaps(&b.dops[0]));
        for (count, yes) in apart.iter_mut().zip([hulls, looser[0], looser[4], looser[3]]) {
            *count += u32::from(!yes);
        }
    }
    // Tight ones part more.
    assert!(apart[0] >= apart[2] && apart[2] >= apart[3] && apart[0] >= apart[1] && apart[3] > 20, "{apart:?}");
}

#[test]
fn bounding_volumes_are_conservative_and_that_is_measured() {
    let mesh = soup(30, 0.4, 115);
    let bvh = Bvh::build(&[Geometry::triangles(&mesh.0, &mesh.1)]).expect("few triangles");
    let all = All::of(&mesh.0);
    let mut answers = [Answers::default(); 10];
    let (mut exact, mut aggressive, mut approximate) = (Answers::default(), Answers::default(), Answers::default());
    let mut rng = HashRng::new(116);
    for _ in 0..4000 {
        let origin = direction(&mut rng) * 4.0;
        let ray = Ray::new(origin, in_cube(&mut rng) * 2.2 - origin);
        let truth = bvh.occluded(&ray, &());
        let hits = all.ask(|v| v.hit(ray.origin.as_dvec3(), ray.direction.as_dvec3()).is_some_and(|t| t[1] > 0.0));
        for (answer, hit) in answers.iter_mut().zip(hits) {
            answer.add(hit, truth);
        }
        exact.add(bvh.intersect(&ray, &()).is_some(), truth);
        // Every other triangle only; and a ball that is too small.
        let half = truth && bvh.intersect(&ray, &()).is_some_and(|hit| hit.id.prim % 2 == 0);
        aggressive.add(half, truth);
        let small = Sphere { radius: all.smallest.radius * 0.5, ..all.smallest };
        approximate.add(small.intersect(ray.origin.as_dvec3(), ray.direction.as_dvec3()).is_some(), truth);
    }
    assert!(answers.iter().all(|a| a.class() == Class::Conservative), "{answers:?}");
    assert_eq!(
        [exact.class(), aggressive.class(), approximate.class()],
        [Class::Exact, Class::Aggressive, Class::Approximate]
    );
    let false_hits = answers.map(|a| a.error_rates()[0]);
    // The hull errs least, and the sphere of Ritter more than the smallest one.
    assert!(false_hits.iter().all(|rate| *rate >= false_hits[9]) && false_hits[0] >= false_hits[1], "{false_hits:?}");
}
