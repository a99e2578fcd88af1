//! Columns of numbers, for loops over blocks ([`crate::kernel`]).

use steradian_math::Vec3;

/// Numbers of a column: two of the widest registers.
pub const WIDTH: usize = 32;

/// A number of each element of a block.
pub type Column<T = f32> = [T; WIDTH];

/// The vector of an element.
#[inline(always)]
pub fn get3(columns: &[Column; 3], k: usize) -> Vec3 {
    Vec3::new(columns[0][k], columns[1][k], columns[2][k])
}

/// Sets the vector of an element.
#[inline(always)]
pub fn set3(columns: &mut [Column; 3], k: usize, v: Vec3) {
    (columns[0][k], columns[1][k], columns[2][k]) = (v.x, v.y, v.z);
}

/// The four lanes of an element.
#[inline(always)]
pub fn get4(columns: &[Column; 4], k: usize) -> [f32; 4] {
    [columns[0][k], columns[1][k], columns[2][k], columns[3][k]]
}

/// Sets the four lanes of an element.
#[inline(always)]
pub fn set4(columns: &mut [Column; 4], k: usize, v: [f32; 4]) {
    (columns[0][k], columns[1][k], columns[2][k], columns[3][k]) = (v[0], v[1], v[2], v[3]);
}
