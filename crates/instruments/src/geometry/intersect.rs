//! A ray against one surface, with every step in numbers.
//!
//! - Plane `x/a + y/b + z/c = 1`: one division. Triangle with corners at `a`, `b` and `c` on the axes: Möller and
//!   Trumbore's determinants, `t` and two barycentric weights by Cramer's rule.
//! - Box of half-sides `a`, `b`, `c`: the latest entry and the earliest exit of three slabs.
//! - Disc of radius `a`: the plane `z = 0` and a distance.
//! - Surfaces of second order: `A t² + 2 B t + C = 0`, whose roots are `q/A` and `C/q` with `q = −(B ± √(B² − A C))`,
//!   the sign being that of `B`, so that nothing cancels.
//! - Torus of radius `a` and tube `b`: a polynomial of degree four, whose roots lie between those of its derivative.

use super::{RANGE, drawing, tell3, vector3};
use crate::laboratory::{Chart, Error, Experiment, Marker, Parameter, Report, Run, Values};
use glam::DVec3;
use std::f64::consts::TAU;

pub const EXPERIMENT: Experiment = Experiment {
    name: "intersect",
    doc: "where a ray hits a plane, triangle, box, disc, sphere, cylinder, cone, quadric or torus, step by step",
    source: "Möller, Trumbore 1997; Kay, Kajiya 1986 (slabs); Pharr, Jakob, Humphreys, PBRT, §6; Hanrahan 1989 (torus)",
    parameters: &[
        Parameter::choice(
            "of",
            &[
                "sphere",
                "plane",
                "triangle",
                "box",
                "disc",
                "cylinder",
                "cone",
                "ellipsoid",
                "paraboloid",
                "hyperboloid",
                "torus",
            ],
            "the surface",
        ),
        Parameter::number("a", 1.0, (1e-3, 1e3), "", "radius; along x"),
        Parameter::number("b", 0.5, (1e-3, 1e3), "", "along y; radius of the tube of a torus"),
        Parameter::number("c", 0.8, (1e-3, 1e3), "", "along z; height of a cone, half of that of a cylinder"),
        Parameter::number("ox", 3.0, RANGE, "", "origin of the ray"),
        Parameter::number("oy", 2.0, RANGE, "", "origin of the ray"),
        Parameter::number("oz", 2.0, RANGE, "", "origin of the ray"),
        Parameter::number("dx", -1.0, RANGE, "", "direction of the ray"),
        Parameter::number("dy", -0.7, RANGE, "", "direction of the ray"),
        Parameter::number("dz", -0.6, RANGE, "", "direction of the ray"),
    ],
    run: Run::Alone(run),
};

/// A ray, `o + t d`.
#[derive(Clone, Copy)]
struct Ray {
    o: DVec3,
    d: DVec3,
}

/// Parameters at which a line meets the surface, in order, with normals; or the reason why it does not.
type Hits = Result<Vec<(f64, DVec3)>, &'static str>;

impl Ray {
    fn at(&self, t: f64) -> DVec3 {
        self.o + t * self.d
    }

    fn plane(&self, sizes: DVec3, report: &mut Report) -> Hits {
        let n = sizes.recip();
        let (rises, from) = (n.dot(self.d), 1.0 - n.dot(self.o));
        report.quantity("n · d", rises, "");
        report.quantity("1 − n · o", from, "");
        if rises == 0.0 { Err("is parallel to the plane") } else { Ok(vec![(from / rises, n.normalize())]) }
    }

    fn triangle(&self, sizes: DVec3, report: &mut Report) -> Hits {
        let [a, b, c] = [DVec3::X * sizes.x, DVec3::Y * sizes.y, DVec3::Z * sizes.z];
        let (e1, e2, s) = (b - a, c - a, self.o - a);
        let (p, q) = (self.d.cross(e2), s.cross(e1));
        let determinant = e1.dot(p);
        tell3(report, "p = d × e₂", p);
        report.quantity("determinant, e₁ · p", determinant, "");
        if determinant == 0.0 {
            return Err("is parallel to the triangle");
        }
        tell3(report, "q = s × e₁", q);
        let (u, v, t) = (s.dot(p) / determinant, self.d.dot(q) / determinant, e2.dot(q) / determinant);
        report.quantity("weight of the second corner, s · p / det", u, "");
        report.quantity("weight of the third corner, d · q / det", v, "");
        report.quantity("weight of the first corner, the rest", 1.0 - u - v, "");
        let is_inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
        if is_inside { Ok(vec![(t, e1.cross(e2).normalize())]) } else { Err("passes beside the triangle") }
    }

    fn slabs(&self, sizes: DVec3, report: &mut Report) -> Hits {
        let (mut entry, mut exit) = ((f64::NEG_INFINITY, DVec3::ZERO), (f64::INFINITY, DVec3::ZERO));
        for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
            let (o, d, half) = (self.o[k], self.d[k], sizes[k]);
            // A ray along the slab is always between its planes, or never.
            if d == 0.0 && o.abs() > half {
                return Err("runs beside a slab");
            }
            let (near, far) = match d == 0.0 {
                true => (f64::NEG_INFINITY, f64::INFINITY),
                false => ((-half * d.signum() - o) / d, (half * d.signum() - o) / d),
            };
            report.quantity(format!("slab of {axis}, entry"), near, "");
            report.quantity(format!("slab of {axis}, exit"), far, "");
            let out = DVec3::AXES[k] * d.signum();
            if near > entry.0 {
                entry = (near, -out);
            }
            if far < exit.0 {
                exit = (far, out);
            }
        }
        report.quantity("latest entry", entry.0, "");
        report.quantity("earliest exit", exit.0, "");
        if entry.0 <= exit.0 { Ok(vec![entry, exit]) } else { Err("leaves a slab before it has entered another") }
    }

    fn disc(&self, radius: f64, report: &mut Report) -> Hits {
        if self.d.z == 0.0 {
            return Err("is parallel to the disc");
        }
        let t = -self.o.z / self.d.z;
        let distance = self.at(t).truncate().length();
        report.quantity("t of the plane z = 0", t, "");
        report.quantity("distance from the middle there", distance, "");
        if distance <= radius { Ok(vec![(t, DVec3::Z)]) } else { Err("passes beside the disc") }
    }

    fn torus(&self, radius: f64, tube: f64, report: &mut Report) -> Hits {
        // From the point that is nearest to the middle, per unit of length: numbers stay small.
        let (length, nearest) = (self.d.length(), -self.o.dot(self.d) / self.d.length_squared());
        let (o, d) = (self.at(nearest), self.d / length);
        report.quantity("t nearest to the middle", nearest, "");
        report.quantity("distance from the middle there", o.length(), "");
        let reach = (radius + tube).powi(2) - o.length_squared();
        if reach <= 0.0 {
            return Err("passes the sphere around the torus");
        }
        let torus = torus_along(o, d, radius, tube);
        for (k, c) in torus.iter().enumerate().rev() {
            report.quantity(format!("coefficient of s^{k}"), *c, "");
        }
        let reach = reach.sqrt();
        let roots = roots(&torus, -reach, reach);
        let hits = roots.into_iter().map(|s| {
            let p = o + s * d;
            let circle = DVec3::new(p.x, p.y, 0.0).normalize_or_zero() * radius;
            (nearest + s / length, (p - circle).normalize_or_zero())
        });
        Ok(hits.collect())
    }
}

/// Coefficients, from that of `s⁰`, of `(|p|² + R² − r²)² − 4 R² (x² + y²)` along a line whose origin is nearest to the
/// middle and whose direction has unit length.
fn torus_along(o: DVec3, d: DVec3, radius: f64, tube: f64) -> [f64; 5] {
    let k = o.length_squared() + radius * radius - tube * tube;
    let four = 4.0 * radius * radius;
    let (oo, od, dd) = (o.truncate().length_squared(), o.truncate().dot(d.truncate()), d.truncate().length_squared());
    [k * k - four * oo, -2.0 * four * od, 2.0 * k - four * dd, 0.0, 1.0]
}

/// Real roots of a polynomial in an interval where it changes sign: between two roots of the derivative there is one at
/// most, which halving finds.
fn roots(coefficients: &[f64], low: f64, high: f64) -> Vec<f64> {
    let value = |x: f64| coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c);
    if coefficients.len() < 2 {
        return Vec::new();
    }
    let derivative: Vec<f64> = coefficients.iter().enumerate().skip(1).map(|(k, c)| k as f64 * c).collect();
    let mut cuts = vec![low];
    cuts.extend(roots(&derivative, low, high));
    cuts.push(high);
    let between = |w: &[f64]| {
        let (mut a, mut b) = (w[0], w[1]);
        let rises = value(b) > 0.0;
        ((value(a) > 0.0) != rises).then(|| {
            for _ in 0..100 {
                let middle = 0.5 * (a + b);
                if (value(middle) > 0.0) == rises { b = middle } else { a = middle }
            }
            0.5 * (a + b)
        })
    };
    cuts.windows(2).filter_map(between).collect()
}

/// The surface `x²/a² + y²/b² + square z²/c² + linear z/c + constant = 0` between two heights.
struct Quadric {
    sizes: DVec3,
    square: f64,
    linear: f64,
    constant: f64,
    z: [f64; 2],
}

impl Quadric {
    /// By name; spheres, cylinders and cones are round, of radius `a`.
    fn new(kind: &str, sizes: DVec3) -> Option<Self> {
        let (all, c) = ([f64::NEG_INFINITY, f64::INFINITY], sizes.z);
        let round = sizes.with_y(sizes.x);
        let (sizes, square, linear, constant, z) = match kind {
            "sphere" => (DVec3::splat(sizes.x), 1.0, 0.0, -1.0, all),
            "ellipsoid" => (sizes, 1.0, 0.0, -1.0, all),
            "cylinder" => (round, 0.0, 0.0, -1.0, [-c, c]),
            "cone" => (round, -1.0, 2.0, -1.0, [0.0, c]),
            "paraboloid" => (sizes, 0.0, -1.0, 0.0, all),
            "hyperboloid" => (sizes, -1.0, 0.0, -1.0, all),
            _ => return None,
        };
        Some(Self { sizes, square, linear, constant, z })
    }

    /// Weights of `x²`, `y²` and `z²`.
    fn weights(&self) -> DVec3 {
        (self.sizes * self.sizes).recip() * DVec3::new(1.0, 1.0, self.square)
    }

    fn value(&self, p: DVec3) -> f64 {
        self.weights().dot(p * p) + self.linear * p.z / self.sizes.z + self.constant
    }

    fn normal(&self, p: DVec3) -> DVec3 {
        (2.0 * self.weights() * p + DVec3::Z * (self.linear / self.sizes.z)).normalize_or_zero()
    }

    fn meet(&self, ray: &Ray, report: &mut Report) -> Hits {
        let a = self.weights().dot(ray.d * ray.d);
        let b = self.weights().dot(ray.o * ray.d) + 0.5 * self.linear * ray.d.z / self.sizes.z;
        let c = self.value(ray.o);
        let discriminant = b * b - a * c;
        for (name, value) in [("A", a), ("B", b), ("C", c), ("B² − A C", discriminant)] {
            report.quantity(name, value, "");
        }
        let mut roots = if a == 0.0 {
            if b == 0.0 {
                return Err("has no root: A and B are zero");
            }
            vec![-0.5 * c / b]
        } else if discriminant < 0.0 {
            return Err("misses: B² − A C is negative");
        } else {
            let q = -(b + discriminant.sqrt().copysign(b));
            report.quantity("q", q, "");
            vec![q / a, if q == 0.0 { 0.0 } else { c / q }]
        };
        roots.sort_by(f64::total_cmp);
        for (k, t) in roots.iter().enumerate() {
            report.quantity(format!("root {}", k + 1), *t, "");
            report.quantity(format!("z at root {}", k + 1), ray.at(*t).z, "");
        }
        roots.retain(|t| (self.z[0]..=self.z[1]).contains(&ray.at(*t).z));
        Ok(roots.into_iter().map(|t| (t, self.normal(ray.at(t)))).collect())
    }

    /// Factor of the ellipse of `a` and `b` at a height.
    fn factor(&self, z: f64) -> Option<f64> {
        let along = z / self.sizes.z;
        let squared = -(self.square * along * along + self.linear * along + self.constant);
        (squared >= -1e-12).then(|| squared.max(0.0).sqrt())
    }

    /// Ellipses at heights, and four meridians.
    fn outline(&self) -> Vec<Vec<DVec3>> {
        let c = self.sizes.z;
        let (low, high) =
            (self.z[0].max(-c), self.z[1].min(if self.square < 0.0 && self.linear == 0.0 { 1.5 * c } else { c }));
        let heights = |n: u32| (0..=n).map(move |k| low + (high - low) * f64::from(k) / f64::from(n));
        let point = |z: f64, turn: f64| {
            let (sin, cos) = (TAU * turn).sin_cos();
            self.factor(z).map(|f| DVec3::new(self.sizes.x * f * cos, self.sizes.y * f * sin, z))
        };
        let ellipse = |z: f64| (0..=64).filter_map(move |k| point(z, f64::from(k) / 64.0)).collect();
        let meridian = |k: u32| heights(64).filter_map(move |z| point(z, f64::from(k) / 4.0)).collect();
        heights(4).map(ellipse).chain((0..4).map(meridian)).filter(|c: &Vec<_>| c.len() > 1).collect()
    }
}

/// Curves of the surfaces that are no quadrics.
fn outline(of: &str, s: DVec3) -> Vec<Vec<DVec3>> {
    let circle = |middle: DVec3, u: DVec3, v: DVec3| -> Vec<DVec3> {
        (0..=64).map(|k| (TAU * f64::from(k) / 64.0).sin_cos()).map(|(sin, cos)| middle + cos * u + sin * v).collect()
    };
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    match of {
        "plane" | "triangle" => vec![vec![s.x * x, s.y * y, s.z * z, s.x * x]],
        "disc" => vec![circle(DVec3::ZERO, s.x * x, s.x * y)],
        "box" => {
            let corner = |k: u32| s * DVec3::from([1, 2, 4].map(|bit| if k & bit == 0 { -1.0 } else { 1.0 }));
            let edges = (0..8).flat_map(|k| [1, 2, 4].map(|bit| (k, k | bit))).filter(|(a, b)| a != b);
            edges.map(|(a, b)| vec![corner(a), corner(b)]).collect()
        }
        _ => {
            let rings = [s.x - s.y, s.x + s.y].map(|r| circle(DVec3::ZERO, r * x, r * y));
            let tubes = [x, y, -x, -y].map(|u| circle(s.x * u, s.y * u, s.y * z));
            rings.into_iter().chain(tubes).collect()
        }
    }
}

fn run(values: &Values) -> Result<Report, Error> {
    let of = values.choice("of");
    let sizes = vector3(values, ["a", "b", "c"]);
    let ray = Ray { o: vector3(values, ["ox", "oy", "oz"]), d: vector3(values, ["dx", "dy", "dz"]) };
    if ray.d == DVec3::ZERO {
        return Err(Error::Impossible("the direction of the ray ('dx', 'dy', 'dz') is zero".into()));
    }
    if of == "torus" && sizes.y >= sizes.x {
        return Err(Error::Impossible("the tube of the torus ('b') is not thinner than its radius ('a')".into()));
    }
    let mut report = Report::default();
    let quadric = Quadric::new(of, sizes);
    let hits = match (of, &quadric) {
        (_, Some(quadric)) => quadric.meet(&ray, &mut report),
        ("plane", _) => ray.plane(sizes, &mut report),
        ("triangle", _) => ray.triangle(sizes, &mut report),
        ("box", _) => ray.slabs(sizes, &mut report),
        ("disc", _) => ray.disc(sizes.x, &mut report),
        _ => ray.torus(sizes.x, sizes.y, &mut report),
    };
    let first = hits.as_ref().ok().and_then(|hits| hits.iter().find(|hit| hit.0 > 0.0)).copied();
    if let Ok(hits) = &hits {
        report.quantity("points of the line on the surface", hits.len() as f64, "");
    }
    match (&hits, first) {
        (Err(why), _) => report.fact("the ray", *why),
        (Ok(_), Some((t, normal))) => {
            report.fact("the ray", "hits");
            report.quantity("t of the hit", t, "");
            tell3(&mut report, "the hit", ray.at(t));
            tell3(&mut report, "normal there", normal);
        }
        (Ok(hits), None) if hits.is_empty() => report.fact("the ray", "misses what there is of the surface"),
        (Ok(_), None) => report.fact("the ray", "has the surface behind it: every t is negative"),
    }
    let curves = quadric.map_or_else(|| outline(of, sizes), |q| q.outline());
    report.chart = Some(chart(&ray, first, &curves));
    Ok(report)
}

fn chart(ray: &Ray, first: Option<(f64, DVec3)>, curves: &[Vec<DVec3>]) -> Chart {
    let size = curves.iter().flatten().map(|p| p.length()).fold(1e-3, f64::max);
    let mut chart = drawing::view("a ray and a surface", 1.2 * size);
    for curve in curves {
        chart = chart.with(drawing::curve("", curve.iter().copied()).colored([0x88, 0x88, 0x88]));
    }
    // A way that is as long as the surface is large, from where the ray comes near.
    let length = ray.d.length();
    let nearest = (-ray.o.dot(ray.d) / ray.d.length_squared()).max(0.0);
    let (begin, end) = ((nearest - 2.5 * size / length).max(0.0), nearest + 2.5 * size / length);
    let stop = first.map_or(end, |(t, _)| t);
    chart = chart.with(drawing::curve("the ray", [ray.at(begin.min(stop)), ray.at(stop)]).colored([0xd0, 0x5a, 0x1e]));
    let Some((t, normal)) = first else { return chart };
    let p = ray.at(t);
    chart
        .with(drawing::curve("", [p, ray.at(end.max(t))]).drawn(Marker::Dashed).colored([0xd0, 0x5a, 0x1e]))
        .with(drawing::curve("normal", [p, p + 0.4 * size * normal]).colored([0x1f, 0x5f, 0xa8]))
        .with(drawing::curve("the hit", [p]).drawn(Marker::Dots))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::run_with;
    use steradian_math::{
        Ray as SingleRay, Vec3,
        geometry::{
            Point3,
            surface::{Implicit, Torus},
        },
        hash::HashRng,
        intersect,
    };

    fn hit(r: &Report) -> DVec3 {
        DVec3::from(["x", "y", "z"].map(|a| r.value(&format!("the hit, {a}"))))
    }

    /// By hand, from (3, 0, ½) along −x: the unit sphere at x = √¾, the plane and the triangle at x = 1 − ½/0.8, the
    /// box at 1, the cylinder at 1, the cone at 1 − ½/0.8, the torus at 1 (½ above its circle, its tube's top); down
    /// from above, the disc.
    #[test]
    fn hits_by_hand() {
        let ray = [("oy", "0"), ("oz", "0.5"), ("dx", "-1"), ("dy", "0"), ("dz", "0")];
        for (of, x) in [
            ("sphere", 0.75f64.sqrt()),
            ("plane", 0.375),
            ("triangle", 0.375),
            ("box", 1.0),
            ("cylinder", 1.0),
            ("cone", 0.375),
            ("ellipsoid", (1f64 - 0.25 / 0.64).sqrt()),
            ("paraboloid", (0.5f64 / 0.8).sqrt()),
            ("hyperboloid", (1f64 + 0.25 / 0.64).sqrt()),
        ] {
            let r = run_with(&EXPERIMENT, &[&ray[..], &[("of", of)]].concat()).unwrap();
            assert_eq!(r.facts[0].text, "hits", "{of}");
            assert!((hit(&r) - DVec3::new(x, 0.0, 0.5)).length() < 1e-12, "{of}: {}", hit(&r));
            assert!((r.value("t of the hit") - (3.0 - x)).abs() < 1e-12);
        }
        let below = [("oy", "0"), ("oz", "0.3"), ("dx", "-1"), ("dy", "0"), ("dz", "0"), ("of", "torus")];
        let torus = run_with(&EXPERIMENT, &below).unwrap();
        assert_eq!(torus.value("points of the line on the surface"), 4.0);
        assert!((hit(&torus).x - 1.4).abs() < 1e-12 && (torus.value("normal there, x") - 0.8).abs() < 1e-12);
        let down = [("of", "disc"), ("ox", "0.3"), ("oy", "0.4"), ("dx", "0"), ("dy", "0"), ("dz", "-2")];
        let disc = run_with(&EXPERIMENT, &down).unwrap();
        assert_eq!((disc.value("t of the hit"), disc.value("distance from the middle there")), (1.0, 0.5));
    }

    /// Against the renderer's own intersections, and against the implicit forms at the hits: random rays.
    #[test]
    fn hits_are_those_of_the_renderer() {
        let mut rng = HashRng::new(5);
        let sizes = DVec3::new(1.0, 0.5, 0.8);
        let mut counts = [0; 4];
        for _ in 0..2000 {
            let mut random = || DVec3::from(std::array::from_fn(|_| f64::from(rng.next_f32() * 4.0 - 2.0)));
            let (o, to) = (random() * 2.0, random() * 0.6);
            let ray = Ray { o, d: to - o };
            let single = SingleRay::new(o.as_vec3(), ray.d.as_vec3());
            let mut report = Report::default();
            let first = |hits: Hits| hits.ok().and_then(|h| h.into_iter().find(|h| h.0 > 0.0)).map(|h| h.0);
            let sphere = first(Quadric::new("sphere", sizes).unwrap().meet(&ray, &mut report));
            let theirs = intersect::sphere(Vec3::ZERO, 1.0, &single).and_then(|r| intersect::nearest(r, f32::INFINITY));
            let corners = [Vec3::X, 0.5 * Vec3::Y, 0.8 * Vec3::Z];
            let triangle = first(ray.triangle(sizes, &mut report));
            let their_triangle = intersect::triangle(corners, &single).map(|h| h.t);
            let plane = first(ray.plane(sizes, &mut report));
            let normal = sizes.recip();
            let their_plane = intersect::plane(normal.as_vec3(), -1.0, &single);
            for (k, (a, b)) in
                [(sphere, theirs), (triangle, their_triangle), (plane, their_plane)].into_iter().enumerate()
            {
                assert_eq!(a.is_some(), b.is_some(), "{k}: {a:?} {b:?}");
                // Rays nearly along a plane hit it far away, where single precision ends.
                if let (Some(a), Some(b)) = (a.filter(|t| *t < 100.0), b) {
                    counts[k] += 1;
                    assert!((a - f64::from(b)).abs() < 1e-4 * (1.0 + a), "{k}: {a} {b}");
                }
            }
            let torus = Torus::new(1.0, 0.5).unwrap();
            let hits = ray.torus(1.0, 0.5, &mut report).unwrap_or_default();
            assert!(hits.len().is_multiple_of(2) && hits.windows(2).all(|w| w[0].0 < w[1].0));
            for (t, n) in hits {
                counts[3] += 1;
                let p = Point3::from_vector(ray.at(t));
                assert!(torus.value(p).abs() < 1e-9 && (torus.gradient(p).normalize() - n).length() < 1e-6);
            }
        }
        assert!(counts.iter().all(|c| *c > 50), "{counts:?}");
    }

    #[test]
    fn misses_are_told() {
        let fact = |given: &[(&str, &str)]| run_with(&EXPERIMENT, given).unwrap().facts[0].text.clone();
        assert!(fact(&[("oz", "9")]).contains("negative"));
        assert!(fact(&[("dx", "1"), ("dy", "0.7"), ("dz", "0.6")]).contains("behind"));
        assert!(fact(&[("of", "box"), ("dy", "0")]).contains("slab"));
        assert!(fact(&[("of", "disc"), ("dz", "0")]).contains("parallel"));
        assert!(fact(&[("of", "triangle"), ("oz", "5")]).contains("beside"));
        assert!(fact(&[("of", "cylinder"), ("oz", "9")]).contains("what there is"));
        assert!(run_with(&EXPERIMENT, &[("dx", "0"), ("dy", "0"), ("dz", "0")]).is_err());
        assert!(run_with(&EXPERIMENT, &[("of", "torus"), ("b", "2")]).is_err());
    }
}
