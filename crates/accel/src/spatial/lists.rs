//! The primitives of cells: one array, and where the list of each cell begins.

/// Lists of slots, one for each cell.
#[derive(Clone, Debug, Default)]
pub(super) struct Lists {
    first: Vec<u32>,
    slots: Vec<u32>,
}

impl Lists {
    /// From pairs of cell and slot, in the order of slots.
    pub fn from_pairs(cells: usize, pairs: &[(u32, u32)]) -> Self {
        // Counting sort: histogram, prefix sums, then scatter.
        let mut first = vec![0_u32; cells + 1];
        for &(cell, _) in pairs {
            first[cell as usize + 1] += 1;
        }
        for cell in 0..cells {
            first[cell + 1] += first[cell];
        }
        let mut next = first.clone();
        let mut slots = vec![0; pairs.len()];
        for &(cell, slot) in pairs {
            let place = &mut next[cell as usize];
            slots[*place as usize] = slot;
            *place += 1;
        }
        Self { first, slots }
    }

    /// Appends a list and gives its number.
    pub fn push(&mut self, list: &[u32]) -> u32 {
        if self.first.is_empty() {
            self.first.push(0);
        }
        self.slots.extend_from_slice(list);
        self.first.push(self.slots.len() as u32);
        self.first.len() as u32 - 2
    }

    /// The list of a cell.
    #[inline]
    pub fn get(&self, cell: u32) -> &[u32] {
        &self.slots[self.first[cell as usize] as usize..self.first[cell as usize + 1] as usize]
    }

    /// Length of all lists together.
    #[cfg(test)]
    pub fn len(&self) -> usize {
        self.slots.len()
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.first[..]) + size_of_val(&self.slots[..])
    }
}
