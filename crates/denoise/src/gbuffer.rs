//! Surface data of each pixel.

use steradian_math::{Vec2, Vec3};

use crate::{
    error::{Error, Result},
    image::Image,
};

/// Surface data of each pixel: its first hit from the camera, through the middle of the pixel. All images have the size
/// of the frame. For a pixel that shows no surface, depths may be infinite and normals zero, with an id that no surface
/// has.
///
/// Depths have any unit of length, but one and the same. Values that are not finite are treated as those of another
/// surface than the neighbours'.
#[derive(Clone, Debug, PartialEq)]
pub struct GBuffer {
    /// Linear depth: distance from the camera along its axis.
    pub depth: Image<f32>,
    /// Screen-space gradient of depth on the surface: to the right, and downwards. Depth per pixel; for a surface of
    /// normal n at depth z, from derivatives of z or the plane of the triangle, not from neighbours in the picture,
    /// which may be others.
    pub depth_gradient: Image<Vec2>,
    /// The depth that this point of the surface had in the frame before, from the camera there. That of `depth` where
    /// neither moved along the axis.
    pub previous_depth: Image<f32>,
    /// Unit normal, in world space.
    pub normal: Image<Vec3>,
    /// Albedo, from 0 to 1: what terms with [`has_albedo`](crate::svgf::Term::has_albedo) are divided by before they
    /// are filtered, and multiplied with afterwards.
    pub albedo: Image<Vec3>,
    /// Number of the object. Nothing is filtered from an object to another.
    pub id: Image<u32>,
    /// Motion vector: position of this surface point in the frame before, relative to the pixel, in pixels: to the
    /// right, and downwards. A point at (10, 5) that was at (7.5, 5) has motion (−2.5, 0).
    pub motion: Image<Vec2>,
}

impl GBuffer {
    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.depth.size()
    }

    /// Checks that all images have the same size, with a pixel at least.
    pub(crate) fn check(&self) -> Result<()> {
        let size = self.size();
        let images = [
            ("depth_gradient", self.depth_gradient.size()),
            ("previous_depth", self.previous_depth.size()),
            ("normal", self.normal.size()),
            ("albedo", self.albedo.size()),
            ("id", self.id.size()),
            ("motion", self.motion.size()),
        ];
        if size.contains(&0) {
            return Err(Error::Empty);
        }
        images.into_iter().try_for_each(|(what, found)| check_size(what, found, size))
    }
}

/// Checks that an image has the size of the frame.
pub(crate) fn check_size(what: &'static str, found: [u32; 2], expected: [u32; 2]) -> Result<()> {
    if found == expected { Ok(()) } else { Err(Error::Size { what, found, expected }) }
}
