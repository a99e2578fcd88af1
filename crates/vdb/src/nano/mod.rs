//! NanoVDB files (Museth, NanoVDB, SIGGRAPH 2021 Talks), of major version 32.

mod file;
#[cfg(test)]
mod tests;
mod tree;

pub(crate) use file::{is_one, read};
