//! Culling: parts of the draw list that are found not to be seen before they are drawn.
//!
//! Items are cut into chunks of consecutive primitives ([`Chunks`]), each with a bounding volume ([`Bounding`]). A
//! method gives each chunk a verdict ([`judge`]); the picture is drawn of the chunks that remain, in the order that it
//! has without culling, so that primitives of equal depth are resolved alike. [`classify`] compares the verdicts with
//! what rays see.
//!
//! Two methods divide the scene into cells (`rooms`): walls make cells and portals, which windows pass, or lines.
//!
//! A method is a variant of [`Culling`], a row of `CULLINGS`, and a case of [`judge`].

mod bounding;
mod cells;
mod chunks;
mod classify;
mod footprint;
mod occluders;
mod portals;
mod pvs;
mod pyramid;
mod rooms;
mod selection;
mod tally;
#[cfg(test)]
mod tests;
mod verdict;
mod walls;

pub use bounding::{Bounding, BoundsKind};
pub use chunks::{CHUNK, Chunk, Chunks};
pub use classify::{Classified, classify};
pub use selection::Selection;
pub use tally::Tally;
pub use verdict::{Verdict, judge};

/// Culling method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Culling {
    /// Whole items whose axis-aligned box lies outside the view.
    Items,
    /// No culling.
    None,
    /// Chunks outside the view.
    Frustum,
    /// And chunks behind the depths of the largest ones, by a pyramid of depths (Greene, Kass, Miller 1993).
    Hiz,
    /// And chunks behind the bounding volumes of the largest ones where these cover the picture: coverage by pixels,
    /// depth by cells (Zhang, Manocha, Hudson, Hoff 1997).
    Occlusion,
    /// Chunks outside the view, and those that are seen through no sequence of portals between cells (Luebke, Georges
    /// 1995).
    Portals,
    /// Chunks outside the view, and those in cells that cannot be seen from anywhere in the eye's cell (Teller, Séquin
    /// 1991).
    Pvs,
    /// Chunks outside the view, and those that are smaller than a pixel, seen or not.
    ScreenSize,
}

impl Culling {
    /// True for methods that judge chunks.
    pub fn is_by_chunks(self) -> bool {
        !matches!(self, Self::Items | Self::None)
    }

    /// Name in requests.
    pub fn name(self) -> &'static str {
        CULLINGS.iter().find(|c| c.1 == self).map_or("", |c| c.0)
    }
}

/// The culling methods by name.
pub(crate) const CULLINGS: [(&str, Culling); 8] = [
    ("items", Culling::Items),
    ("none", Culling::None),
    ("frustum", Culling::Frustum),
    ("hiz", Culling::Hiz),
    ("occlusion", Culling::Occlusion),
    ("portals", Culling::Portals),
    ("pvs", Culling::Pvs),
    ("screen-size", Culling::ScreenSize),
];

/// The bounding volumes by name.
pub(crate) const BOUNDS: [(&str, BoundsKind); 5] = [
    ("aabb", BoundsKind::Aabb),
    ("sphere", BoundsKind::Sphere),
    ("obb", BoundsKind::Obb),
    ("kdop", BoundsKind::KDop),
    ("hull", BoundsKind::Hull),
];
