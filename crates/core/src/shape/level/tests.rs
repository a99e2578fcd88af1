use super::*;
use std::f64::consts::TAU;
use steradian_math::{Transform, hash::HashRng, intersect::triangle, warp};

fn turned(r: Revolution, t: Transform) -> LevelSet {
    LevelSet::new(Function::Revolution(r), r.corners(), t.affine().unwrap(), false).unwrap()
}

fn hit(l: &LevelSet, ray: &Ray) -> Option<f32> {
    l.intersect(ray, |_| true).map(|h| h.t)
}

/// A mesh of a surface of revolution, by points of its profile that pbrt-v3's manual gives.
fn mesh(profile: impl Fn(f64) -> DVec3, phi_max: f64, n: usize) -> Vec<[Vec3; 3]> {
    let at = |i: usize, j: usize| {
        let (phi, p) = (phi_max * i as f64 / n as f64, profile(j as f64 / n as f64));
        (glam::DMat3::from_rotation_z(phi) * p).as_vec3()
    };
    let quad = |i, j| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)];
        [[a, b, d], [a, d, c]]
    };
    (0..n * n).flat_map(|k| quad(k % n, k / n)).collect()
}

/// M60: the closed roots and normals of the three surfaces of revolution are those of dense meshes.
#[test]
fn surfaces_of_revolution_are_their_meshes() {
    let [a, b] = [DVec3::new(1.0, -0.4, -0.5), DVec3::new(0.3, 0.9, 1.1)];
    let phi = 4.0;
    type Curve = Box<dyn Fn(f64) -> DVec3>;
    let cases: [(Revolution, Curve); 3] = [
        (
            Revolution::line(DVec3::X * 0.8, DVec3::Z * 1.5, phi).unwrap(),
            Box::new(|v| DVec3::new(0.8 * (1.0 - v), 0.0, 1.5 * v)),
        ),
        (Revolution::line(a, b, phi).unwrap(), Box::new(move |v| a * (1.0 - v) + b * v)),
        (
            Revolution::parabola(0.7, [0.1, 1.2], phi).unwrap(),
            Box::new(|v| {
                let z = 0.1 + 1.1 * v;
                DVec3::new(0.7 * (z / 1.2_f64).sqrt(), 0.0, z)
            }),
        ),
    ];
    let mut rng = HashRng::new(11);
    for (k, (revolution, profile)) in cases.into_iter().enumerate() {
        let surface = turned(revolution, Transform::IDENTITY);
        let triangles = mesh(profile, phi, 160);
        let (mut both, mut one) = (0, 0);
        for _ in 0..400 {
            let o = warp::uniform_sphere(Vec2::new(rng.next_f32(), rng.next_f32())) * 4.0;
            let to = Vec3::new(rng.next_f32() - 0.5, rng.next_f32() - 0.5, rng.next_f32()) * 1.2;
            let ray = Ray::new(o, (to - o).normalize());
            let facet = triangles
                .iter()
                .filter_map(|t| triangle(*t, &ray).map(|h| (h.t, t)))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            match (hit(&surface, &ray), facet) {
                (Some(t), Some((f, corners))) if (t - f).abs() < 0.02 => {
                    let n = surface.surface(&ray, t).n;
                    let flat = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
                    let grazes = flat.dot(ray.direction).abs() < 0.2;
                    assert!(grazes || (t - f).abs() < 1e-3, "{k}: {t} {f}");
                    // Near the tip of the cone facets are wide.
                    assert!(n.dot(flat) > 0.97 || k == 0, "{k}: {n} {flat}");
                    both += 1;
                }
                (None, None) => {}
                // At rims one may miss.
                _ => one += 1,
            }
        }
        assert!(both > 100 && one * 50 < both, "{k}: {both} {one}");
    }
}

/// Hits obey the equation to within their error, however far away a ray begins, under any placement.
#[test]
fn far_rays_keep_their_roots() {
    let q = Quadric::new([1.0, -0.7, 0.4, 0.15, 0.1, -0.2, 0.05, 0.1, -0.1, -0.3]);
    let t = Transform::translate(DVec3::new(1.0, 2.0, 3.0)) * Transform::scale(DVec3::new(2.0, 0.5, 1.0));
    let surface =
        LevelSet::new(Function::Quadric(q), [DVec3::NEG_ONE, DVec3::ONE], t.affine().unwrap(), false).unwrap();
    let mut rng = HashRng::new(5);
    let mut hits = 0;
    for k in 0..3000 {
        let far = [5.0, 1e3, 1e6][k % 3];
        let o = warp::uniform_sphere(Vec2::new(rng.next_f32(), rng.next_f32())) * far;
        let to = warp::uniform_sphere(Vec2::new(rng.next_f32(), rng.next_f32())) * 0.8 + Vec3::new(1.0, 2.0, 3.0);
        let ray = Ray::new(o, to - o);
        let Some(at) = hit(&surface, &ray) else { continue };
        hits += 1;
        let point = surface.surface(&ray, at);
        let p = t.inverse().unwrap().point(point.p.as_dvec3());
        let error = point.error.as_dvec3() / DVec3::new(2.0, 0.5, 1.0);
        assert!(q.value(p).abs() <= q.gradient(p).abs().dot(error) * 1.01, "{far}: {} {error}", q.value(p));
        assert!(far > 10.0 || point.error.max_element() < 2e-6, "{}", point.error);
        // Its sign changes there, and nowhere before, on a walk in small steps.
        let along = |s: f64| q.value(t.inverse().unwrap().point(ray.origin.as_dvec3() + ray.direction.as_dvec3() * s));
        let (s, e) = (f64::from(at), 1e-6);
        if far < 10.0 && q.gradient(p).normalize().dot((to - o).as_dvec3().normalize()).abs() > 0.3 {
            assert!((along(s - e) < 0.0) != (along(s + e) < 0.0), "{at}");
        }
        // A ray that leaves does not meet it again at once.
        let leaving = point.n * if point.n.dot(ray.direction) < 0.0 { 1.0 } else { -1.0 };
        let from = steradian_math::ray::offset_ray_origin(point.p, point.error, point.n, leaving);
        if let Some(again) = hit(&surface, &Ray::new(from, leaving)) {
            assert!(again > 1e-3, "{again}");
        }
    }
    assert!(hits > 1000, "{hits}");
}

#[test]
fn grazing_rays_and_lines_in_the_surface() {
    let cone = turned(Revolution::line(DVec3::X, DVec3::Z, TAU).unwrap(), Transform::IDENTITY);
    // Along a line of the cone, and just inside and outside of it.
    assert_eq!(hit(&cone, &Ray::new(Vec3::new(2.0, 0.0, -1.0), Vec3::new(-1.0, 0.0, 1.0))), None);
    assert!(hit(&cone, &Ray::new(Vec3::new(2.0, 0.0, -1.0), Vec3::new(-1.0, 0.0, 0.999))).is_some());
    // Through the tip, where there is no gradient.
    let down = Ray::new(Vec3::Z * 3.0, -Vec3::Z);
    let t = hit(&cone, &down).unwrap();
    assert_eq!((t, cone.surface(&down, t).n), (2.0, Vec3::Z));
    // The other half of the double cone is cut away.
    assert_eq!(hit(&cone, &Ray::new(Vec3::new(-5.0, 0.0, 1.5), Vec3::X)), None);
    // Past a bowl, by a part in a million.
    let bowl = turned(Revolution::parabola(1.0, [0.0, 1.0], TAU).unwrap(), Transform::IDENTITY);
    for (y, meets) in [(0.999_999, true), (1.000_001, false)] {
        let ray = Ray::new(Vec3::new(-1e3, y, 1.0 - 1e-7), Vec3::X);
        assert_eq!(hit(&bowl, &ray).is_some(), meets, "{y}");
    }
    assert!((hit(&bowl, &Ray::new(Vec3::new(0.5, 0.0, 9.0), -Vec3::Z)).unwrap() - 8.75).abs() < 1e-6);
    assert!(
        Revolution::line(DVec3::X, DVec3::Y, TAU).is_none() && Revolution::parabola(1.0, [0.0, 0.0], TAU).is_none()
    );
    assert!(LevelSet::new(bowl.function.clone(), [DVec3::ONE, DVec3::ZERO], Affine::IDENTITY, false).is_none());
}

/// Parameters and their derivatives belong together.
#[test]
fn derivatives_are_those_of_the_parameters() {
    let line = Revolution::line(DVec3::new(1.0, -0.4, -0.5), DVec3::new(0.3, 0.9, 1.1), 5.0).unwrap();
    let bowl = Revolution::parabola(0.7, [0.1, 1.2], 5.0).unwrap();
    for r in [line, bowl] {
        let surface = turned(r, Transform::IDENTITY);
        let at = |o: Vec3| {
            let ray = Ray::new(o, Vec3::new(-1.0, -0.3, 0.1));
            surface.surface(&ray, hit(&surface, &ray).unwrap())
        };
        let (p, q) = (at(Vec3::new(3.0, 1.2, 0.3)), at(Vec3::new(3.0, 1.201, 0.302)));
        let change = p.dpdu * (q.uv.x - p.uv.x) + surface.dpdv(p.p) * (q.uv.y - p.uv.y);
        assert!((change - (q.p - p.p)).length() < 0.02 * (q.p - p.p).length(), "{change} {}", q.p - p.p);
    }
}
