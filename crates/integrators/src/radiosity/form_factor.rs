//! Form factors of polygons in closed form, without regard to what stands between them.
//!
//! The form factor `F₁₂ = 1/A₁ ∬ cosθ₁ cosθ₂ / (π r²) dA₂ dA₁` is the part of the light that leaves the first polygon
//! and arrives at the second. By Stokes' theorem, once for each polygon,
//!
//! > `A₁ F₁₂ = 1/2π ∮ ∮ ln r dx₁·dx₂`
//!
//! (Sparrow 1963; Schröder and Hanrahan 1993, eq. 2). For a pair of edges the inner integral is elementary; the outer
//! one is taken by quadrature: Gauss–Legendre for what lies apart, and tanh–sinh, which the logarithms of edges that
//! touch do not trouble, for what is near. Where polygons are far apart, as most pairs of a scene are, two points for
//! each of both edges do; their weights are equal, so that it takes one logarithm of a product. From a single point the
//! sum over edges is Lambert's (1760; Baum, Rushmeier, Winget 1989).

use super::polygon::Polygon;
use glam::DVec3;
use std::{
    f64::consts::{FRAC_PI_2, TAU},
    sync::LazyLock,
};
use steradian_math::quadrature::gauss_legendre;

/// Nodes and weights on [0, 1].
type Rule = Vec<(f64, f64)>;

static FAR: LazyLock<Rule> = LazyLock::new(|| on_unit_interval(3));
static MIDDLE: LazyLock<Rule> = LazyLock::new(|| on_unit_interval(6));
static NEAR: LazyLock<Rule> = LazyLock::new(|| tanh_sinh(0.18, 17));

fn on_unit_interval(n: usize) -> Rule {
    gauss_legendre(n).into_iter().map(|(x, w)| (0.5 + 0.5 * x, 0.5 * w)).collect()
}

/// `x = ½ + ½ tanh(π/2 sinh t)` at `2n + 1` evenly spaced `t` (Takahasi, Mori 1974).
fn tanh_sinh(step: f64, n: i32) -> Rule {
    (-n..=n)
        .map(|k| {
            let t = f64::from(k) * step;
            let s = FRAC_PI_2 * t.sinh();
            (0.5 + 0.5 * s.tanh(), 0.5 * step * FRAC_PI_2 * t.cosh() / (s.cosh() * s.cosh()))
        })
        .collect()
}

/// `A₁ F₁₂ = A₂ F₂₁` of two convex polygons of which each may lie partly behind the other; m².
pub fn exchange(a: &Polygon, b: &Polygon) -> f64 {
    let (na, nb) = (a.normal(), b.normal());
    let (ca, cb) = (a.center(), b.center());
    let distance = ca.distance(cb);
    let size = a.reach(ca) + b.reach(cb);
    // What lies in the other's plane sees nothing of it, whatever rounding says.
    let rises = |of: &Polygon, over: DVec3, n: DVec3| {
        of.corners().iter().map(|c| n.dot(*c - over)).fold(f64::NEG_INFINITY, f64::max) > 1e-9 * (size + distance)
    };
    if !rises(b, ca, na) || !rises(a, cb, nb) {
        return 0.0;
    }
    // Parts behind the other's plane are cut away.
    let (Some(b), Some(a)) = (b.before(ca, na), a.before(cb, nb)) else { return 0.0 };
    // Far pairs: two Gauss points for each edge, and one logarithm for four distances.
    if distance > FAR_AWAY * size {
        let unit = 1.0 / (distance * distance);
        let sum: f64 = edges(&a).map(|p| edges(&b).map(|q| far_edge_pair(p, q, unit)).sum::<f64>()).sum();
        return (sum / TAU).max(0.0);
    }
    // Quadrature by distance: 3 or 6 Gauss points, or tanh–sinh where edges may touch.
    let rule: &[_] = if distance > 4.0 * size {
        &FAR
    } else if distance > 1.5 * size {
        &MIDDLE
    } else {
        &NEAR
    };
    // Quadrature along the edges of the smaller one, over which logarithms of distances to the larger one vary least.
    let (a, b) = if a.reach(ca) > b.reach(cb) { (b, a) } else { (a, b) };
    // Logarithms of lengths near one, so that nothing large cancels.
    let unit = 1.0 / distance.max(size);
    let sum: f64 = edges(&a).map(|p| edges(&b).map(|q| edge_pair(p, q, unit, rule)).sum::<f64>()).sum();
    (sum / TAU).max(0.0)
}

/// Exchange of two polygons of any number of corners that lie wholly before each other.
#[cfg(test)]
fn exchange_of_many(a: &[DVec3], b: &[DVec3]) -> f64 {
    let around = |c: &[DVec3]| (0..c.len()).map(|k| (c[k], c[(k + 1) % c.len()])).collect::<Vec<_>>();
    let (a, b) = (around(a), around(b));
    a.iter().map(|p| b.iter().map(|q| edge_pair(*p, *q, 1.0, &FAR)).sum::<f64>()).sum::<f64>() / TAU
}

fn edges(polygon: &Polygon) -> impl Iterator<Item = (DVec3, DVec3)> {
    let c = polygon.corners();
    (0..c.len()).map(move |k| (c[k], c[(k + 1) % c.len()]))
}

/// Distance, in reaches of the polygons, from which the logarithm is smooth enough for two points.
const FAR_AWAY: f64 = 8.0;

/// Integral over two distant edges as by [`edge_pair`], from two points of each edge; `unit` is for squares of lengths
/// here.
fn far_edge_pair(p: (DVec3, DVec3), q: (DVec3, DVec3), unit: f64) -> f64 {
    // Of Gauss and Legendre on [0, 1]: ½ ± 1/√12.
    const AT: [f64; 2] = [0.211_324_865_405_187_13, 0.788_675_134_594_812_9];
    let (along, other) = (p.1 - p.0, q.1 - q.0);
    // Edges at right angles add nothing.
    let cosine = along.dot(other);
    if cosine == 0.0 {
        return 0.0;
    }
    // Σ ln r² = ln ∏ r².
    let mut product = 1.0;
    for s in AT {
        let x = p.0 + along * s - q.0;
        for t in AT {
            product *= (x - other * t).length_squared() * unit;
        }
    }
    // Four logarithms of squares, each with a weight of a quarter.
    cosine * product.ln() / 8.0
}

/// `(p̂·q̂) ∫ ∫ ln(r·unit) dt ds` along two edges.
fn edge_pair(p: (DVec3, DVec3), q: (DVec3, DVec3), unit: f64, rule: &[(f64, f64)]) -> f64 {
    let (along, other) = (p.1 - p.0, q.1 - q.0);
    let length = other.length();
    let cosine = along.dot(other);
    if cosine.abs() <= 1e-14 * along.length() * length {
        return 0.0;
    }
    let direction = other / length;
    // Outer integral over a part of the edge by quadrature, inner integral in closed form.
    let whole = |from: f64, to: f64| {
        let inner = |s: f64| log_distance(p.0 + along * (from + (to - from) * s), q.0, direction, length, unit);
        (to - from) * rule.iter().map(|(s, w)| w * inner(*s)).sum::<f64>()
    };
    // Where the other edge comes near or ends beside this one, logarithms are not smooth.
    let within = |s: f64| s > 1e-9 && s < 1.0 - 1e-9;
    let square = along.length_squared();
    let beside = |c: DVec3| {
        let s = along.dot(c - p.0) / square;
        (within(s) && (p.0 + along * s).distance_squared(c) < 1e-2 * length * length).then_some(s)
    };
    // The parameter at which the lines of both edges come closest.
    let (tilt, to) = (along.dot(direction), p.0 - q.0);
    let across = square - tilt * tilt;
    let crossing = (tilt * direction.dot(to) - along.dot(to)) / across;
    let crosses = across > 1e-6 * square && within(crossing) && {
        let x = p.0 + along * crossing;
        let foot = q.0 + direction * direction.dot(x - q.0).clamp(0.0, length);
        x.distance_squared(foot) < 1e-2 * length * length
    };
    // The edge is cut there, and beside the ends of the other edge.
    let mut cuts = [Some(0.0), beside(q.0), beside(q.1), crosses.then_some(crossing), Some(1.0)];
    cuts.sort_by(|a, b| a.unwrap_or(0.0).total_cmp(&b.unwrap_or(0.0)));
    let mut from = 0.0;
    let mut sum = 0.0;
    for to in cuts.into_iter().flatten() {
        if to > from {
            sum += whole(from, to);
            from = to;
        }
    }
    cosine / length * sum
}

/// `∫ ln(r·unit)` from a point along an edge.
#[inline]
fn log_distance(x: DVec3, q: DVec3, direction: DVec3, length: f64, unit: f64) -> f64 {
    // ∫ ln √(h² + t²) dt = t ln r − t + h atan(t/h), with h the distance of the point from the line of the edge.
    let to = q - x;
    let a = to.dot(direction);
    let b = a + length;
    let h2 = (to - direction * a).length_squared();
    let h = h2.sqrt();
    let term = |t: f64| {
        let r2 = (h2 + t * t) * (unit * unit);
        if r2 > 0.0 { 0.5 * t * r2.ln() } else { 0.0 }
    };
    term(b) - term(a) - length + h * (h * length).atan2(h2 + a * b)
}

/// The form factor from a point with a unit normal to a polygon: `−1/2π Σ Γₖ·n` over the edges, whose `Γₖ` are the
/// angle that an edge subtends times the unit normal of the plane through it and the point.
pub fn from_point(p: DVec3, n: DVec3, polygon: &Polygon) -> f64 {
    // Nothing is received from behind the polygon.
    let c = polygon.center();
    if polygon.normal().dot(p - c) <= 0.0 {
        return 0.0;
    }
    let Some(part) = polygon.before(p, n) else { return 0.0 };
    let sum: f64 = edges(&part)
        .map(|(a, b)| {
            let (a, b) = (a - p, b - p);
            // Γ: the angle between the directions to both ends, times the unit normal of their plane.
            let across = a.cross(b);
            let sin = across.length();
            if sin > 0.0 { -sin.atan2(a.dot(b)) * across.dot(n) / sin } else { 0.0 }
        })
        .sum();
    (sum / TAU).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(corner: DVec3, x: DVec3, y: DVec3) -> Polygon {
        Polygon::new(&[corner, corner + x, corner + x + y, corner + y])
    }

    /// M176: squares of side one at distance one, and at right angles along an edge (closed forms of Hamilton and
    /// Morgan 1952).
    #[test]
    fn squares_have_the_published_form_factors() {
        let floor = square(DVec3::ZERO, DVec3::X, DVec3::Y);
        let above = square(DVec3::Z, DVec3::Y, DVec3::X);
        assert!((exchange(&floor, &above) - 0.199_824_90).abs() < 1e-8, "{:.10}", exchange(&floor, &above));
        let wall = square(DVec3::ZERO, DVec3::Y, DVec3::Z);
        assert!((exchange(&floor, &wall) - 0.200_043_78).abs() < 1e-8, "{:.10}", exchange(&floor, &wall));
        // Turned away from each other, and in one plane.
        assert_eq!(exchange(&floor, &above.reversed()), 0.0);
        assert_eq!(exchange(&floor, &square(DVec3::X, DVec3::X, DVec3::Y)), 0.0);
    }

    /// M176: coaxial discs of radius one at distance one, `F = ½ (S − √(S² − 4))` with `S = 3`, as the limit of regular
    /// polygons, whose error is quadratic in the angle of an edge.
    #[test]
    fn discs_are_limits_of_polygons() {
        let of = |n: usize| {
            let ring = |z: f64, y: DVec3| Polygon::corners_of_regular(n, DVec3::Z * z, DVec3::X, y);
            let (low, high) = (ring(0.0, DVec3::Y), ring(1.0, -DVec3::Y));
            let area = 0.5 * n as f64 * (TAU / n as f64).sin();
            exchange_of_many(&low, &high) / area
        };
        let (coarse, fine) = (of(96), of(192));
        let limit = fine + (fine - coarse) / 3.0;
        assert!((limit - 0.5 * (3.0 - 5.0_f64.sqrt())).abs() < 1e-6, "{limit:.10}");
        assert!((limit - 0.381_966_01).abs() < 1e-6);
    }

    /// M176: what leaves a side of a cube arrives at the five others, also where these are cut into pieces of many
    /// sizes.
    #[test]
    fn rows_of_a_cube_add_up_to_one() {
        let sides = [
            (DVec3::ZERO, DVec3::X, DVec3::Y),
            (DVec3::Z, DVec3::Y, DVec3::X),
            (DVec3::ZERO, DVec3::Y, DVec3::Z),
            (DVec3::X, DVec3::Z, DVec3::Y),
            (DVec3::ZERO, DVec3::Z, DVec3::X),
            (DVec3::Y, DVec3::X, DVec3::Z),
        ];
        for pieces in [1, 2, 3] {
            let mut patches = Vec::new();
            for (corner, x, y) in sides {
                let (x, y) = (x / f64::from(pieces), y / f64::from(pieces));
                for i in 0..pieces {
                    for j in 0..pieces {
                        patches.push(square(corner + x * f64::from(i) + y * f64::from(j), x, y));
                    }
                }
            }
            for a in &patches {
                let sum: f64 = patches.iter().map(|b| exchange(a, b)).sum::<f64>() / a.area();
                assert!((sum - 1.0).abs() < 1e-6, "{pieces}: {sum:.10}");
            }
        }
    }

    /// A small square in the corner of a large one that stands on it: the closed form of Lambert's formula tells to how
    /// much.
    #[test]
    fn sizes_may_differ_by_any_factor() {
        let wall = square(DVec3::ZERO, DVec3::Y, DVec3::Z);
        for size in [0.1, 1e-2, 1e-3, 1e-4] {
            for corner in [DVec3::new(0.0, 0.5, 0.0), DVec3::new(size, 0.3, 0.0), DVec3::new(0.0, 0.0, 0.0)] {
                let small = square(corner, DVec3::X * size, DVec3::Y * size);
                let (f, back) = (exchange(&small, &wall) / small.area(), exchange(&wall, &small) / small.area());
                let n = 40;
                let at = |k: i32| (f64::from(k) + 0.5) / f64::from(n) * size;
                let points = (0..n * n).map(|k| corner + DVec3::X * at(k % n) + DVec3::Y * at(k / n));
                let mean = points.map(|p| from_point(p, DVec3::Z, &wall)).sum::<f64>() / f64::from(n * n);
                assert!((f - mean).abs() < 2e-3, "{size} {corner}: {f} {mean}");
                assert!((f - back).abs() < 1e-6 && f <= 0.5, "{size} {corner}: {f} {back}");
            }
        }
    }

    /// On both sides of the distance from which fewer points do, and far beyond it, quads that are turned against each
    /// other exchange what the kernel gives in the mean over many points of both, to 10⁻⁵ of it.
    #[test]
    fn far_polygons_exchange_what_the_kernel_gives() {
        let kernel = |a: &Polygon, b: &Polygon| {
            let n = 12;
            let points = |p: &Polygon| -> Vec<DVec3> {
                let c = p.corners();
                let at = |k: i32| (f64::from(k) + 0.5) / f64::from(n);
                (0..n * n).map(|k| c[0] + (c[1] - c[0]) * at(k % n) + (c[3] - c[0]) * at(k / n)).collect()
            };
            let (na, nb, pa, pb) = (a.normal(), b.normal(), points(a), points(b));
            let pair = |p: &DVec3, q: &DVec3| {
                let to = *q - *p;
                na.dot(to).max(0.0) * (-nb.dot(to)).max(0.0) / (to.length_squared().powi(2) * std::f64::consts::PI)
            };
            let sum: f64 = pa.iter().map(|p| pb.iter().map(|q| pair(p, q)).sum::<f64>()).sum();
            sum * a.area() * b.area() / f64::from(n.pow(4))
        };
        for distance in [9.0, 10.5, 12.0, 30.0, 300.0] {
            for turn in [0.0_f64, 0.4, 0.9, 1.2] {
                let a = square(DVec3::new(-0.5, -0.5, 0.0), DVec3::X, DVec3::Y);
                let (x, y) = (DVec3::new(turn.cos(), 0.3, turn.sin()), DVec3::new(-0.3, 0.8, 0.1));
                let b = square(DVec3::new(0.3 * distance, 0.1, distance), y, x * 0.7);
                let (found, expected) = (exchange(&a, &b), kernel(&a, &b));
                assert!((found / expected - 1.0).abs() < 1e-4, "{distance} {turn}: {found:e} {expected:e}");
            }
        }
    }

    /// The closed form against the mean of Lambert's over the first polygon, for triangles anywhere, partly behind each
    /// other.
    #[test]
    fn the_contour_integral_is_the_mean_of_lamberts_formula() {
        let mut rng = steradian_math::hash::HashRng::new(5);
        let mut point = || DVec3::new(rng.next_f32().into(), rng.next_f32().into(), rng.next_f32().into());
        let mut seen = 0;
        for _ in 0..40 {
            let corners = [point(), point(), point()];
            let offset = DVec3::new(0.0, 0.0, 0.7);
            let turned = |p: Polygon, to: DVec3| if p.normal().dot(to - p.center()) < 0.0 { p.reversed() } else { p };
            let a = Polygon::new(&corners);
            let b = Polygon::new(&[point() + offset, point() + offset, point() + offset]);
            // Towards each other, as far as they are.
            let (a, b) = (turned(a, b.center()), turned(b, a.center()));
            let n = 60;
            let mut mean = 0.0;
            for i in 0..n {
                for j in 0..n - i {
                    for (k, third) in [(1.0, true), (2.0, i + j < n - 1)] {
                        if third {
                            let (u, v) =
                                ((f64::from(i) + k / 3.0) / f64::from(n), (f64::from(j) + k / 3.0) / f64::from(n));
                            let p = corners[0] + (corners[1] - corners[0]) * u + (corners[2] - corners[0]) * v;
                            mean += from_point(p, a.normal(), &b) / f64::from(n * n);
                        }
                    }
                }
            }
            let exact = exchange(&a, &b) / a.area();
            seen += u32::from(exact > 0.01);
            assert!((mean - exact).abs() < 2e-3 * (1.0 + exact), "{mean} {exact}");
            // Reciprocity, to what the quadrature promises.
            assert!((exchange(&b, &a) - exchange(&a, &b)).abs() < 1e-6);
        }
        assert!(seen > 5);
    }
}
