//! Patches that share one irradiance for each side, where a scene has more pieces of surface than patches are asked
//! for.
//!
//! All sides begin in three groups: those that emit, those that light passes, and all others. The group whose members
//! differ most, by the variance of their places and normals times their area, is split in two through its mean, until
//! there are as many clusters as patches asked for. Each member keeps its own reflectance and sources; a cluster sends
//! the mean radiosity of its members by area. Form factors between clusters are found by rays (compare the patches of
//! patch–element methods, Cohen et al. 1986).

use super::{
    factors::{Exchange, FormFactors, Row, collected},
    patches::{NONE, Patches},
    system::System,
};
use glam::{DVec3, DVec4};
use std::{cmp::Ordering, collections::BinaryHeap};

/// Least number of rays from a cluster, where form factors are not said to be found by a number of rays.
const RAYS: usize = 2048;
/// Rays that are traced together.
const TOGETHER: u32 = 1 << 12;
/// A difference of normals counts as this part of half the scene's diagonal.
const TURN: f64 = 0.5;

/// A partition of patches.
#[derive(Clone, Debug, Default)]
pub struct Clusters {
    /// The cluster of each patch.
    of_patch: Vec<u32>,
    /// The members of each cluster, with the area of those up to and with it.
    members: Vec<Vec<(u32, f64)>>,
    /// The cluster on the other side of each, or [`NONE`].
    twins: Vec<u32>,
}

/// Patches that are to be split, with how much they differ and along which of their measures.
struct Group {
    members: Vec<u32>,
    /// True if the sides behind these make a cluster too.
    is_double: bool,
    difference: f64,
    axis: usize,
    middle: f64,
}

impl PartialEq for Group {
    fn eq(&self, o: &Self) -> bool {
        self.cmp(o) == Ordering::Equal
    }
}

impl Eq for Group {}

impl PartialOrd for Group {
    fn partial_cmp(&self, o: &Self) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}

impl Ord for Group {
    fn cmp(&self, o: &Self) -> Ordering {
        self.difference.total_cmp(&o.difference).then_with(|| o.members.cmp(&self.members))
    }
}

/// Coordinates by which members of a group are compared: places relative to half the scene's diagonal, and normals.
fn measures(patches: &Patches) -> Vec<[f64; 6]> {
    let centers: Vec<DVec3> = patches.list.iter().map(|p| p.polygon.center()).collect();
    let (low, high) = centers.iter().fold((DVec3::MAX, DVec3::MIN), |(low, high), p| (low.min(*p), high.max(*p)));
    // Six coordinates: places in half diagonals, and normals with a weight.
    let scale = 2.0 / (high - low).length().max(f64::MIN_POSITIVE);
    let of = |(patch, center): (&super::patches::Patch, &DVec3)| {
        let ([x, y, z], n) = (((*center - low) * scale).to_array(), patch.polygon.normal() * TURN);
        [x, y, z, n.x, n.y, n.z]
    };
    patches.list.iter().zip(&centers).map(of).collect()
}

impl Group {
    fn new(members: Vec<u32>, is_double: bool, patches: &Patches, measures: &[[f64; 6]]) -> Self {
        let area = |k: u32| patches.list[k as usize].area;
        // Area-weighted mean and variance along each coordinate; the group is split along the greatest.
        let total: f64 = members.iter().map(|k| area(*k)).sum();
        let moments = |axis: usize| {
            let at = |k: &u32| measures[*k as usize][axis];
            let mean = members.iter().map(|k| at(k) * area(*k)).sum::<f64>() / total;
            (mean, members.iter().map(|k| (at(k) - mean).powi(2) * area(*k)).sum::<f64>())
        };
        let all: [(f64, f64); 6] = std::array::from_fn(moments);
        let axis = (0..6).max_by(|a, b| all[*a].1.total_cmp(&all[*b].1).then(b.cmp(a))).unwrap_or(0);
        let (middle, difference) = (all[axis].0, all.iter().map(|m| m.1).sum());
        Self { members, is_double, difference, axis, middle }
    }
}

impl Clusters {
    /// At most `count` clusters of some patches, or one for each group that cannot be mixed; `None` where told to stop.
    pub fn new(patches: &Patches, count: usize, tell: &dyn Fn(usize) -> bool) -> Option<Self> {
        let measures = measures(patches);
        // True if any band of a patch has such a value.
        let any = |values: &[DVec4], k: u32| {
            let k = k as usize * patches.bands;
            values[k..k + patches.bands].iter().any(|v| v.max_element() > 0.0)
        };
        let twin = |k: u32| patches.list[k as usize].twin;
        // Sides that light passes between are clustered together with those behind them.
        let passes = |k: u32| {
            let twin = twin(k);
            twin != NONE && [k, twin].iter().any(|k| any(&patches.transmittance, *k))
        };
        // Four kinds that never mix: lamps or dark, single or double sided.
        let all = 0..patches.len() as u32;
        let (double, single): (Vec<u32>, Vec<u32>) = all.partition(|k| passes(*k));
        let (lamps, dark): (Vec<u32>, Vec<u32>) = single.into_iter().partition(|k| any(&patches.emission, *k));
        let (double_lamps, double_dark): (Vec<u32>, Vec<u32>) = double
            .into_iter()
            .filter(|k| *k < twin(*k))
            .partition(|k| any(&patches.emission, *k) || any(&patches.emission, twin(*k)));
        let groups = [(lamps, false), (dark, false), (double_lamps, true), (double_dark, true)];
        let mut heap: BinaryHeap<Group> = groups
            .into_iter()
            .filter(|(members, _)| !members.is_empty())
            .map(|(members, is_double)| Group::new(members, is_double, patches, &measures))
            .collect();
        let mut done: Vec<Group> = Vec::new();
        let size = |group: &Group| 1 + usize::from(group.is_double);
        let mut clusters: usize = heap.iter().map(size).sum();
        // Top down: the most varied group is split at its mean, until the number of clusters is reached.
        while let Some(group) = heap.pop() {
            if !tell(0) {
                return None;
            }
            // Members on either side of the mean along the axis of greatest variance.
            let is_small = |k: &u32| measures[*k as usize][group.axis] < group.middle;
            let (a, b): (Vec<u32>, Vec<u32>) = group.members.iter().partition(|k| is_small(k));
            if clusters + size(&group) > count || a.is_empty() || b.is_empty() {
                done.push(group);
                continue;
            }
            clusters += size(&group);
            heap.extend([a, b].map(|members| Group::new(members, group.is_double, patches, &measures)));
        }
        // Double groups become two clusters, each the twin of the other.
        let mut new = Self { of_patch: vec![NONE; patches.len()], ..Self::default() };
        for group in done {
            let first = new.members.len() as u32;
            if group.is_double {
                let behind = group.members.iter().map(|k| twin(*k)).collect();
                new.add(patches, group.members, first + 1);
                new.add(patches, behind, first);
            } else {
                new.add(patches, group.members, NONE);
            }
        }
        Some(new)
    }

    fn add(&mut self, patches: &Patches, members: Vec<u32>, twin: u32) {
        let cluster = self.members.len() as u32;
        members.iter().for_each(|k| self.of_patch[*k as usize] = cluster);
        // Cumulative areas, for drawing members by area.
        let upto = members.into_iter().scan(0.0, |sum, k| {
            *sum += patches.list[k as usize].area;
            Some((k, *sum))
        });
        self.members.push(upto.collect());
        self.twins.push(twin);
    }

    fn area(&self, cluster: usize) -> f64 {
        self.members[cluster].last().map_or(0.0, |m| m.1)
    }

    /// Means of values of patches over clusters, by area; for each band.
    pub fn means(&self, patches: &Patches, values: &[DVec4]) -> Vec<DVec4> {
        let n = patches.bands;
        let mut means = vec![DVec4::ZERO; self.members.len() * n];
        // Mean by area: Σ v A / Σ A.
        for (k, &cluster) in self.of_patch.iter().enumerate() {
            let share = patches.list[k].area / self.area(cluster as usize);
            for b in 0..n {
                means[cluster as usize * n + b] += values[k * n + b] * share;
            }
        }
        means
    }

    /// The value of its cluster for each patch and band.
    pub fn by_patch(&self, values: &[DVec4], bands: usize) -> Vec<DVec4> {
        self.of_patch.iter().flat_map(|c| &values[*c as usize * bands..][..bands]).copied().collect()
    }

    /// The row of a cluster, by rays from all over it.
    fn row(&self, exchange: &Exchange<'_>, cluster: usize) -> Row {
        // Rays from points drawn by area over the cluster, with cosine-distributed directions.
        let count = match exchange.method {
            FormFactors::MonteCarlo(rays) => rays,
            _ => RAYS.max(2 * self.members.len()) as u32,
        };
        let (members, area) = (&self.members[cluster], self.area(cluster));
        let seed = steradian_math::hash::combine32(exchange.seed ^ 0x5bd1_e995, cluster as u32);
        let ray = |k: u32| {
            let [a, b, c, d] = steradian_math::sobol::shuffled_scrambled_sobol_4d(k, seed);
            let at = f64::from(a) * area;
            // The member by inversion of the cumulative area; what is left of the number places the point within it.
            let chosen = members.partition_point(|m| m.1 <= at).min(members.len() - 1);
            let before = if chosen > 0 { members[chosen - 1].1 } else { 0.0 };
            let within = ((at - before) / (members[chosen].1 - before)).clamp(0.0, 1.0 - 1e-7) as f32;
            exchange.ray_at(&exchange.patches.list[members[chosen].0 as usize], [within, b, c, d])
        };
        let share = 1.0 / f64::from(count);
        let mut row = Row::new();
        // F_ij is the share of rays that cluster j receives.
        for start in (0..count).step_by(TOGETHER as usize).take_while(|_| (exchange.tell)(0)) {
            let rays: Vec<_> = (start..count.min(start + TOGETHER)).map(ray).collect();
            let met = exchange.met(&rays).into_iter().filter(|k| *k != NONE);
            row = collected(row.into_iter().chain(met.map(|k| (self.of_patch[k as usize], share))));
        }
        row
    }
}

/// Unknowns of the equation: patches, or clusters of them.
pub struct Unknowns<'a> {
    exchange: &'a Exchange<'a>,
    clusters: Option<Clusters>,
}

impl<'a> Unknowns<'a> {
    /// Clusters where there are more pieces than patches asked for; `None` where told to stop.
    pub fn new(exchange: &'a Exchange<'a>, count: usize) -> Option<Self> {
        let is_crowded = exchange.surfaces.pieces.len() > count;
        let clusters = if is_crowded { Some(Clusters::new(exchange.patches, count, &exchange.tell)?) } else { None };
        Some(Self { exchange, clusters })
    }

    /// Number of clusters, where there are any.
    pub fn clusters(&self) -> Option<usize> {
        self.clusters.as_ref().map(|c| c.members.len())
    }

    /// Number of unknowns.
    pub fn len(&self) -> usize {
        self.clusters().unwrap_or(self.exchange.patches.len())
    }

    /// The equation without form factors.
    pub fn system(&self) -> System {
        let patches = self.exchange.patches;
        // Albedos and sources of clusters are means by area; the form factors come later.
        let whole = System::of(patches);
        let Some(clusters) = &self.clusters else { return whole };
        System {
            rows: Vec::new(),
            reflectance: clusters.means(patches, &whole.reflectance),
            transmittance: clusters.means(patches, &whole.transmittance),
            sources: clusters.means(patches, &whole.sources),
            twins: clusters.twins.clone(),
            areas: (0..clusters.members.len()).map(|c| clusters.area(c)).collect(),
            bands: whole.bands,
        }
    }

    /// Emitted radiosities.
    pub fn emission(&self) -> Vec<DVec4> {
        let patches = self.exchange.patches;
        self.clusters.as_ref().map_or_else(|| patches.emission.clone(), |c| c.means(patches, &patches.emission))
    }

    /// A row of form factors.
    pub fn row(&self, i: usize) -> Row {
        self.clusters.as_ref().map_or_else(|| self.exchange.row(i), |c| c.row(self.exchange, i))
    }

    /// All rows; `None` where told to stop.
    pub fn rows(&self) -> Option<Vec<Row>> {
        match &self.clusters {
            Some(clusters) => self.exchange.rows_by(clusters.members.len(), &|i| clusters.row(self.exchange, i)),
            None => self.exchange.rows(),
        }
    }

    /// Irradiance of patches from that of the unknowns.
    pub fn by_patch(&self, irradiance: Vec<DVec4>) -> Vec<DVec4> {
        match &self.clusters {
            Some(clusters) => clusters.by_patch(&irradiance, self.exchange.patches.bands),
            None => irradiance,
        }
    }

    /// Irradiance of patches, of which those of a cluster have the mean.
    pub fn evened(&self, irradiance: Vec<DVec4>) -> Vec<DVec4> {
        match &self.clusters {
            Some(clusters) => self.by_patch(clusters.means(self.exchange.patches, &irradiance)),
            None => irradiance,
        }
    }
}
