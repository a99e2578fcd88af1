//! Affine maps as both APIs write them.

use steradian_math::{Mat4, Transform, Vec3, Vec4, transform::Affine};

/// An affine map of 3 rows and 4 columns, row by row: `p' = M (p, 1)` (DXR, "D3D12_RAYTRACING_INSTANCE_DESC"; Vulkan,
/// `VkTransformMatrixKHR`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform3x4 {
    /// The rows; the last number of each is the translation.
    pub rows: [[f32; 4]; 3],
}

impl Default for Transform3x4 {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Transform3x4 {
    /// The map that changes nothing.
    pub const IDENTITY: Self = Self { rows: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]] };

    /// `p + by`.
    pub const fn translation(by: Vec3) -> Self {
        Self { rows: [[1.0, 0.0, 0.0, by.x], [0.0, 1.0, 0.0, by.y], [0.0, 0.0, 1.0, by.z]] }
    }

    /// `(by.x x, by.y y, by.z z)`.
    pub const fn scale(by: Vec3) -> Self {
        Self { rows: [[by.x, 0.0, 0.0, 0.0], [0.0, by.y, 0.0, 0.0], [0.0, 0.0, by.z, 0.0]] }
    }

    /// The rows of a matrix whose last row is not looked at.
    pub fn from_mat4(m: &Mat4) -> Self {
        Self { rows: [m.row(0), m.row(1), m.row(2)].map(|row| row.to_array()) }
    }

    /// As a matrix with the last row (0, 0, 0, 1).
    pub fn to_mat4(&self) -> Mat4 {
        let [x, y, z] = self.rows.map(Vec4::from_array);
        Mat4::from_cols(x, y, z, Vec4::W).transpose()
    }

    /// The image of a point.
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.to_mat4().transform_point3(p)
    }

    /// The image of a direction.
    pub fn vector(&self, v: Vec3) -> Vec3 {
        self.to_mat4().transform_vector3(v)
    }

    /// The map with its inverse, or `None` where a number is not finite or the map is singular.
    pub(crate) fn affine(&self) -> Option<Affine> {
        let matrix = self.to_mat4();
        let inverse = Transform { matrix: matrix.as_dmat4() }.inverse()?.matrix.as_mat4();
        (matrix.is_finite() && inverse.is_finite()).then_some(Affine { m: matrix, inv: inverse })
    }
}
