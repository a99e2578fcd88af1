//! Densities over the sphere of directions by a quadtree over the square of equal areas (Müller, Gross, Novák 2017,
//! "Practical Path Tracing for Efficient and Robust Global Illumination", sec. 3.2).
//!
//! The density is constant over each square that is not divided further, and proportional there to the light that paths
//! found by it, `∫ f L |cosθ| dω`. Rath et al. 2020 show that the root of its second moment is better where it is
//! known; of the few thousand finds of a region it is not, and it drew worse here (variances 18 against 14 of
//! `veach-ajar`).

use steradian_math::{
    Vec2, Vec3,
    hash::ONE_MINUS_EPSILON,
    warp::{equal_area_sphere_to_square, equal_area_square_to_sphere},
};

/// Deepest level: squares of 4π/4¹⁰ sr.
const DEEPEST: u32 = 10;
/// Share of all light above which a square is divided.
const DIVIDED: f32 = 0.01;
/// Fewest finds of a square that is divided.
const FEWEST: usize = 32;
/// Finds count for at most this many times their mean, so that a few bright ones draw no squares of their own.
const BRIGHTEST: f32 = 4.0;
/// Finds that the four parts of a square are given in equal shares beside their own.
const PRIOR: f32 = 4.0;

/// Find of a path by a direction: the place of the direction in the square, and the light `f L |cosθ| / p` that it
/// brought, with its density p.
#[derive(Clone, Copy, Debug)]
pub(super) struct Find {
    pub place: Vec2,
    pub light: f32,
}

impl Find {
    /// Place of a unit direction in the square, below one.
    pub fn place(w: Vec3) -> Vec2 {
        equal_area_sphere_to_square(w).min(Vec2::splat(ONE_MINUS_EPSILON))
    }
}

/// A density of directions.
#[derive(Clone, Debug)]
pub(super) struct Quadtree {
    /// Nodes, the root first.
    nodes: Vec<Node>,
}

/// Four squares of a square, in the order (0, 0), (1, 0), (0, 1), (1, 1).
#[derive(Clone, Copy, Debug)]
struct Node {
    /// Probabilities; their sum is one.
    shares: [f32; 4],
    /// Nodes of the squares that are divided; 0 for others.
    children: [u32; 4],
}

impl Quadtree {
    /// Density of what was found; `None` of nothing.
    pub fn new(finds: &mut [Find]) -> Option<Self> {
        let brightest = BRIGHTEST * light(finds) / finds.len() as f32;
        finds.iter_mut().for_each(|find| find.light = find.light.min(brightest));
        let total = light(finds);
        if !(total > 0.0 && total.is_finite()) {
            return None;
        }
        let mut tree = Self { nodes: Vec::new() };
        tree.divide(finds, (Vec2::ZERO, 1.0), (0, DIVIDED * total));
        Some(tree)
    }

    /// Divides a square with the corner of least coordinates and the edge given.
    fn divide(&mut self, finds: &mut [Find], (corner, edge): (Vec2, f32), (depth, threshold): (u32, f32)) {
        let number = self.nodes.len();
        self.nodes.push(Node { shares: [0.25; 4], children: [0; 4] });
        let half = 0.5 * edge;
        let middle = corner + Vec2::splat(half);
        // Shares of the light, and of the prior.
        let (own, all) = (finds.len() as f32 / (finds.len() as f32 + PRIOR), light(finds));
        let (low, high) = parted(finds, |find| find.place.y < middle.y);
        let quarters = [low, high].map(|row| parted(row, |find| find.place.x < middle.x));
        for (k, quarter) in quarters.into_iter().flat_map(|(left, right)| [left, right]).enumerate() {
            let found = light(quarter);
            let share = if all > 0.0 { found / all } else { 0.25 };
            self.nodes[number].shares[k] = own * share + (1.0 - own) * 0.25;
            if depth + 1 < DEEPEST && found > threshold && quarter.len() >= FEWEST {
                self.nodes[number].children[k] = self.nodes.len() as u32;
                let corner = corner + half * Vec2::new((k % 2) as f32, (k / 2) as f32);
                self.divide(quarter, (corner, half), (depth + 1, threshold));
            }
        }
    }

    /// A direction, by a number that chooses a square and two for the place in it.
    pub fn sample(&self, mut u: f32, u2: Vec2) -> Vec3 {
        let (mut corner, mut edge, mut node) = (Vec2::ZERO, 1.0, 0);
        loop {
            let Node { shares, children } = &self.nodes[node];
            // The square by its probability; the number is stretched for the next choice.
            let mut k = 0;
            while k < 3 && u >= shares[k] {
                u -= shares[k];
                k += 1;
            }
            u = (u / shares[k]).min(ONE_MINUS_EPSILON);
            edge *= 0.5;
            corner += edge * Vec2::new((k % 2) as f32, (k / 2) as f32);
            node = children[k] as usize;
            if node == 0 {
                return equal_area_square_to_sphere(corner + edge * u2);
            }
        }
    }

    /// Density of a direction, sr⁻¹.
    pub fn pdf(&self, w: Vec3) -> f32 {
        let mut place = Find::place(w);
        let (mut pdf, mut node) = (0.25 * std::f32::consts::FRAC_1_PI, 0);
        loop {
            let Node { shares, children } = &self.nodes[node];
            place *= 2.0;
            let (x, y) = (usize::from(place.x >= 1.0), usize::from(place.y >= 1.0));
            place -= Vec2::new(x as f32, y as f32);
            let k = 2 * y + x;
            pdf *= 4.0 * shares[k];
            node = children[k] as usize;
            if node == 0 {
                return pdf;
            }
        }
    }
}

/// Light of all finds.
fn light(finds: &[Find]) -> f32 {
    finds.iter().map(|find| find.light).sum()
}

/// Parts items by a predicate, those for which it holds first, each part in its order.
fn parted(finds: &mut [Find], holds: impl Fn(&Find) -> bool) -> (&mut [Find], &mut [Find]) {
    finds.sort_by_key(|find| !holds(find));
    let count = finds.partition_point(holds);
    finds.split_at_mut(count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::{
        hash::{combine32, unit_f32},
        warp,
    };

    /// Finds around a direction and, fewer, everywhere.
    fn tree() -> Quadtree {
        let number = |k, d| unit_f32(combine32(k, d));
        let find = |k| {
            let w = warp::uniform_sphere(Vec2::new(number(k, 0), number(k, 1)));
            let towards = Vec3::new(0.3, -0.5, 0.8).normalize();
            let w = if k % 4 == 0 { w } else { (towards + 0.1 * w).normalize() };
            Find { place: Find::place(w), light: 0.5 + number(k, 2) }
        };
        Quadtree::new(&mut (0..2000).map(find).collect::<Vec<_>>()).unwrap()
    }

    /// The density integrates to one, and samples fall into each of 16 × 16 squares as often as it says: χ² of 255
    /// degrees of freedom within 5σ.
    #[test]
    fn directions_have_their_density() {
        let (tree, edge, n) = (tree(), 16, 400_000_u32);
        let mut counts = vec![0.0_f64; edge * edge];
        for k in 0..n {
            let u = |d: u32| unit_f32(combine32(k, d + 10));
            let w = tree.sample(u(0), Vec2::new(u(1), u(2)));
            let place = Find::place(w) * edge as f32;
            counts[place.y as usize * edge + place.x as usize] += 1.0;
            assert!(tree.pdf(w) > 0.0 && (w.length() - 1.0).abs() < 1e-5);
        }
        let (fine, mut total, mut chi2) = (64, 0.0, 0.0);
        for (cell, count) in counts.iter().enumerate() {
            let corner = Vec2::new((cell % edge) as f32, (cell / edge) as f32);
            let density = |k: usize| {
                let at = (Vec2::new((k % fine) as f32, (k / fine) as f32) + 0.5) / fine as f32;
                f64::from(tree.pdf(equal_area_square_to_sphere((corner + at) / edge as f32)))
            };
            let mean = (0..fine * fine).map(density).sum::<f64>() / (fine * fine) as f64;
            let probability = mean * 4.0 * std::f64::consts::PI / (edge * edge) as f64;
            let expected = probability * f64::from(n);
            assert!(expected > 5.0, "{cell}: {expected}");
            total += probability;
            chi2 += (count - expected).powi(2) / expected;
        }
        assert!((total - 1.0).abs() < 1e-3, "{total}");
        assert!(chi2 < 255.0 + 5.0 * (2.0 * 255.0_f64).sqrt(), "{chi2}");
    }

    /// Most directions are drawn where most light was found.
    #[test]
    fn directions_lead_to_what_was_found() {
        let tree = tree();
        let towards = Vec3::new(0.3, -0.5, 0.8).normalize();
        assert!(tree.pdf(towards) > 20.0 * tree.pdf(-towards), "{} {}", tree.pdf(towards), tree.pdf(-towards));
    }

    /// Nothing found is no density, and one find is one.
    #[test]
    fn finds_may_be_few() {
        let find = |light| Find { place: Vec2::splat(0.99), light };
        assert!(Quadtree::new(&mut []).is_none());
        assert!(Quadtree::new(&mut [find(0.0)]).is_none());
        assert!(Quadtree::new(&mut [find(f32::MAX), find(f32::MAX)]).is_none());
        assert!(Quadtree::new(&mut [find(1.0)]).is_some());
    }
}
