//! Segmentation: triangles are merged into charts pair by pair, by a tree.
//!
//! Hierarchical face clustering (Garland, Willmott and Heckbert, "Hierarchical Face Clustering on Polygonal Surfaces",
//! 2001): at first each triangle is a cluster, and the pair of neighbours whose union is best is merged, again and again.
//! A union is good if its normals vary little (the L²'¹ metric of Cohen-Steiner, Alliez and Desbrun, "Variational Shape
//! Approximation", 2004: ∫|n − n̄|² is twice the area less the length of the area vectors' sum) and if its border is short
//! for its area. Small unions come first, so that the tree is even.
//!
//! A pair is left alone if a cone around its normals would be wider than allowed, or if it were no disk. Two disks make
//! a disk if their common border is a single open chain of sides: each open chain takes one from the sum of the Euler
//! characteristics, χ = 1 + 1 − 1, a closed one nothing. Thus no chart is ever closed or has holes.
//!
//! The tree of unions remains, to take a chart apart into two disks.

use crate::connect::{Connections, NONE, next};
use crate::mesh::Mesh;
use std::{
    cell::Cell,
    cmp::Reverse,
    collections::{BTreeMap, BinaryHeap},
};
use steradian_math::{
    DVec3,
    elementary::{angle_f64, sin_cos_f64},
};

/// Weight of the border, against that of the normals.
const BORDER: f64 = 0.05;

/// Charts, and the tree that takes them apart.
pub struct Clusters {
    /// Roots of the tree: the charts.
    pub roots: Vec<u32>,
    /// The two parts of each union; a node below the number of triangles is a triangle.
    parts: Vec<[u32; 2]>,
    triangles: u32,
}

impl Clusters {
    /// The two parts of a chart; nothing for a triangle.
    pub fn parts(&self, node: u32) -> Option<[u32; 2]> {
        node.checked_sub(self.triangles).map(|k| self.parts[k as usize])
    }

    /// The triangles of a chart, in order.
    pub fn triangles(&self, node: u32) -> Vec<u32> {
        let (mut found, mut work) = (Vec::new(), vec![node]);
        while let Some(node) = work.pop() {
            match self.parts(node) {
                Some(parts) => work.extend(parts),
                None => found.push(node),
            }
        }
        found.sort_unstable();
        found
    }
}

/// Cone around directions.
#[derive(Clone, Copy)]
struct Cone {
    axis: DVec3,
    half_angle: f64,
}

impl Cone {
    /// The smallest cone around two.
    fn union(self, other: Self) -> Self {
        let (wide, narrow) = if self.half_angle >= other.half_angle { (self, other) } else { (other, self) };
        let across = narrow.axis - wide.axis * wide.axis.dot(narrow.axis);
        let between = angle_f64(across.length(), wide.axis.dot(narrow.axis));
        if between + narrow.half_angle <= wide.half_angle {
            return wide;
        }
        let half_angle = 0.5 * (wide.half_angle + between + narrow.half_angle);
        let (sin, cos) = sin_cos_f64(half_angle - wide.half_angle);
        let axis = wide.axis * cos + across.normalize_or_zero() * sin;
        Self { axis: axis.normalize_or(wide.axis), half_angle }
    }
}

/// Sides that two clusters have in common, as those of one of them.
#[derive(Clone, Default)]
struct Common {
    sides: Vec<u32>,
    length: f64,
}

/// A connected set of triangles.
struct Cluster {
    node: u32,
    area: f64,
    /// Sum of the area vectors.
    vector: DVec3,
    perimeter: f64,
    cone: Cone,
    neighbours: BTreeMap<u32, Common>,
    /// Number of unions so far: what was computed for fewer is out of date.
    age: u32,
}

/// Pair in the queue: cost by its bits, two clusters and their ages.
type Pair = Reverse<(u64, [u32; 2], [u32; 2])>;

/// Clusters that grow; each is kept at the number of one of its triangles.
struct Merging<'a> {
    connections: &'a Connections,
    widest: f64,
    clusters: Vec<Cluster>,
    /// Cluster that each triangle, or cluster of old, went into.
    home: Vec<Cell<u32>>,
    parts: Vec<[u32; 2]>,
    queue: BinaryHeap<Pair>,
}

/// Merges triangles into charts whose normals lie in cones of a half angle.
pub fn cluster(mesh: &Mesh<'_>, connections: &Connections, widest: f64) -> Clusters {
    let count = mesh.triangles.len() as u32;
    let clusters = (0..count).map(|t| {
        let [a, b, c] = mesh.corners(t);
        let lengths = [a.distance(b), b.distance(c), c.distance(a)];
        let mut neighbours: BTreeMap<u32, Common> = BTreeMap::new();
        for (side, length) in (3 * t..).zip(lengths) {
            let partner = connections.partner[side as usize];
            if partner != NONE {
                let common = neighbours.entry(partner / 3).or_default();
                common.sides.push(side);
                common.length += length;
            }
        }
        let (area, normal) = (connections.area[t as usize], connections.normal[t as usize]);
        Cluster {
            node: t,
            area,
            vector: normal * area,
            perimeter: lengths.iter().sum(),
            cone: Cone { axis: normal, half_angle: 0.0 },
            neighbours,
            age: 0,
        }
    });
    let mut merging = Merging {
        connections,
        widest,
        clusters: clusters.collect(),
        home: (0..count).map(Cell::new).collect(),
        parts: Vec::new(),
        queue: BinaryHeap::new(),
    };
    for t in 0..count {
        merging.enqueue(t, |other| other > t);
    }
    while let Some(Reverse((_, [a, b], ages))) = merging.queue.pop() {
        let is_current = [a, b].map(|c| merging.clusters[c as usize].age) == ages
            && [a, b].iter().all(|c| merging.home[*c as usize].get() == *c);
        if is_current && merging.makes_disk(a, b) {
            let merged = merging.merge(a, b);
            merging.enqueue(merged, |_| true);
        }
    }
    let is_root = |t: &u32| merging.home[*t as usize].get() == *t && connections.area[*t as usize] > 0.0;
    let roots = (0..count).filter(is_root).map(|t| merging.clusters[t as usize].node).collect();
    Clusters { roots, parts: merging.parts, triangles: count }
}

impl Merging<'_> {
    /// The cluster that a triangle is in.
    fn cluster_of(&self, triangle: u32) -> u32 {
        let mut at = triangle;
        loop {
            let above = self.home[at as usize].get();
            if above == at {
                return at;
            }
            // Paths are halved on the way.
            self.home[at as usize].set(self.home[above as usize].get());
            at = above;
        }
    }

    /// Puts a cluster's pairs with some of its neighbours into the queue, if the cones are narrow enough.
    fn enqueue(&mut self, a: u32, is_wanted: impl Fn(u32) -> bool) {
        let this = &self.clusters[a as usize];
        for (&b, common) in this.neighbours.iter().filter(|(b, _)| is_wanted(**b)) {
            let other = &self.clusters[b as usize];
            if this.cone.union(other.cone).half_angle > self.widest {
                continue;
            }
            let area = this.area + other.area;
            let bent = area - (this.vector + other.vector).length();
            let perimeter = this.perimeter + other.perimeter - 2.0 * common.length;
            let border = perimeter * perimeter / (4.0 * std::f64::consts::PI);
            let cost = (bent + BORDER * border).max(0.0) / area.sqrt();
            self.queue.push(Reverse((cost.to_bits(), [a, b], [this.age, other.age])));
        }
    }

    /// True if the common border of two disks is a single open chain.
    fn makes_disk(&self, a: u32, b: u32) -> bool {
        let sides = &self.clusters[a as usize].neighbours[&b].sides;
        let partner = |side: u32| self.connections.partner[side as usize];
        // The side that follows on the border of a cluster: around the corner, through its triangles.
        let following = |side: u32, cluster: u32| {
            let mut at = next(side);
            while partner(at) != NONE && self.cluster_of(partner(at) / 3) == cluster {
                at = next(partner(at));
            }
            at
        };
        let goes_on = |side: &u32| {
            let after = following(*side, a);
            let back = partner(after);
            back != NONE && self.cluster_of(back / 3) == b && following(back, b) == partner(*side)
        };
        sides.len() - sides.iter().filter(|side| goes_on(side)).count() == 1
    }

    /// Merges the cluster with fewer neighbours into the other, and gives that.
    fn merge(&mut self, a: u32, b: u32) -> u32 {
        let count = |c: u32| self.clusters[c as usize].neighbours.len();
        let (into, from) = if count(a) >= count(b) { (a, b) } else { (b, a) };
        self.home[from as usize].set(into);
        let neighbours = std::mem::take(&mut self.clusters[from as usize].neighbours);
        let length = neighbours[&into].length;
        for (other, common) in neighbours.into_iter().filter(|(other, _)| *other != into) {
            let theirs = &mut self.clusters[other as usize].neighbours;
            let back = theirs.remove(&from).unwrap_or_default();
            append(theirs.entry(into).or_default(), back);
            append(self.clusters[into as usize].neighbours.entry(other).or_default(), common);
        }
        self.clusters[into as usize].neighbours.remove(&from);
        let node = self.home.len() + self.parts.len();
        self.parts.push([a, b].map(|c| self.clusters[c as usize].node));
        let Cluster { area, vector, perimeter, cone, .. } = self.clusters[from as usize];
        let cluster = &mut self.clusters[into as usize];
        cluster.node = node as u32;
        cluster.area += area;
        cluster.vector += vector;
        cluster.perimeter += perimeter - 2.0 * length;
        cluster.cone = cluster.cone.union(cone);
        cluster.age += 1;
        into
    }
}

/// Adds the sides of one list to another, the shorter to the longer.
fn append(to: &mut Common, mut from: Common) {
    if from.sides.len() > to.sides.len() {
        std::mem::swap(&mut to.sides, &mut from.sides);
    }
    to.sides.append(&mut from.sides);
    to.length += from.length;
}
