//! Counts of what is drawn and what is not, and why.

use super::{
    Chunks, Culling, Verdict,
    rooms::{Census, Rooms},
};
use std::fmt;

/// Numbers of chunks, and of the primitives in them, by verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tally {
    culling: Culling,
    /// Chunks and primitives for each of [`KINDS`].
    counts: [[u64; 2]; 4],
    /// Numbers of cells, for methods that use them.
    census: Option<Census>,
}

const KINDS: [(Verdict, &str); 4] = [
    (Verdict::Drawn, "drawn"),
    (Verdict::Outside, "outside the view"),
    (Verdict::Hidden, "hidden"),
    (Verdict::Small, "smaller than a pixel"),
];

impl Tally {
    /// Counts of verdicts.
    pub fn new(culling: Culling, chunks: &Chunks, verdicts: &[Verdict]) -> Self {
        let count = |kind: Verdict| {
            let those = chunks.all().iter().zip(verdicts).filter(|(_, verdict)| **verdict == kind);
            those.fold([0, 0], |[chunks, parts], (chunk, _)| [chunks + 1, parts + u64::from(chunk.count)])
        };
        let census = chunks.made_rooms().map(Rooms::census);
        Self { culling, counts: KINDS.map(|kind| count(kind.0)), census }
    }

    /// Number of chunks with a verdict.
    pub fn chunks(&self, verdict: Verdict) -> u64 {
        KINDS.iter().zip(self.counts).filter(|(kind, _)| kind.0 == verdict).map(|(_, count)| count[0]).sum()
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [chunks, parts] = [0, 1].map(|i| self.counts.iter().map(|count| count[i]).sum::<u64>());
        write!(f, "culling={}: of {chunks} chunks ({parts} primitives)", self.culling.name())?;
        for (i, ((_, name), [chunks, parts])) in KINDS.iter().zip(self.counts).enumerate() {
            write!(f, "{} {chunks} ({parts}) {name}", if i == 0 { "" } else { "," })?;
        }
        self.census.map_or(Ok(()), |census| write!(f, "; {census}"))
    }
}
