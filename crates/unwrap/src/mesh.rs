//! Input of unwrapping, and its faults.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, PI};
use steradian_math::DVec3;

/// Most triangles of a mesh.
pub const MOST_TRIANGLES: usize = 1 << 24;

/// Triangles over vertices, with the seams that are given.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mesh<'a> {
    /// Positions of the vertices.
    pub positions: &'a [[f32; 3]],
    /// Vertices of each triangle, counter-clockwise seen from the front.
    pub triangles: &'a [[u32; 3]],
    /// Edges along which charts must end, as pairs of vertices.
    pub seams: &'a [[u32; 2]],
}

/// Limits of charts, and the texels between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Angle between the normals of neighbours from which their edge is a seam, radians.
    pub seam_angle: f64,
    /// Half the angle of the cone that holds all normals of a chart, radians.
    pub cone: f64,
    /// Texels along a side of the atlas.
    pub resolution: u32,
    /// Texels between charts.
    pub padding: u32,
}

impl Default for Options {
    fn default() -> Self {
        Self { seam_angle: FRAC_PI_3, cone: FRAC_PI_2, resolution: 1024, padding: 4 }
    }
}

/// Reason that a mesh has no atlas.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// No triangle has an area.
    #[error("the mesh has no triangle with an area")]
    Empty,
    /// A coordinate is NaN or infinite.
    #[error("the position of vertex {0} is not a finite number")]
    NotFinite(usize),
    /// An index points past the vertices.
    #[error("triangle {triangle} refers to vertex {vertex}, but there are only {count} vertices")]
    IndexOutOfRange {
        /// Number of the triangle.
        triangle: usize,
        /// The index.
        vertex: u32,
        /// Number of vertices.
        count: usize,
    },
    /// More triangles than [`MOST_TRIANGLES`].
    #[error("the mesh has {0} triangles; at most {MOST_TRIANGLES} can be unwrapped")]
    TooLarge(usize),
    /// An option is out of its range.
    #[error("{0}")]
    BadOption(&'static str),
    /// Charts and the texels between them need more than there are.
    #[error(
        "{charts} charts with {padding} texels between them do not fit into {resolution} x {resolution} texels: take a higher \
         resolution or less padding"
    )]
    DoesNotFit {
        /// Number of charts.
        charts: usize,
        /// Texels between them.
        padding: u32,
        /// Texels along a side.
        resolution: u32,
    },
}

impl Mesh<'_> {
    /// Checks everything that the algorithms rely on.
    pub(crate) fn check(&self, options: &Options) -> Result<(), Error> {
        let Options { seam_angle, cone, resolution, padding } = *options;
        if !(seam_angle > 0.0 && seam_angle.is_finite()) {
            return Err(Error::BadOption("the angle of seams is above zero"));
        }
        if !(cone > 0.0 && cone <= PI) {
            return Err(Error::BadOption("the cone of a chart is between 0 and 180 degrees"));
        }
        if !(16..=1 << 15).contains(&resolution) {
            return Err(Error::BadOption("the resolution of an atlas is between 16 and 32768"));
        }
        if padding > resolution / 4 {
            return Err(Error::BadOption("the padding is at most a quarter of the resolution"));
        }
        if self.triangles.len() > MOST_TRIANGLES {
            return Err(Error::TooLarge(self.triangles.len()));
        }
        if let Some(vertex) = self.positions.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
            return Err(Error::NotFinite(vertex));
        }
        let count = self.positions.len();
        for (triangle, corners) in self.triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|i| **i as usize >= count) {
                return Err(Error::IndexOutOfRange { triangle, vertex, count });
            }
        }
        Ok(())
    }

    /// Positions of a triangle's corners.
    pub(crate) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|i| DVec3::from(self.positions[i as usize].map(f64::from)))
    }

    /// Half the cross product of two sides of a triangle: its normal, as long as its area.
    pub(crate) fn area_vector(&self, triangle: u32) -> DVec3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a) * 0.5
    }
}
