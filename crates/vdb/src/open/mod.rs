//! OpenVDB files (Museth, VDB: High-Resolution Sparse Volumes with Dynamic Topology, ACM TOG 32(3), 2013), of format
//! versions 222 to 225.

mod file;
mod head;
#[cfg(test)]
mod tests;
mod tree;
mod values;

pub(crate) use file::{is_one, read};
