//! Photons where they landed, in a grid.

use super::{
    subpath::Sums,
    vertex::{Place, Vertex},
};
use steradian_math::{Spectrum, Vec3, spectra::Wavelengths};

/// Light that arrived at a surface or at a point of a medium.
#[derive(Clone, Copy, Debug)]
pub(super) struct Photon {
    pub p: Vec3,
    /// Unit direction back to where it came from.
    pub wi: Vec3,
    ground: Ground,
    /// On surfaces the flux that arrived, also what the surface let pass: photons that land on it by chance count for
    /// those that did not. In media flux times length: the flux of collisions per scattering coefficient there, whose
    /// density is the fluence (Jensen, Christensen 1998).
    pub beta: Spectrum,
    pub lambda: Wavelengths,
    /// Events before it landed.
    pub events: u32,
    pub sums: Sums,
    /// True if all its events were specular, and there was one at least.
    pub is_focused: bool,
}

/// Matter that a photon landed on.
#[derive(Clone, Copy, Debug)]
enum Ground {
    /// A surface, by its geometric normal.
    Surface(Vec3),
    /// A medium, by its index.
    Medium(Option<u32>),
}

impl Photon {
    /// At a vertex of a light subpath, all of whose events may have been specular.
    pub fn of(v: &Vertex<'_>, is_specular: bool) -> Self {
        let (wi, ground, beta) = match &v.place {
            Place::Surface(s) => (s.i.wo, Ground::Surface(s.i.surface.n), v.beta / s.opacity),
            Place::Medium(m) => {
                let scattering = m.medium.scattering_at(m.p, &v.lambda);
                (m.wo, Ground::Medium(v.medium), v.beta.safe_div(scattering))
            }
        };
        Self {
            p: v.p(),
            wi,
            ground,
            beta,
            lambda: v.lambda,
            events: v.events,
            sums: v.sums,
            is_focused: is_specular && v.events > 0,
        }
    }

    /// True if the photon lies in a vertex's medium, or on its surface, rather than on another one about the corner:
    /// |n·n'| > 0.8.
    pub fn lies_on(&self, v: &Vertex<'_>) -> bool {
        match (&v.place, self.ground) {
            (Place::Surface(s), Ground::Surface(n)) => s.i.surface.n.dot(n).abs() > 0.8,
            (Place::Medium(_), Ground::Medium(medium)) => medium == v.medium,
            _ => false,
        }
    }
}

/// Photons by cells, whose edge is at least twice the radius of queries. Bytes: those of a photon and 4 to 8 more for
/// each.
#[derive(Debug)]
pub(super) struct Grid {
    photons: Vec<Photon>,
    /// First photon of each bucket of cells, and the end.
    starts: Vec<u32>,
    per_cell: f32,
}

impl Grid {
    /// For queries of up to a radius. Photons of a bucket stay in their order.
    pub fn new(photons: Vec<Photon>, radius: f32) -> Self {
        let buckets = photons.len().max(1).next_power_of_two();
        let mut grid =
            Self { photons: Vec::new(), starts: vec![0; buckets + 1], per_cell: 0.5 / radius.max(f32::MIN_POSITIVE) };
        // Counting sort by hashed cell: numbers in each bucket, prefix sums, and every photon to its place.
        let of: Vec<u32> = photons.iter().map(|p| grid.bucket(grid.cell(p.p))).collect();
        of.iter().for_each(|b| grid.starts[*b as usize + 1] += 1);
        for b in 0..buckets {
            grid.starts[b + 1] += grid.starts[b];
        }
        let mut next = grid.starts.clone();
        let mut order = vec![0_u32; photons.len()];
        for (k, b) in of.iter().enumerate() {
            order[next[*b as usize] as usize] = k as u32;
            next[*b as usize] += 1;
        }
        grid.photons = order.iter().map(|k| photons[*k as usize]).collect();
        grid
    }

    fn cell(&self, p: Vec3) -> [i32; 3] {
        (p * self.per_cell).floor().to_array().map(|v| v as i32)
    }

    fn bucket(&self, cell: [i32; 3]) -> u32 {
        let key = cell.iter().fold(0x51ed_270b_u32, |k, c| steradian_math::hash::combine32(k, *c as u32));
        key & (self.starts.len() as u32 - 2)
    }

    /// Calls `found` for every photon within a radius of a point.
    pub fn near(&self, p: Vec3, radius: f32, mut found: impl FnMut(&Photon)) {
        // The cells that the sphere of the query meets; two along each axis, three with rounding.
        let (lo, hi) = (self.cell(p - radius), self.cell(p + radius));
        let mut buckets = [u32::MAX; 27];
        let mut count = 0;
        for x in lo[0]..=hi[0].min(lo[0].saturating_add(2)) {
            for y in lo[1]..=hi[1].min(lo[1].saturating_add(2)) {
                for z in lo[2]..=hi[2].min(lo[2].saturating_add(2)) {
                    buckets[count] = self.bucket([x, y, z]);
                    count += 1;
                }
            }
        }
        // Cells may share a bucket.
        let buckets = &mut buckets[..count];
        buckets.sort_unstable();
        for (k, &b) in buckets.iter().enumerate() {
            if k > 0 && buckets[k - 1] == b {
                continue;
            }
            for photon in &self.photons[self.starts[b as usize] as usize..self.starts[b as usize + 1] as usize] {
                if (photon.p - p).length_squared() <= radius * radius {
                    found(photon);
                }
            }
        }
    }
}
