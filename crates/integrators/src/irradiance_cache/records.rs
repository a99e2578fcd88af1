//! Records of irradiance, and interpolation between them (Ward, Rubinstein, Clear 1988, "A ray tracing solution for
//! diffuse interreflection"). The split-sphere model bounds the change of irradiance between a record i and a point by
//! `|x − x_i|/R_i + √(1 − n·n_i)`; the weight is its inverse (eq. 5). Records count where that error is below `a`. From
//! the weight `1/a` is taken, so that a record fades to nothing at its border.
//!
//! The octree is a hash table for each of its levels: a record lies in the cells, at most eight, that its sphere of
//! influence a R_i overlaps on the level whose cells are as wide as that sphere or up to twice as wide. A point looks
//! into one cell of each level.

use super::hemisphere::Irradiance;
use std::collections::{BTreeMap, HashMap};
use steradian_math::{Spectrum, Vec3};

/// Place and reach of a record.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Record {
    /// The point.
    pub p: Vec3,
    /// Unit normal.
    pub n: Vec3,
    /// R: harmonic mean distance of what is seen, after all bounds.
    pub radius: f32,
    /// Least R that neighbours may leave it.
    pub least: f32,
    /// Scattering events before it, which bound the length of the paths in it; zero where paths have no bound.
    pub events: u32,
}

/// All records.
#[derive(Clone, Debug, Default)]
pub(crate) struct Records {
    /// Largest error `a`.
    error: f32,
    records: Vec<Record>,
    /// Irradiance of each record, in so many bands.
    irradiance: Vec<Irradiance>,
    bands: usize,
    levels: BTreeMap<i32, HashMap<[i32; 3], Vec<u32>>>,
}

/// Cells of a level are 2^level wide.
const LEVELS: [f32; 2] = [-100.0, 100.0];

impl Records {
    /// None so far.
    pub fn new(error: f32, bands: usize) -> Self {
        Self { error, bands, ..Self::default() }
    }

    /// Number of records.
    pub fn len(&self) -> usize {
        self.records.len()
    }

    /// Bytes of a record: itself, its irradiance, and its places in the tree.
    pub const fn bytes(bands: usize) -> u64 {
        (size_of::<Record>() + bands * size_of::<Irradiance>() + size_of::<[u32; 8]>() + 64) as u64
    }

    /// Weight of a record at a point, if it counts there.
    #[inline]
    fn weight(&self, record: &Record, p: Vec3, n: Vec3, events: u32) -> Option<f32> {
        let d = p - record.p;
        let error = d.length() / record.radius + (1.0 - n.dot(record.n)).max(0.0).sqrt();
        // A record in front of the point may see what the point does not: none counts that lies above it.
        let is_behind = d.dot(n + record.n) < -0.02 * record.radius;
        // Written so that what is no number does not count.
        (error < self.error && !is_behind && events == record.events).then(|| 1.0 / error.max(1e-6) - 1.0 / self.error)
    }

    /// All records that count at a point, with their weights, in an order that their making decides.
    #[inline]
    fn about(&self, p: Vec3, n: Vec3, events: u32) -> impl Iterator<Item = (usize, f32)> {
        let in_cells =
            self.levels.iter().flat_map(move |(level, cells)| cells.get(&cell(p, *level)).into_iter().flatten());
        in_cells.filter_map(move |&k| Some((k as usize, self.weight(&self.records[k as usize], p, n, events)?)))
    }

    /// True if some record counts at a point.
    pub fn covers(&self, p: Vec3, n: Vec3, events: u32) -> bool {
        self.about(p, n, events).next().is_some()
    }

    /// Irradiance at a point, each band by `of`; `None` where no record counts. The weighted mean of what each record
    /// extrapolates by its gradients.
    #[inline]
    pub fn at(
        &self,
        p: Vec3,
        n: Vec3,
        events: u32,
        of: impl Fn(&[Irradiance], Vec3, Vec3) -> Spectrum,
    ) -> Option<Spectrum> {
        let (mut sum, mut total) = (Spectrum::ZERO, 0.0);
        for (k, weight) in self.about(p, n, events) {
            let record = &self.records[k];
            let bands = &self.irradiance[k * self.bands..][..self.bands];
            sum += of(bands, p - record.p, n - record.n) * weight;
            total += weight;
        }
        (total > 0.0).then(|| sum / total)
    }

    /// Adds a record. Neighbours bound each other's reach: `R_i ≤ R_j + |x_i − x_j|`, since what one sees close by is
    /// not much farther from the other (Křivánek and others 2006, "Making radiance and irradiance caching practical").
    pub fn insert(&mut self, mut record: Record, irradiance: &[Irradiance]) {
        let near: Vec<usize> = self.about(record.p, record.n, record.events).map(|(k, _)| k).collect();
        let distance = |other: &Record, p: Vec3| other.radius + (other.p - p).length();
        for &k in &near {
            record.radius = record.radius.min(distance(&self.records[k], record.p));
        }
        record.radius = record.radius.max(record.least);
        for &k in &near {
            let other = &mut self.records[k];
            other.radius = other.radius.min(distance(&record, other.p)).max(other.least);
        }
        let reach = self.error * record.radius;
        if !(reach > 0.0 && reach.is_finite() && record.p.is_finite()) {
            return;
        }
        let level = (2.0 * reach).log2().ceil().clamp(LEVELS[0], LEVELS[1]) as i32;
        let [low, high] = [-reach, reach].map(|r| cell(record.p + r, level));
        let cells = self.levels.entry(level).or_default();
        // Two cells at most along each axis.
        for corner in 0..8 {
            let side = |axis: usize| corner >> axis & 1;
            if (0..3).all(|axis| side(axis) == 0 || high[axis] != low[axis]) {
                let key = [0, 1, 2].map(|axis| if side(axis) == 0 { low[axis] } else { high[axis] });
                cells.entry(key).or_default().push(self.records.len() as u32);
            }
        }
        self.records.push(record);
        self.irradiance.extend_from_slice(irradiance);
    }
}

/// The cell of a level about a point; far ones fall together.
#[inline]
fn cell(p: Vec3, level: i32) -> [i32; 3] {
    let scale = (-level as f32).exp2();
    (p * scale).to_array().map(|v| v.floor() as i32)
}
