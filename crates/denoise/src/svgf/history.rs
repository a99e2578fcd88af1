//! History kept from frame to frame.

use super::{accumulate::Accumulated, surface::Surface};
use crate::{image::Image, rows::Rows};

/// Accumulated values until a frame, and the surfaces that it showed.
#[derive(Clone, Debug)]
pub(super) struct History {
    pub surfaces: Image<Surface>,
    /// A plane for each term.
    pub accumulated: Rows<Accumulated>,
}
