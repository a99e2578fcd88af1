//! The hits of rays that are traced together.

use crate::UserHit;
use crate::nearest::{Extra, Nearest};
use crate::simd::{Lanes, Wide};

/// The nearest hits of the rays of a packet so far.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    /// Distances; those of rays without a hit are where their intervals end.
    pub t: Wide,
    /// Parameters times `sum`.
    pub u: Wide,
    pub v: Wide,
    pub sum: Wide,
    /// The bits of the indices over all geometries of the tree.
    pub index: Wide,
    /// The bits of what a hit carries beyond that.
    pub extra: Wide,
    /// Bit `i`: ray `i` has a hit.
    pub hits: u32,
}

impl Found {
    /// No hits in intervals that end at given distances.
    #[inline(always)]
    pub fn nothing(t_max: &Wide) -> Self {
        let zero = Wide::splat(0.0);
        Self { t: *t_max, u: zero, v: zero, sum: zero, index: zero, extra: zero, hits: 0 }
    }

    /// The index of the hit of a ray.
    #[inline(always)]
    pub fn index(&self, lane: usize) -> u32 {
        self.index.0[lane].to_bits()
    }

    /// The hit of a ray.
    #[inline(always)]
    pub fn get<E: Extra>(&self, lane: usize) -> Option<Nearest<E>> {
        (self.hits >> lane & 1 == 1).then(|| {
            let sum = self.sum.0[lane];
            let hit = UserHit { t: self.t.0[lane], u: self.u.0[lane] / sum, v: self.v.0[lane] / sum };
            Nearest { hit, index: self.index(lane), extra: E::from_bits(self.extra.0[lane].to_bits()) }
        })
    }

    /// Sets the hit of a ray.
    #[inline(always)]
    pub fn set<E: Extra>(&mut self, lane: usize, Nearest { hit, index, extra }: Nearest<E>) {
        self.hits |= 1 << lane;
        self.t.0[lane] = hit.t;
        self.u.0[lane] = hit.u;
        self.v.0[lane] = hit.v;
        self.sum.0[lane] = 1.0;
        self.index.0[lane] = f32::from_bits(index);
        self.extra.0[lane] = f32::from_bits(extra.bits());
    }

    /// Takes over hits with one index, whose parameters and sums are given, of rays from one on: `lanes` counts from
    /// there.
    #[inline(always)]
    pub fn merge<L: Lanes>(&mut self, l: L, (first, lanes): (usize, u32), new: [L::F; 4], index: u32, extra: L::F) {
        let mask = l.mask(lanes);
        let [t, u, v, sum] = new;
        let index = l.splat(f32::from_bits(index));
        // Blend the new hits into the stored ones by the mask; the other lanes keep their values.
        l.write_from(l.select(mask, t, l.read_from(&self.t, first)), &mut self.t, first);
        l.write_from(l.select(mask, u, l.read_from(&self.u, first)), &mut self.u, first);
        l.write_from(l.select(mask, v, l.read_from(&self.v, first)), &mut self.v, first);
        l.write_from(l.select(mask, sum, l.read_from(&self.sum, first)), &mut self.sum, first);
        l.write_from(l.select(mask, index, l.read_from(&self.index, first)), &mut self.index, first);
        l.write_from(l.select(mask, extra, l.read_from(&self.extra, first)), &mut self.extra, first);
        self.hits |= lanes << first;
    }
}
