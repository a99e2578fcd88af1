//! The light tree: chooses one of many lights in proportion to a bound on what it can contribute at a point (Conty
//! Estevez & Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting"; importance as in PBR 4th
//! ed., 12.6.3).

use super::LightContext;
use steradian_math::{Bounds3, Vec3};

/// Bounds on the position, directions and intensity of a light, or of all lights below a node.
#[derive(Clone, Copy, Debug)]
pub struct LightBounds {
    /// Bounding box.
    pub bounds: Bounds3,
    /// Unit axis of the cone of its normals.
    pub axis: Vec3,
    /// Cosine of the half angle of that cone; −1 for all directions.
    pub cos_o: f32,
    /// Cosine of the angle around a normal into which it emits.
    pub cos_e: f32,
    /// Luminous intensity along a normal: for surfaces luminance times area.
    pub intensity: f32,
    /// True if light is emitted to both sides of the normals.
    pub two_sided: bool,
}

impl LightBounds {
    /// A point that emits everywhere.
    pub fn point(p: Vec3, intensity: f32) -> Self {
        Self { bounds: Bounds3::new(p, p), axis: Vec3::Z, cos_o: -1.0, cos_e: 0.0, intensity, two_sided: false }
    }

    pub(super) fn union(&self, o: &Self) -> Self {
        let (axis, cos_o) = union_cones((self.axis, self.cos_o), (o.axis, o.cos_o));
        Self {
            bounds: self.bounds.union(o.bounds),
            axis,
            cos_o,
            cos_e: self.cos_e.min(o.cos_e),
            intensity: self.intensity + o.intensity,
            two_sided: self.two_sided | o.two_sided,
        }
    }
}

/// The part of [`LightBounds`] that the choice among lights needs.
#[derive(Clone, Copy, Debug)]
pub struct Cluster {
    /// The middle of the box.
    pub center: Vec3,
    /// The square of half its diagonal.
    pub half2: f32,
    /// Unit axis of the cone of normals.
    pub axis: Vec3,
    /// Cosine of the half angle of that cone; −1 for all directions.
    pub cos_o: f32,
    /// Cosine of the angle around a normal into which light is emitted.
    pub cos_e: f32,
    /// Luminous intensity along a normal: for surfaces luminance times area.
    pub intensity: f32,
    /// True if light is emitted to both sides of the normals.
    pub two_sided: bool,
}

impl Cluster {
    fn new(light: &LightBounds) -> Self {
        let center = light.bounds.center();
        // Half the squared diagonal stands for the extent of the cluster.
        let LightBounds { bounds, axis, cos_o, cos_e, intensity, two_sided } = *light;
        Self { center, half2: (bounds.max - center).length_squared(), axis, cos_o, cos_e, intensity, two_sided }
    }

    /// An estimate of the irradiance that a surface (or, without a normal, a volume) at the point receives, ignoring
    /// visibility; never zero where there is any.
    #[inline(always)]
    pub fn importance(&self, ctx: &LightContext) -> f32 {
        // Conty Estevez and Kulla: intensity over squared distance, times the cosines left after all angles are
        // bounded.
        let half2 = self.half2;
        let to = ctx.p - self.center;
        let d2 = to.length_squared();
        // The nearest that the light can be in the mean: half the diagonal keeps it finite within the box.
        let falloff = d2.max(half2).max(1e-30);
        let w = to / d2.sqrt().max(1e-30);
        // The angle the box subtends.
        let s2 = half2 / d2;
        let is_inside = d2 <= half2;
        let (sin_b, cos_b) = if is_inside { (0.0, -1.0) } else { (s2.sqrt(), (1.0 - s2).sqrt()) };
        // θ_w, the angle between the axis and the direction to the point.
        let cos_w = self.axis.dot(w);
        let cos_w = if self.two_sided { cos_w.abs() } else { cos_w };
        let sin = |c: f32| (1.0 - c * c).max(0.0).sqrt();
        let (sin_w, sin_o) = (sin(cos_w), sin(self.cos_o));
        // θ' = max(0, θ_w − θ_o − θ_b); beyond θ_e the cluster emits nothing.
        let (sin_x, cos_x) = minus(sin_w, cos_w, sin_o, self.cos_o);
        let (_, cos_p) = minus(sin_x, cos_x, sin_b, cos_b);
        let cos_p = if cos_p <= self.cos_e { 0.0 } else { cos_p };
        let cos_emit = if self.cos_o <= -1.0 || cos_b <= -1.0 { 1.0 } else { cos_p };
        let importance = self.intensity * cos_emit / falloff;
        // |cos θ_i'| with the angle of the cluster subtracted: a bound on the cosine at the receiver.
        let cos_i = -w.dot(ctx.n);
        let (_, cos) = minus(sin(cos_i), cos_i, sin_b, cos_b);
        let facing = if cos_b <= -1.0 || ctx.n == Vec3::ZERO { 1.0 } else { cos.max(0.0) };
        importance * facing
    }
}

/// Sine and cosine of `max(0, a − b)`.
#[inline(always)]
fn minus(sin_a: f32, cos_a: f32, sin_b: f32, cos_b: f32) -> (f32, f32) {
    if cos_a > cos_b { (0.0, 1.0) } else { (sin_a * cos_b - cos_a * sin_b, cos_a * cos_b + sin_a * sin_b) }
}

/// The smallest cone (axis, cosine of half angle) around two cones.
fn union_cones(a: (Vec3, f32), b: (Vec3, f32)) -> (Vec3, f32) {
    let (a, b) = if a.1 <= b.1 { (a, b) } else { (b, a) };
    if a.1 <= -1.0 {
        return (a.0, -1.0);
    }
    // Bounding cone of two cones (PBR 4th ed., 3.8.4): one inside the other, or the cone that spans both.
    let (ta, tb) = (a.1.clamp(-1.0, 1.0).acos(), b.1.clamp(-1.0, 1.0).acos());
    let between = a.0.dot(b.0).clamp(-1.0, 1.0).acos();
    if between + tb <= ta {
        return a;
    }
    let t = (ta + tb + between) * 0.5;
    if t >= std::f32::consts::PI {
        return (a.0, -1.0);
    }
    let across = a.0.cross(b.0);
    match across.try_normalize() {
        Some(k) => {
            let r = t - ta;
            // Rodrigues' rotation of a's axis towards b's.
            ((a.0 * r.cos() + k.cross(a.0) * r.sin()).normalize(), t.cos())
        }
        None => (a.0, -1.0),
    }
}

/// A node of the tree.
#[derive(Clone, Debug)]
pub struct Node {
    /// Bounds of the lights below the node.
    pub cluster: Cluster,
    /// The second child (the first follows the node), or the light's index for a leaf.
    pub index: u32,
    /// True for a single light.
    pub leaf: bool,
}

/// The first of two children in proportion to their importance, or the second: whether it is that, its probability, and
/// `u` made anew; probability zero where neither can contribute.
#[inline(always)]
pub fn choose_child(first: f32, second: f32, u: f32) -> (bool, f32, f32) {
    // Rescale u within the chosen part, so that one number walks the whole tree.
    let total = first + second;
    let p = first / total;
    let is_second = u >= p;
    let (chance, u) = if is_second { (1.0 - p, (u - p) / (1.0 - p)) } else { (p, u / p) };
    let is_sound = (total > 0.0) & (total < f32::INFINITY);
    (is_second, if is_sound { chance } else { 0.0 }, u.min(steradian_math::hash::ONE_MINUS_EPSILON))
}

/// A binary tree over the lights that have bounds.
#[derive(Clone, Debug, Default)]
pub struct LightTree {
    nodes: Vec<Node>,
    /// The way from the root to each light, one bit a level, lowest first; `u64::MAX` for lights that are not in the
    /// tree.
    trails: Vec<u64>,
}

/// Deeper than this, splits are by halves, so that a trail fits 64 bits.
const MAX_FREE_DEPTH: u32 = 30;

impl LightTree {
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.trails[..])
    }

    /// Builds the tree over (index, bounds); `count` is the number of all lights.
    pub fn new(lights: &[(u32, LightBounds)], count: usize) -> Self {
        let mut tree = Self { nodes: Vec::with_capacity(lights.len() * 2), trails: vec![u64::MAX; count] };
        let mut items = lights.to_vec();
        if !items.is_empty() {
            tree.build(&mut items, 0, 0);
        }
        tree
    }

    /// Number of lights.
    pub fn len(&self) -> usize {
        self.nodes.len().div_ceil(2)
    }

    /// True if there is no light.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Depth is bounded: at most `MAX_FREE_DEPTH` free splits, then halves.
    fn build(&mut self, items: &mut [(u32, LightBounds)], trail: u64, depth: u32) -> usize {
        let at = self.nodes.len();
        // A leaf records its trail of left and right turns.
        if let [(light, bounds)] = items {
            self.trails[*light as usize] = trail;
            self.nodes.push(Node { cluster: Cluster::new(bounds), index: *light, leaf: true });
            return at;
        }
        // Bounds of all lights below, then the split of least cost.
        let all = items.iter().map(|i| i.1).reduce(|a, b| a.union(&b)).unwrap_or(items[0].1);
        self.nodes.push(Node { cluster: Cluster::new(&all), index: 0, leaf: false });
        // Below the free depth, or where no split is found, halve the list along the longest axis.
        let middle = if depth < MAX_FREE_DEPTH { split(items) } else { None };
        let middle = middle.unwrap_or_else(|| {
            let axis = all.bounds.longest_axis();
            items.sort_by(|a, b| order(a, b, axis));
            items.len() / 2
        });
        let (left, right) = items.split_at_mut(middle);
        self.build(left, trail, depth + 1);
        let second = self.build(right, trail | 1 << depth.min(63), depth + 1);
        self.nodes[at].index = second as u32;
        at
    }

    /// The root's importance.
    #[inline]
    pub fn importance(&self, ctx: &LightContext) -> f32 {
        self.nodes.first().map_or(0.0, |n| n.cluster.importance(ctx))
    }

    /// Walks down, choosing a child in proportion to its importance; gives a light and its probability.
    #[inline]
    pub fn sample(&self, ctx: &LightContext, mut u: f32) -> Option<(u32, f32)> {
        let mut at = 0;
        let mut p = 1.0;
        loop {
            let node = self.nodes.get(at)?;
            if node.leaf {
                return Some((node.index, p));
            }
            let (a, b) = (at + 1, node.index as usize);
            let (ia, ib) = (self.nodes[a].cluster.importance(ctx), self.nodes[b].cluster.importance(ctx));
            let (is_second, chance, next) = choose_child(ia, ib, u);
            if chance <= 0.0 {
                return None;
            }
            (u, p, at) = (next, p * chance, if is_second { b } else { a });
        }
    }

    /// The nodes, of which the first is the root.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The probability with which [`LightTree::sample`] gives a light.
    #[inline]
    pub fn probability(&self, ctx: &LightContext, light: u32) -> f32 {
        let mut trail = self.trails[light as usize];
        let mut at = 0;
        let mut p = 1.0;
        if self.nodes.is_empty() || (trail == u64::MAX && self.nodes.len() > 1) {
            return 0.0;
        }
        // Follow the trail and multiply the probabilities of its turns.
        loop {
            let node = &self.nodes[at];
            if node.leaf {
                return p;
            }
            let (a, b) = (at + 1, node.index as usize);
            let (ia, ib) = (self.nodes[a].cluster.importance(ctx), self.nodes[b].cluster.importance(ctx));
            let total = ia + ib;
            if !(total > 0.0 && total.is_finite()) {
                return 0.0;
            }
            let pa = ia / total;
            let second = trail & 1 == 1;
            p *= if second { 1.0 - pa } else { pa };
            if p == 0.0 {
                return 0.0;
            }
            at = if second { b } else { a };
            trail >>= 1;
        }
    }
}

fn order(a: &(u32, LightBounds), b: &(u32, LightBounds), axis: usize) -> std::cmp::Ordering {
    a.1.bounds.center()[axis].total_cmp(&b.1.bounds.center()[axis]).then(a.0.cmp(&b.0))
}

/// Orders lights along the axis and gives the place of the split with the least surface-area-orientation cost, among
/// twelve buckets per axis; `None` where all centres coincide.
fn split(items: &mut [(u32, LightBounds)]) -> Option<usize> {
    const BUCKETS: usize = 12;
    let centers = Bounds3::from_points(items.iter().map(|i| i.1.bounds.center()));
    let extent = centers.diagonal();
    let bucket_of = |l: &LightBounds, axis: usize| {
        let t = (l.bounds.center()[axis] - centers.min[axis]) / extent[axis];
        ((t * BUCKETS as f32) as usize).min(BUCKETS - 1)
    };
    let mut best: Option<(f32, usize, usize)> = None;
    for axis in 0..3 {
        if !(extent[axis] > 0.0 && extent[axis].is_finite()) {
            continue;
        }
        // Bin the centres; each bucket accumulates bounds, cones and intensity.
        let mut buckets: [Option<LightBounds>; BUCKETS] = [None; BUCKETS];
        for (_, l) in items.iter() {
            let b = &mut buckets[bucket_of(l, axis)];
            *b = Some(b.map_or(*l, |x| x.union(l)));
        }
        // Union of the buckets on one side of a cut.
        let gather = |r: std::ops::Range<usize>| buckets[r].iter().flatten().copied().reduce(|a, b| a.union(&b));
        for k in 1..BUCKETS {
            // Surface-area-orientation heuristic: cost of both sides of each cut between buckets.
            if let (Some(a), Some(b)) = (gather(0..k), gather(k..BUCKETS)) {
                let cost = measure(&a, extent, axis) + measure(&b, extent, axis);
                if best.is_none_or(|x| cost < x.0) {
                    best = Some((cost, axis, k));
                }
            }
        }
    }
    let (_, axis, k) = best?;
    // Sort along the chosen axis, so that the cut is an index.
    items.sort_by(|a, b| order(a, b, axis));
    let middle = items.partition_point(|i| bucket_of(&i.1, axis) < k);
    (middle > 0 && middle < items.len()).then_some(middle)
}

/// The surface-area-orientation measure of one side of a split.
fn measure(l: &LightBounds, extent: Vec3, axis: usize) -> f32 {
    use std::f32::consts::{FRAC_PI_2, PI, TAU};
    // M_Ω, the measure of the solid angle that normals and emission cover.
    let (to, te) = (l.cos_o.clamp(-1.0, 1.0).acos(), l.cos_e.clamp(-1.0, 1.0).acos());
    let tw = (to + te).min(PI);
    let orientation = TAU * (1.0 - l.cos_o)
        + FRAC_PI_2 * (2.0 * tw * to.sin() - (to - 2.0 * tw).cos() - 2.0 * to * to.sin() + l.cos_o);
    let d = l.bounds.diagonal();
    // Points and flat lights have no area: count a little of the extent.
    let area = l.bounds.area() + 1e-6 * extent.length_squared() + 1e-6 * d.length_squared();
    l.intensity * orientation * (extent.max_element() / extent[axis].max(1e-30)) * area
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::{Vec2, hash::HashRng, warp};

    fn random_lights(n: u32, rng: &mut HashRng) -> Vec<(u32, LightBounds)> {
        (0..n)
            .map(|i| {
                let mut p = || Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 10.0;
                let c = p();
                let e = p() * 0.05;
                let axis = warp::uniform_sphere(Vec2::new(rng.next_f32(), rng.next_f32()));
                let light = LightBounds {
                    bounds: Bounds3::new(c, c + e),
                    axis,
                    cos_o: if i % 3 == 0 { -1.0 } else { 1.0 },
                    cos_e: 0.0,
                    intensity: rng.next_f32() + 0.01,
                    two_sided: i % 5 == 0,
                };
                (i, light)
            })
            .collect()
    }

    /// The probabilities that `sample` returns are those that `probability` states, they are the true frequencies, and
    /// a light that can contribute is never left out.
    #[test]
    fn probabilities_agree_and_sum_to_one() {
        let mut rng = HashRng::new(1);
        for n in [1_u32, 2, 3, 17, 100] {
            let lights = random_lights(n, &mut rng);
            let tree = LightTree::new(&lights, n as usize);
            for _ in 0..20 {
                let p = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 14.0 - 2.0;
                let normal = if rng.next_f32() < 0.3 {
                    Vec3::ZERO
                } else {
                    warp::uniform_sphere(Vec2::new(rng.next_f32(), rng.next_f32()))
                };
                let ctx = LightContext { p, n: normal };
                let sum: f32 = (0..n).map(|l| tree.probability(&ctx, l)).sum();
                let samples = 400;
                let mut none = 0;
                for i in 0..samples {
                    match tree.sample(&ctx, (i as f32 + 0.5) / samples as f32) {
                        Some((l, pmf)) => {
                            assert!((pmf - tree.probability(&ctx, l)).abs() < 1e-4 * pmf + 1e-6);
                        }
                        None => none += 1,
                    }
                }
                assert!(sum < 1.0 + 1e-3);
                let lost = none as f32 / samples as f32;
                assert!((1.0 - sum - lost).abs() < 0.02, "{n}: sum {sum}, none {lost}");
                // Point lights that emit everywhere and face the surface can contribute.
                for (i, l) in &lights {
                    let facing = normal == Vec3::ZERO || (l.bounds.center() - p).normalize().dot(normal) > 0.05;
                    if l.cos_o == -1.0 && facing {
                        assert!(tree.probability(&ctx, *i) > 0.0);
                    }
                }
            }
        }
    }

    #[test]
    fn many_lights_at_one_place_make_a_shallow_tree() {
        let lights: Vec<_> = (0..10_000).map(|i| (i, LightBounds::point(Vec3::ONE, 1.0))).collect();
        let tree = LightTree::new(&lights, lights.len());
        let ctx = LightContext { p: Vec3::ZERO, n: Vec3::ZERO };
        assert!((tree.probability(&ctx, 77) * 10_000.0 - 1.0).abs() < 0.3);
    }
}
