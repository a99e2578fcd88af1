//! Coverage of a pixel: the objects and materials that its samples hit first, and how many of them hit each.
//! Cryptomattes are made of these.

/// Things that a pixel counts. With more of them in one pixel, those that are met last are left out.
const SLOTS: usize = 8;

/// Number of samples that hit each thing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Hits {
    /// Numbers of things; 0 where a slot is free.
    pub ids: [u32; SLOTS],
    /// Samples that hit them.
    pub counts: [u32; SLOTS],
}

impl Hits {
    /// Counts a sample that hits a thing; 0 is nothing.
    pub fn add(&mut self, id: u32) {
        self.add_many(id, 1);
    }

    /// Counts so many samples that hit a thing.
    fn add_many(&mut self, id: u32, samples: u32) {
        if id == 0 {
            return;
        }
        if let Some(slot) = self.ids.iter().position(|&known| known == id || known == 0) {
            self.ids[slot] = id;
            self.counts[slot] += samples;
        }
    }

    /// Adds what further samples hit.
    pub fn add_hits(&mut self, of: &Self) {
        of.iter().for_each(|(id, samples)| self.add_many(id, samples));
    }

    /// The things and the samples that hit them, in the order in which they were met.
    pub fn iter(&self) -> impl Iterator<Item = (u32, u32)> {
        self.ids.into_iter().zip(self.counts).take_while(|(id, _)| *id != 0)
    }
}

/// The things that cover a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MatteSums {
    /// Objects, by [`crate::FirstHit::shape`].
    pub objects: Hits,
    /// Materials, by [`crate::FirstHit::material`].
    pub materials: Hits,
    /// Samples, those that hit nothing among them.
    pub samples: u32,
}

impl MatteSums {
    /// Counts what a sample hits first.
    pub fn add(&mut self, hit: &crate::FirstHit) {
        self.objects.add(hit.shape);
        self.materials.add(hit.material);
        self.samples += 1;
    }

    /// Adds what further samples hit first.
    pub fn add_sums(&mut self, of: &Self) {
        self.objects.add_hits(&of.objects);
        self.materials.add_hits(&of.materials);
        self.samples += of.samples;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_thing_is_counted_and_the_ninth_left_out() {
        let mut hits = Hits::default();
        for id in [3, 0, 5, 3, 3].into_iter().chain(10..16).chain([99, 5]) {
            hits.add(id);
        }
        let found: Vec<(u32, u32)> = hits.iter().collect();
        assert_eq!(found[..3], [(3, 3), (5, 2), (10, 1)]);
        assert_eq!((found.len(), found[7]), (8, (15, 1)));
    }
}
