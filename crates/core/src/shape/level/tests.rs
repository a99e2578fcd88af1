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

fn implicit(text: &str, size: f64) -> LevelSet {
    let e = Expression::new(text, &["x", "y", "z"]).unwrap_or_else(|e| panic!("{text}: {e}"));
    LevelSet::new(Function::Expression(e), [DVec3::splat(-size), DVec3::splat(size)], Affine::IDENTITY, false).unwrap()
}

/// Rays through a cube around the origin.
fn rays(count: usize, far: f32, seed: u64) -> impl Iterator<Item = Ray> {
    let mut rng = HashRng::new(seed);
    (0..count).map(move |_| {
        let o = warp::uniform_sphere(Vec2::new(rng.next_f32(), rng.next_f32())) * far;
        let to = Vec3::new(rng.next_f32() - 0.5, rng.next_f32() - 0.5, rng.next_f32() - 0.5) * 2.0;
        Ray::new(o, (to - o).normalize())
    })
}

/// The first change of sign along a ray in the cube, by many samples and halving, in `f64`.
fn sampled(f: impl Fn(DVec3) -> f64, ray: &Ray, size: f64) -> Option<f64> {
    let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let at = |t: f64| Some(o + d * t).filter(|p| p.abs().max_element() <= size).map(&f);
    let (mut t, step) = (0.0, 1e-3);
    while t < 12.0 {
        if let (Some(a), Some(b)) = (at(t), at(t + step))
            && (a < 0.0) != (b < 0.0)
        {
            let (mut low, mut high) = (t, t + step);
            for _ in 0..60 {
                let m = 0.5 * (low + high);
                if (f(o + d * m) < 0.0) == (a < 0.0) { low = m } else { high = m }
            }
            return Some(low);
        }
        t += step;
    }
    None
}

/// M61: torus, quartics and others against their roots by dense samples; normals by differences.
#[test]
fn expressions_are_met_where_they_change_sign() {
    type Form = fn(DVec3) -> f64;
    let cases: [(&str, Form); 6] = [
        ("(sqrt(x^2 + y^2) - 1)^2 + z^2 - 0.09", |p| (p.x.hypot(p.y) - 1.0).powi(2) + p.z * p.z - 0.09),
        // The torus without a root: a quartic.
        ("(x^2+y^2+z^2 + 0.91)^2 - 4*(x^2+y^2)", |p| {
            (p.length_squared() + 0.91).powi(2) - 4.0 * p.truncate().length_squared()
        }),
        ("x^4 + y^4 + z^4 - 1.5*(x^2 + y^2 + z^2) + 0.9", |p| {
            let q = p * p;
            (q * q).element_sum() - 1.5 * q.element_sum() + 0.9
        }),
        ("sin(4*x)*cos(4*y) + sin(4*y)*cos(4*z) + sin(4*z)*cos(4*x)", |p| {
            let q = p * 4.0;
            q.x.sin() * q.y.cos() + q.y.sin() * q.z.cos() + q.z.sin() * q.x.cos()
        }),
        ("max(abs(x), max(abs(y), abs(z))) - 0.7", |p| p.abs().max_element() - 0.7),
        ("exp(-x^2 - z^2) - log(2 + y)/pi - min(0.3, abs(x)^1.5)", |p| {
            (-p.x * p.x - p.z * p.z).exp() - (2.0 + p.y).ln() / std::f64::consts::PI - p.x.abs().powf(1.5).min(0.3)
        }),
    ];
    for (k, (text, f)) in cases.into_iter().enumerate() {
        let surface = implicit(text, 1.4);
        let (mut hits, mut off) = (0, 0);
        for ray in rays(500, 4.0, 20 + k as u64) {
            let (found, expected) = (hit(&surface, &ray), sampled(f, &ray, 1.4));
            match (found, expected) {
                (Some(t), Some(e)) if (f64::from(t) - e).abs() < 1e-6 => {
                    hits += 1;
                    let point = surface.surface(&ray, t);
                    let p = point.p.as_dvec3();
                    let h = 1e-5;
                    let difference = DVec3::from_array(std::array::from_fn(|a| {
                        f(p + DVec3::AXES[a] * h) - f(p - DVec3::AXES[a] * h)
                    }));
                    let difference = difference.normalize_or_zero().as_vec3();
                    assert!((point.n - difference).length() < 1e-3 || k > 3, "{text}: {} {difference}", point.n);
                    assert!((point.p - ray.at(t)).abs().max_element() < 2e-6);
                }
                (None, None) => {}
                _ => off += 1,
            }
        }
        // Two roots within a step of the samples, and those within it of the box.
        assert!(hits > 100 && off * 50 <= hits, "{text}: {hits} {off}");
    }
}

#[test]
fn a_sphere_by_its_expression_is_the_sphere() {
    use crate::shape::{Quadric as Part, QuadricKind};
    let sphere = Part {
        kind: QuadricKind::Sphere { radius: 1.0, z_min: -1.0, z_max: 1.0 },
        phi_max: std::f32::consts::TAU,
        place: Affine::IDENTITY,
        flip: false,
    };
    for (far, within) in [(3.0, 1e-6), (1e4, 5e-3)] {
        let surface = implicit("x^2 + y^2 + z^2 - 1", 1.0);
        let mut hits = 0;
        for ray in rays(1000, far, 3) {
            let (a, b) = (hit(&surface, &ray), sphere.intersect(&ray).map(|h| h.t));
            if let (Some(a), Some(b)) = (a, b) {
                let (p, q) = (surface.surface(&ray, a), sphere.surface(&ray, b));
                let grazes = q.n.dot(ray.direction).abs() < 0.2;
                assert!(grazes || ((a - b).abs() <= within && (p.n - q.n).length() < 1e-5 + 5.0 * within), "{a} {b}");
                hits += 1;
            } else {
                assert!(a.is_none() && b.is_none(), "{a:?} {b:?}");
            }
        }
        assert!(hits > 500);
    }
}

/// Root finding ends for expressions that are discontinuous, undefined, or change their sign very often.
#[test]
fn hard_expressions_end() {
    // A pole is no surface, nor is where a root ends; a surface in the face of the box is one.
    let down = Ray::new(Vec3::new(0.3, 0.2, 5.0), -Vec3::Z);
    assert_eq!(hit(&implicit("1/z", 1.0), &down), None);
    assert_eq!(hit(&implicit("1 + 0*sqrt(z)", 1.0), &down), None);
    assert!((hit(&implicit("z - 1", 1.0), &down).unwrap() - 4.0).abs() < 1e-6);
    assert!((hit(&implicit("sqrt(z)-0.5", 1.0), &down).unwrap() - 4.75).abs() < 1e-6);
    // Touched without a change of sign.
    assert_eq!(hit(&implicit("(z-0.1)^2", 1.0), &down), None);
    for text in [
        "sin(100*x*y)",
        "sin(1/(x*y*z))",
        "sin(1e6*x*y) + 1.0001",
        "(x-y)^2 + (z*sin(1e5*x))^2",
        "0*x",
        "x/0",
        "log(-1-x^2)",
    ] {
        let surface = implicit(text, 1.0);
        let hits = rays(40, 3.0, 9).filter(|r| hit(&surface, r).is_some()).count();
        assert!(hits > 10 || !text.starts_with("sin(1") || text.ends_with("1"), "{text}: {hits}");
    }
    // As long and as deep as may be.
    let (long, deep) = (format!("{}z", "0*sin(x)+".repeat(200)), format!("{}z{}", "-(".repeat(31), ")".repeat(31)));
    assert!((hit(&implicit(&long, 1.0), &down).unwrap() - 5.0).abs() < 1e-6);
    assert!((hit(&implicit(&deep, 1.0), &down).unwrap() - 5.0).abs() < 1e-6);
}

/// Cells leave out nothing: rays meet what they meet without them, from outside and within, along axes and in faces of
/// cells; and of a surface that fills little of its box most are empty.
#[test]
fn cells_leave_nothing_out() {
    let texts = [
        "cos(4*x)*sin(4*y)+cos(4*y)*sin(4*z)+cos(4*z)*sin(4*x)",
        "(sqrt(x^2 + y^2) - 0.9)^2 + z^2 - 0.05^2",
        "max(abs(x), abs(y), abs(z)) - 0.5",
        "1/x + y*z",
        "z",
        "sqrt(x - 0.3) + y",
        "x^4 - 0.0001 + y^2*exp(z)",
    ];
    for (k, text) in texts.into_iter().enumerate() {
        let with = implicit(text, 1.25);
        let without = LevelSet { cells: None, ..with.clone() };
        let axis = |k: usize, v: f32| Ray::new(Vec3::new(v, 0.0, -3.0), [Vec3::Z, -Vec3::Z][k]);
        let along = (0..64).map(|i| axis(i % 2, (i as f32 - 32.0) * 1.25 / 16.0));
        let mut met = 0;
        for ray in rays(1500, 3.0, 40 + k as u64).chain(rays(500, 0.8, 60 + k as u64)).chain(along) {
            let (a, b) = (hit(&with, &ray), hit(&without, &ray));
            let same = a.zip(b).is_some_and(|(a, b)| (a - b).abs() <= 2.0 * f32::EPSILON * b.max(1.0));
            assert!(same || (a, b) == (None, None), "{text}: {a:?}, without cells {b:?}, {ray:?}");
            met += usize::from(a.is_some());
        }
        assert!(met > 20, "{text}: {met}");
    }
}
