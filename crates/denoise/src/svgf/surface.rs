//! Surface data compared by the filters.

use steradian_math::{Vec2, Vec3};

use crate::{gbuffer::GBuffer, image::Image};

/// The part of a G-buffer that says whether two pixels show one surface.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Surface {
    pub depth: f32,
    pub gradient: Vec2,
    pub normal: Vec3,
    pub id: u32,
}

impl Surface {
    /// Surfaces of all pixels.
    pub fn all(gbuffer: &GBuffer) -> Image<Self> {
        let [width, height] = gbuffer.size();
        // Gather what the edge-stopping functions read into one structure.
        Image::by_rows(width, height, |x, y| Self {
            depth: gbuffer.depth.at(x, y),
            gradient: gbuffer.depth_gradient.at(x, y),
            normal: gbuffer.normal.at(x, y),
            id: gbuffer.id.at(x, y),
        })
    }
}
