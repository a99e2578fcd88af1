//! Hierarchical radiosity (Hanrahan, Salzman, Aupperle 1991): light is exchanged between nodes of the quadtrees of any
//! level, over links. A link that carries more than the tolerance allows is replaced by links to or from the children
//! of its larger end, which is split where it must be.

use super::{
    bands::Bands,
    cells::Cells,
    direct,
    factors::{Exchange, PAIRS},
    form_factor,
    matter::Matter,
    patches::{Patch, Patches, make},
    surfaces::Surfaces,
};
use glam::DVec4;
use rayon::prelude::*;
use steradian_core::Scene;

/// Most pieces that are linked with each other.
pub const LIMIT: usize = 3000;
/// Most times that links are looked at.
const ROUNDS: usize = 24;
/// Factor on the doubt of links between which something stands.
const PARTLY: f64 = 8.0;
/// Most iterations of a round.
const MOST_ITERATIONS: usize = 200;

/// Goals of a solution.
#[derive(Clone, Copy, Debug)]
pub struct Wanted {
    /// The largest share of all light that a link may carry.
    pub tolerance: f64,
    /// The most leaves.
    pub patches: usize,
    /// The change at which iteration ends.
    pub precision: f64,
    /// Most times that light is carried from node to node; `None` for no limit.
    pub bounces: Option<u32>,
}

/// A side of a cell.
#[derive(Debug)]
struct Node {
    patch: Patch,
    matter: Vec<Matter>,
    /// Irradiance from lights that are no patches.
    direct: Vec<DVec4>,
    /// Links over which the node gathers.
    links: Vec<Link>,
    /// Irradiance over its own links, and with that of its parents.
    gathered: Vec<DVec4>,
    irradiance: Vec<DVec4>,
    radiosity: Vec<DVec4>,
}

/// Link of a receiver to a source that it gathers from.
#[derive(Clone, Copy, Debug)]
struct Link {
    source: u32,
    /// The form factor without what stands between, and the part that is seen.
    factor: f64,
    seen: f64,
    /// True if all rays between them passed.
    is_clear: bool,
}

impl Link {
    /// The form factor that may be wrong by not looking closer. Without anything in between it is exact, and only the
    /// light varies; else it is known as well as the rays tell, of which one more may see where none did.
    fn doubt(&self) -> f64 {
        if self.is_clear { self.factor } else { PARTLY * self.factor * self.seen.max(1.0 / PAIRS as f64) }
    }
}

/// All nodes, by cell and side.
struct Hierarchy<'a> {
    scene: &'a Scene,
    surfaces: &'a Surfaces,
    bands: &'a Bands,
    exchange: &'a Exchange<'a>,
    cells: Cells,
    nodes: Vec<Option<Box<Node>>>,
}

/// The quadtrees that were made, and how many links there are.
#[derive(Debug)]
pub struct Refined {
    /// The quadtrees.
    pub cells: Cells,
    /// Irradiance from patches by cell, side (front first) and band.
    pub irradiance: Vec<DVec4>,
    /// Number of links.
    pub links: usize,
    /// Rounds of refinement.
    pub rounds: usize,
}

/// Pairs of nodes that are linked before it is asked whether to go on.
const AT_ONCE: usize = 1 << 16;

/// Solves a scene; `exchange` is asked for visibility only. `None` where told to stop.
pub fn solve(exchange: &Exchange<'_>, bands: &Bands, wanted: Wanted) -> Option<Refined> {
    let (scene, surfaces) = (exchange.scene, exchange.surfaces);
    let mut all = Hierarchy { scene, surfaces, bands, exchange, cells: exchange.cells.clone(), nodes: Vec::new() };
    all.grow();
    // Whole pieces come first.
    let count = 2 * surfaces.pieces.len() as u32;
    // All whole pieces are linked to all others first.
    let roots: Vec<u32> = (0..count).filter(|k| all.nodes[*k as usize].is_some()).collect();
    let pairs: Vec<(u32, u32)> =
        roots.iter().flat_map(|p| roots.iter().filter(move |q| *q / 2 != *p / 2).map(move |q| (*p, *q))).collect();
    all.link(&pairs);
    all.iterate(wanted);
    let mut rounds = 0;
    // Rounds: links that carry too much are refined, and light is exchanged anew over all links.
    while rounds < ROUNDS {
        if !(exchange.tell)(1) {
            return None;
        }
        rounds += 1;
        if !all.refine(wanted) {
            break;
        }
        all.iterate(wanted);
    }
    if !(exchange.tell)(0) {
        return None;
    }
    let n = bands.count();
    // Irradiance of every node, for leaves and those above them.
    let mut irradiance = vec![DVec4::ZERO; all.nodes.len() * n];
    let mut links = 0;
    for (k, node) in all.nodes.iter().enumerate() {
        if let Some(node) = node {
            irradiance[k * n..(k + 1) * n].copy_from_slice(&node.irradiance);
            links += node.links.len();
        }
    }
    Some(Refined { cells: all.cells, irradiance, links, rounds })
}

impl Hierarchy<'_> {
    /// Makes the nodes of new cells.
    fn grow(&mut self) {
        let from = self.nodes.len() as u32;
        let to = self.cells.cells.len() as u32 * 2;
        let made: Vec<Option<Box<Node>>> = (from..to).into_par_iter().map(|k| self.node(k)).collect();
        self.nodes.extend(made);
    }

    fn node(&self, k: u32) -> Option<Box<Node>> {
        if !self.goes_on() {
            return None;
        }
        // Patch and materials of the side, and its light from lights that are no patches.
        let made = make(self.scene, self.surfaces, &self.cells, self.bands, k / 2, k.is_multiple_of(2));
        let (patch, matter) = made.patch?;
        let of = |sharp: bool| {
            direct::irradiance(self.scene, std::slice::from_ref(&patch), self.bands, sharp, self.exchange.tell)
        };
        let direct = of(true).into_iter().zip(of(false)).map(|(a, b)| a + b).collect();
        let none = vec![DVec4::ZERO; matter.len()];
        let (gathered, irradiance) = (none.clone(), none.clone());
        Some(Box::new(Node { patch, matter, direct, links: Vec::new(), gathered, irradiance, radiosity: none }))
    }

    /// False once told to stop; all that is found after it counts for nothing.
    fn goes_on(&self) -> bool {
        (self.exchange.tell)(0)
    }

    fn at(&self, k: u32) -> Option<&Node> {
        self.nodes.get(k as usize)?.as_deref()
    }

    /// Links receivers to sources, where anything is exchanged.
    fn link(&mut self, pairs: &[(u32, u32)]) {
        for pairs in pairs.chunks(AT_ONCE).take_while(|_| (self.exchange.tell)(0)) {
            self.link_some(pairs);
        }
    }

    fn link_some(&mut self, pairs: &[(u32, u32)]) {
        let links: Vec<Option<Link>> = pairs
            .par_iter()
            .map(|&(p, q)| {
                let (a, b) = (self.at(p)?, self.at(q)?);
                // F_pq without occlusion, and the part of the pairs of points that see each other.
                let factor = form_factor::exchange(&a.patch.polygon, &b.patch.polygon) / a.patch.area;
                (factor > 0.0).then(|| {
                    let seen = self.exchange.visibility_of_all(&a.patch, &b.patch);
                    Link { source: q, factor, seen: seen.unwrap_or(1.0), is_clear: seen == Some(1.0) }
                })
            })
            .collect();
        for (&(p, _), link) in pairs.iter().zip(links) {
            if let Some(node) = self.nodes[p as usize].as_deref_mut() {
                node.links.extend(link);
            }
        }
    }

    /// Gathers, pushes down and pulls up until radiosities change no more.
    fn iterate(&mut self, wanted: Wanted) {
        let mut most = MOST_ITERATIONS;
        if let Some(bounces) = wanted.bounces {
            // The sum of all bounces up to a limit begins with what is emitted.
            self.nodes.par_iter_mut().flatten().for_each(|node| node.irradiance.fill(DVec4::ZERO));
            self.pull(false);
            most = most.min(bounces as usize);
        }
        // Gather: H_p = Σ F_pq V_pq B_q over the links of each node.
        for _ in 0..most {
            if !self.goes_on() {
                break;
            }
            let gathered: Vec<Vec<DVec4>> = self
                .nodes
                .par_iter()
                .map(|node| {
                    let Some(node) = node else { return Vec::new() };
                    let mut sum = vec![DVec4::ZERO; node.matter.len()];
                    // F V B of each link; a source may be of any level.
                    for link in &node.links {
                        let Some(source) = self.at(link.source) else { continue };
                        let f = link.factor * link.seen;
                        sum.iter_mut().zip(&source.radiosity).for_each(|(s, b)| *s += *b * f);
                    }
                    sum
                })
                .collect();
            for (node, gathered) in self.nodes.iter_mut().zip(gathered) {
                if let Some(node) = node {
                    node.irradiance.clone_from(&gathered);
                    node.gathered = gathered;
                }
            }
            // Push H down, then pull B up, until nothing changes.
            self.push();
            let (moved, largest) = self.pull(true);
            if moved <= wanted.precision * largest {
                break;
            }
        }
    }

    /// Irradiances go down to the leaves.
    fn push(&mut self) {
        // Children come after their parents.
        for cell in 0..self.cells.cells.len() as u32 {
            let children = self.cells.cells[cell as usize].children;
            for side in 0..if children == 0 { 0 } else { 2 } {
                // A child's irradiance is its own and that of its parent.
                let Some(above) = self.at(cell * 2 + side).map(|n| n.irradiance.clone()) else { continue };
                for child in children..children + 4 {
                    if let Some(node) = self.nodes[(child * 2 + side) as usize].as_deref_mut() {
                        node.irradiance.iter_mut().zip(&above).for_each(|(h, a)| *h += *a);
                    }
                }
            }
        }
    }

    /// Radiosities go from the leaves up to the roots, with what lights that are no patches add, or without; the
    /// largest change of a leaf, and the largest value.
    fn pull(&mut self, with_direct: bool) -> (f64, f64) {
        let direct = f64::from(u8::from(with_direct));
        let (mut moved, mut largest) = (0.0_f64, 0.0_f64);
        // Children come after their parents: backwards, radiosities are ready when they are needed.
        for cell in (0..self.cells.cells.len() as u32).rev() {
            let children = self.cells.cells[cell as usize].children;
            for side in 0..2 {
                let k = cell * 2 + side;
                let Some(node) = self.at(k) else { continue };
                // A leaf reflects and transmits: B = E + ρ H + τ H'; an inner node has the mean of its children by
                // area.
                let next: Vec<DVec4> = if children == 0 {
                    let other = self.at(k ^ 1);
                    (0..node.matter.len())
                        .map(|b| {
                            let m = &node.matter[b];
                            let through = other.map_or(DVec4::ZERO, |o| {
                                (o.irradiance[b] + o.direct[b] * direct) * m.transmittance.0.as_dvec4()
                            });
                            let back = (node.irradiance[b] + node.direct[b] * direct) * m.reflectance.0.as_dvec4();
                            m.emission.0.as_dvec4() + back + through
                        })
                        .collect()
                } else {
                    let mut sum = vec![DVec4::ZERO; node.matter.len()];
                    let mut area = 0.0;
                    for child in children..children + 4 {
                        let size = f64::from(self.cells.cells[child as usize].area);
                        area += size;
                        if let Some(node) = self.at(child * 2 + side) {
                            sum.iter_mut().zip(&node.radiosity).for_each(|(s, b)| *s += *b * size);
                        }
                    }
                    sum.iter().map(|s| *s / area.max(f64::MIN_POSITIVE)).collect()
                };
                if let Some(node) = self.nodes[k as usize].as_deref_mut() {
                    if children == 0 {
                        for (a, b) in node.radiosity.iter().zip(&next) {
                            moved = moved.max((*b - *a).abs().max_element());
                            largest = largest.max(b.abs().max_element());
                        }
                    }
                    node.radiosity = next;
                }
            }
        }
        (moved, largest)
    }

    /// Replaces links that carry too much; whether there were any.
    fn refine(&mut self, wanted: Wanted) -> bool {
        let brightest = |values: &[DVec4]| values.iter().map(|v| v.max_element()).fold(0.0, f64::max);
        // Light of all sources, W: the tolerance is relative to it.
        let total: f64 = self
            .cells
            .leaves()
            .flat_map(|c| [c * 2, c * 2 + 1])
            .filter_map(|k| self.at(k))
            .map(|n| {
                let emitted = n.matter.iter().map(|m| f64::from(m.emission.max_element())).fold(0.0, f64::max);
                let reflected: Vec<DVec4> =
                    n.matter.iter().zip(&n.direct).map(|(m, d)| m.reflectance.0.as_dvec4() * *d).collect();
                (emitted + brightest(&reflected)) * n.patch.area
            })
            .sum();
        let limit = wanted.tolerance * total;
        let most = wanted.patches;
        // The links that carry most come first, for there may not be patches for all.
        let all: &Self = self;
        let mut heavy: Vec<(f64, u32, u32)> = all
            .nodes
            .par_iter()
            .enumerate()
            .flat_map_iter(|(p, node)| {
                node.iter().flat_map(move |node| {
                    node.links.iter().filter_map(move |link| {
                        // Power over the link as far as it is in doubt: form factor times radiosity times area.
                        let source = brightest(&all.at(link.source)?.radiosity);
                        let carried = link.doubt() * source * node.patch.area;
                        (carried > limit).then_some((carried, p as u32, link.source))
                    })
                })
            })
            .collect();
        heavy.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        let mut replaced = Vec::new();
        let mut leaves = self.cells.leaf_count(self.surfaces);
        // The larger end is split, unless the number of leaves is used up.
        for &(_, p, q) in &heavy {
            let area = |k: u32| self.cells.cells[k as usize / 2].area;
            let larger = if area(q) > area(p) { q } else { p };
            if self.cells.cells[larger as usize / 2].is_leaf() {
                if leaves + 3 > most {
                    continue;
                }
                self.cells.split(&self.surfaces.pieces, larger / 2);
                leaves += 3;
            }
            replaced.push((p, q, larger == q));
        }
        if replaced.is_empty() {
            return false;
        }
        // Nodes of the new cells; then the old links go, and four new ones take the place of each.
        self.grow();
        let mut gone: Vec<(u32, u32)> = replaced.iter().map(|r| (r.0, r.1)).collect();
        gone.sort_unstable();
        self.nodes.par_iter_mut().enumerate().for_each(|(p, node)| {
            if let Some(node) = node {
                node.links.retain(|link| gone.binary_search(&(p as u32, link.source)).is_err());
            }
        });
        // Four links to or from the children of the larger end.
        let pairs: Vec<(u32, u32)> = replaced
            .iter()
            .flat_map(|&(p, q, source)| {
                let parent = if source { q } else { p };
                let first = self.cells.cells[parent as usize / 2].children;
                (first..first + 4).map(move |c| c * 2 + parent % 2).map(move |c| if source { (p, c) } else { (c, q) })
            })
            .collect();
        self.link(&pairs);
        true
    }
}

/// Irradiances by patch and band from those by cell.
pub fn by_patch(patches: &Patches, irradiance: &[DVec4]) -> Vec<DVec4> {
    let n = patches.bands;
    patches
        .list
        .iter()
        .flat_map(|p| {
            let k = (p.cell * 2 + u32::from(!p.front)) as usize * n;
            irradiance[k..k + n].iter().copied()
        })
        .collect()
}
