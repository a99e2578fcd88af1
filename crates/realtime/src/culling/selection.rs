//! Parts of the draw list that a picture is drawn of.

use super::{Chunks, Verdict};

/// Choice among the primitives of a draw list.
#[derive(Clone, Copy, Debug)]
pub enum Selection<'a> {
    /// Whole items whose box may be in the view.
    Items,
    /// All.
    All,
    /// Chunks with the verdict [`Verdict::Drawn`].
    Chunks(&'a Chunks, &'a [Verdict]),
}

impl Selection<'_> {
    /// First primitive and number of primitives of each run to be drawn of an item with so many. `in_view` tells of the
    /// item as a whole.
    pub(crate) fn runs(&self, item: usize, count: u32, in_view: impl FnOnce() -> bool) -> Vec<(u32, u32)> {
        let (chunks, verdicts) = match self {
            Self::All => return vec![(0, count)],
            Self::Items => return in_view().then_some((0, count)).into_iter().collect(),
            Self::Chunks(chunks, verdicts) => (chunks, verdicts),
        };
        // Chunks that follow each other make one run.
        let mut runs: Vec<(u32, u32)> = Vec::new();
        for number in chunks.of_item(item).filter(|&number| verdicts[number] == Verdict::Drawn) {
            let chunk = &chunks.all()[number];
            match runs.last_mut() {
                Some((first, count)) if *first + *count == chunk.first => *count += chunk.count,
                _ => runs.push((chunk.first, chunk.count)),
            }
        }
        runs
    }
}
