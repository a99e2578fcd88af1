//! Numbers of the primitives that a picture is drawn of.

/// Primitives numbered one after the other: triangles of meshes, those of masked meshes, boxes, planes.
#[derive(Debug, Default)]
pub struct Parts {
    /// Sorted by the numbers of their first parts.
    runs: Vec<Run>,
    pub count: u32,
    /// Number of all primitives that were offered, drawn or not, modulo 2³².
    pub offered: u32,
}

/// Consecutive parts of an item.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    item: u32,
    /// First part within the item.
    part: u32,
    /// Number of the first part.
    first: u32,
    /// Number of the first part among all primitives.
    among_all: u32,
}

impl Parts {
    /// Numbers so many parts of an item; `false` where numbers are used up.
    pub fn add(&mut self, item: u32, part: u32, count: u32, among_all: u32) -> bool {
        // Three vertices or 36 corners each must be countable, too.
        let Some(end) = self.count.checked_add(count).filter(|&n| n < u32::MAX / 36) else { return false };
        if count > 0 {
            self.runs.push(Run { item, part, first: self.count, among_all });
            self.count = end;
        }
        true
    }

    /// The run of a number.
    #[inline]
    pub fn run(&self, number: u32) -> Option<&Run> {
        // Binary search: the last run that begins at or before the number.
        Some(&self.runs[self.runs.partition_point(|run| run.first <= number).checked_sub(1)?])
    }

    /// The item and its part of a number.
    #[inline]
    pub fn find(&self, number: u32) -> Option<(u32, u32)> {
        self.run(number).map(|run| (run.item, run.part + (number - run.first)))
    }

    /// The number among all primitives of a number.
    pub fn among_all(&self, number: u32) -> Option<u32> {
        self.run(number).map(|run| run.among_all.wrapping_add(number - run.first))
    }
}
